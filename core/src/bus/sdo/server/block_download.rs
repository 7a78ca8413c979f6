//! A client writes in blocks: segments come in until the block is full, then the server says how many it has.
//!
//! Only the next segment in sequence is ever taken. What comes behind a lost one is ignored until the block ends, and the
//! answer asks for it again; so are segments that come twice. How many bytes of the last segment count is told only at
//! the very end, so the last one is held back until then.

use crate::bus::object::{Abort, Object, Objects};
use crate::bus::sdo::BlockSize;
use crate::bus::sdo::wire::{BlockSegment, Bytes, Checksum, Piece, Response};

/// What is known about the transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockDownload {
    size: Option<u32>,
    /// The client sends a CRC.
    crc: bool,
    checksum: Checksum,
    block: BlockSize,
    /// Bytes that were handed on.
    offset: u32,
    /// The last segment that was taken in this block; 0 before the first.
    number: u8,
    /// What it brought; not handed on yet.
    held: Option<BlockSegment>,
    /// All segments are there.
    complete: bool,
}

impl BlockDownload {
    /// A write of `size` bytes, if that was told, in blocks of `block` segments.
    pub const fn new(crc: bool, size: Option<u32>, block: BlockSize) -> Self {
        Self {
            size,
            crc,
            checksum: Checksum::new(),
            block,
            offset: 0,
            number: 0,
            held: None,
            complete: false,
        }
    }

    /// True while frames are segments.
    pub const fn in_block(&self) -> bool {
        !self.complete
    }

    /// True for the last segment, come twice: it may look like the command that ends the transfer.
    pub fn repeats(&self, bytes: Bytes) -> bool {
        self.held.is_some_and(|held| held.encode() == bytes)
    }

    /// Takes a segment.
    pub fn take<O: Objects + ?Sized>(
        &mut self,
        segment: BlockSegment,
        object: Object,
        objects: &mut O,
    ) -> Result<Option<Response>, Abort> {
        if segment.number == 0 || segment.number > self.block.get() {
            return Err(Abort::Sequence);
        }
        if segment.number == self.number.saturating_add(1) {
            if let Some(before) = self.held {
                self.hand_on(Piece::without(before.bytes, 0), object, objects)?;
            }
            self.held = Some(segment);
            self.number = segment.number;
            self.complete = segment.last;
        }
        if !segment.last && segment.number < self.block.get() {
            return Ok(None);
        }
        let number = core::mem::take(&mut self.number);
        Ok(Some(Response::BlockDownloadAnswer {
            number,
            block: self.block.get(),
        }))
    }

    /// The client says that this is all. Gives the length; nothing has taken effect yet.
    pub fn end<O: Objects + ?Sized>(
        &mut self,
        unused: u8,
        crc: u16,
        object: Object,
        objects: &mut O,
    ) -> Result<u32, Abort> {
        let (true, Some(last)) = (self.complete, self.held.take()) else {
            return Err(Abort::Specifier);
        };
        let piece = Piece::without(last.bytes, unused);
        if self.crc && self.checksum.with(piece.as_slice()).get() != crc {
            return Err(Abort::Crc);
        }
        if piece.len() > 0 {
            self.hand_on(piece, object, objects)?;
        }
        match self.size {
            Some(size) if self.offset < size => Err(Abort::TooShort),
            _ => Ok(self.offset),
        }
    }

    fn hand_on<O: Objects + ?Sized>(
        &mut self,
        piece: Piece,
        object: Object,
        objects: &mut O,
    ) -> Result<(), Abort> {
        let begin = self.offset;
        self.offset = begin
            .checked_add(u32::from(piece.len()))
            .filter(|end| self.size.is_none_or(|size| *end <= size))
            .ok_or(Abort::TooLong)?;
        self.checksum = self.checksum.with(piece.as_slice());
        objects.write(object, begin, piece.as_slice())
    }
}
