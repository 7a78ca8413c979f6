//! Writes and reads that the board asks for and its owner carries out: storage as an effect.
//!
//! For a write, the board names bytes and region, and the owner reports when it is done. For a read, the board names a
//! region, and the owner returns its content. Knows nothing of flash.

use super::kept::{KeptSet, Mark};
use super::store::{Region, copy};
use crate::journal::TapRecord;
use crate::offsets::image::{self, Image};

impl Region {
    /// The most bytes of a region.
    pub const LONGEST: usize = KeptSet::BYTES;

    /// Bytes of the region.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::TapJournal => TapRecord::BYTES,
            Self::ParametersA | Self::ParametersB => KeptSet::BYTES,
            Self::OffsetsA | Self::OffsetsB => image::BYTES,
            Self::ParametersMark | Self::OffsetsMark | Self::Starts | Self::Erases => Mark::BYTES,
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

/// A request to store bytes. They are copied into a buffer of the owner, who keeps the buffer until the write is done and
/// reports the result.
#[derive(Clone, Copy, Debug)]
pub struct StoreRequest<'a> {
    /// The region.
    pub region: Region,
    pub(super) content: Content<'a>,
}

/// The sources of a request's bytes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content<'a> {
    Tap([u8; TapRecord::BYTES]),
    Set(KeptSet<'a>),
    Table(&'a Image),
    Mark([u8; Mark::BYTES]),
}

impl StoreRequest<'_> {
    /// Writes the bytes to the beginning of `into` and returns them. `into` needs [`Region::bytes`]; bytes without room are
    /// left out.
    pub fn fill<'b>(&self, into: &'b mut [u8]) -> &'b [u8] {
        let length = match &self.content {
            Content::Tap(bytes) => copy(bytes, into),
            Content::Mark(bytes) => copy(bytes, into),
            Content::Table(bytes) => copy(*bytes, into),
            Content::Set(set) => set.fill(into),
        };
        into.get(..length).unwrap_or_default()
    }
}
