//! Writes and reads that the board asks for and its owner carries out: storage as an effect.
//!
//! The board says which bytes belong in which region, and is told when they are there; or which region it wants, and is
//! told what that holds. Knows nothing of flash.

use super::kept::{KeptSet, Mark};
use super::store::{Region, copy};
use crate::journal::TapRecord;

impl Region {
    /// The most bytes that any of them holds.
    pub const LONGEST: usize = KeptSet::BYTES;

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
