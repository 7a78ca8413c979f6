//! The regions of the storage that outlives a loss of power.
//!
//! Knows nothing of the content, nor of flash.

/// How often each page of a board's flash can be erased, as its maker guarantees it (STM32G474, DS12288).
pub const GUARANTEED_ERASES: u32 = 10_000;

/// From so many erases of each page on a warning is given: a fifth of its life is left to get another board.
pub const WORN: u32 = GUARANTEED_ERASES / 5 * 4;

/// A region of the storage. New bytes replace all bytes before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Region {
    /// The entry of the hole that a tap is in ([`TapRecord`](crate::journal::TapRecord)).
    TapJournal,
    /// A parameter set with its number. This region and the next are used in turn, so that the last good set stays.
    ParametersA,
    /// The other region for a parameter set.
    ParametersB,
    /// The number of the newest of the two sets. It shows when that set is lost.
    ParametersMark,
    /// A table of offsets and tools; this region and the next are used in turn.
    OffsetsA,
    /// The other region for a table.
    OffsetsB,
    /// The revision of the newest of the two tables.
    OffsetsMark,
    /// How often the board has started.
    Starts,
    /// How many pages of the storage have been erased.
    Erases,
}

impl Region {
    /// All regions.
    pub const ALL: [Self; 9] = [
        Self::TapJournal,
        Self::ParametersA,
        Self::ParametersB,
        Self::ParametersMark,
        Self::OffsetsA,
        Self::OffsetsB,
        Self::OffsetsMark,
        Self::Starts,
        Self::Erases,
    ];

    /// Its number in a storage; never reused for another region.
    #[must_use]
    pub const fn key(self) -> u8 {
        match self {
            Self::TapJournal => 1,
            Self::ParametersA => 2,
            Self::ParametersB => 3,
            Self::ParametersMark => 4,
            Self::OffsetsA => 5,
            Self::OffsetsB => 6,
            Self::OffsetsMark => 7,
            Self::Starts => 8,
            Self::Erases => 9,
        }
    }
}

/// Copies as many bytes as there are and have room. Returns their number.
#[inline(never)]
pub(super) fn copy(bytes: &[u8], into: &mut [u8]) -> usize {
    for (place, &byte) in into.iter_mut().zip(bytes) {
        *place = byte;
    }
    bytes.len().min(into.len())
}
