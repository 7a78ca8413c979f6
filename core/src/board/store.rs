//! Writes and reads that the board asks for and its owner carries out: storage as an effect.
//!
//! The board says which bytes belong in which region, and is told when they are there; or which region it wants, and is
//! told what that holds. Knows nothing of flash.

use super::kept::{KeptSet, Mark};
use crate::journal::TapRecord;

/// What is kept over a loss of power, each by itself: the newest bytes replace all before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Region {
    /// The entry of the hole a tap is in ([`TapRecord`]).
    TapJournal,
    /// A parameter set with its number; this place and the next are used in turn, so that the last good set is there.
    ParametersA,
    /// The other one.
    ParametersB,
    /// The number of the newest of the two: what tells that it has been lost.
    ParametersMark,
}

impl Region {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::TapJournal,
        Self::ParametersA,
        Self::ParametersB,
        Self::ParametersMark,
    ];

    /// The most bytes that any of them holds.
    pub const LONGEST: usize = KeptSet::BYTES;

    /// Its number in a storage; never used again for another region.
    #[must_use]
    pub const fn key(self) -> u8 {
        match self {
            Self::TapJournal => 1,
            Self::ParametersA => 2,
            Self::ParametersB => 3,
            Self::ParametersMark => 4,
        }
    }

    /// The bytes it holds.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::TapJournal => TapRecord::BYTES,
            Self::ParametersA | Self::ParametersB => KeptSet::BYTES,
            Self::ParametersMark => Mark::BYTES,
        }
    }
}

const _: () = {
    let mut regions: &[Region] = &Region::ALL;
    while let [region, rest @ ..] = regions {
        assert!(region.bytes() <= Region::LONGEST, "a region fits a buffer");
        regions = rest;
    }
};

/// A write or a read that did not come about. After a write the region then holds what it held before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The device refuses or does not answer.
    Device,
    /// There is no room.
    Full,
    /// What the device holds makes no sense any more, and could not be repaired.
    Damaged,
}

/// Bytes to be stored. They are put into a buffer of the owner's, who keeps it until the write is done and says so.
#[derive(Clone, Copy, Debug)]
pub struct StoreRequest<'a> {
    /// Where they belong.
    pub region: Region,
    pub(super) content: Content<'a>,
}

/// What a request is made of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content<'a> {
    Tap([u8; TapRecord::BYTES]),
    Set(KeptSet<'a>),
    Mark([u8; Mark::BYTES]),
}

impl StoreRequest<'_> {
    /// Puts the bytes at the beginning of `into`, which has room for [`Region::bytes`]; what there is no room for is left
    /// out. Those put there come back.
    pub fn fill<'b>(&self, into: &'b mut [u8]) -> &'b [u8] {
        let length = match &self.content {
            Content::Tap(bytes) => copy(bytes, into),
            Content::Mark(bytes) => copy(bytes, into),
            Content::Set(set) => set.fill(into),
        };
        into.get(..length).unwrap_or_default()
    }
}

/// Copies as many bytes as there are and have room; so many they are.
#[inline(never)]
pub(super) fn copy(bytes: &[u8], into: &mut [u8]) -> usize {
    for (place, &byte) in into.iter_mut().zip(bytes) {
        *place = byte;
    }
    bytes.len().min(into.len())
}
