//! Where what outlives the power is kept, and what can go wrong with it.
//!
//! Knows nothing of what is kept there, nor of flash.

/// What is kept over a loss of power, each by itself: the newest bytes replace all before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Region {
    /// The entry of the hole a tap is in ([`TapRecord`](crate::journal::TapRecord)).
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
}

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

/// Copies as many bytes as there are and have room; so many they are.
#[inline(never)]
pub(super) fn copy(bytes: &[u8], into: &mut [u8]) -> usize {
    for (place, &byte) in into.iter_mut().zip(bytes) {
        *place = byte;
    }
    bytes.len().min(into.len())
}
