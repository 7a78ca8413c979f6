//! Writes that the board asks for and its owner carries out: storage as an effect.
//!
//! The board says which bytes belong in which region, and is told when they are there. Knows nothing of flash.

use crate::journal::TapRecord;

/// What is kept over a loss of power, each by itself: the newest bytes replace all before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Region {
    /// The entry of the hole a tap is in ([`TapRecord`]).
    TapJournal,
}

impl Region {
    /// All of them.
    pub const ALL: [Self; 1] = [Self::TapJournal];

    /// Its number in a storage; never used again for another region.
    #[must_use]
    pub const fn key(self) -> u8 {
        match self {
            Self::TapJournal => 1,
        }
    }

    /// The most bytes it holds.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::TapJournal => TapRecord::BYTES,
        }
    }
}

/// A write that did not come about. The region then holds what it held before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The device refuses or does not answer.
    Device,
    /// There is no room.
    Full,
    /// What the device holds makes no sense any more, and could not be repaired.
    Damaged,
}

/// Bytes to be stored. Its owner keeps it until it is done and says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoreRequest {
    /// Where they belong.
    pub region: Region,
    pub(super) bytes: [u8; TapRecord::BYTES],
}

impl StoreRequest {
    /// What to store.
    #[must_use]
    pub const fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}
