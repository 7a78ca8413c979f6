//! A client reads in blocks: segments go out until the block is full, then the client says how many it has.

use super::read;
use crate::bus::object::{Abort, Object, Objects};
use crate::bus::sdo::BlockSize;
use crate::bus::sdo::wire::{BlockSegment, Checksum, Response, SEGMENT};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The client has the length and has not asked for the first block.
    Offered,
    /// Segments of a block go out.
    Sending,
    /// The block is out.
    Sent,
    /// The client has everything and looks at the CRC.
    Ended,
}

/// What is known about the transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockUpload {
    size: u32,
    phase: Phase,
    /// Where the block begins.
    offset: u32,
    /// Segments of the block that are out.
    sent: u8,
    block: BlockSize,
    /// Made whether the client wants it or not: some check it all the same.
    checksum: Checksum,
    /// How far the checksum goes: segments that are sent again are not summed again.
    summed: u32,
}

impl BlockUpload {
    /// `size` bytes in blocks of `block` segments.
    pub const fn new(size: u32, block: BlockSize) -> Self {
        Self {
            size,
            phase: Phase::Offered,
            offset: 0,
            sent: 0,
            block,
            checksum: Checksum::new(),
            summed: 0,
        }
    }

    /// True where the client has only to say that it has the value.
    pub const fn has_ended(&self) -> bool {
        matches!(self.phase, Phase::Ended)
    }

    /// The client wants the first block.
    pub const fn start(&mut self) -> Result<(), Abort> {
        match self.phase {
            Phase::Offered => {
                self.phase = Phase::Sending;
                Ok(())
            }
            _ => Err(Abort::Specifier),
        }
    }

    /// The next segment of the block, if it is not full.
    pub fn next<O: Objects + ?Sized>(
        &mut self,
        object: Object,
        objects: &mut O,
    ) -> Result<Option<BlockSegment>, Abort> {
        if self.phase != Phase::Sending {
            return Ok(None);
        }
        let offset = self.offset.saturating_add(bytes_in(self.sent));
        let piece = read(object, offset, self.size, objects)?;
        if offset == self.summed {
            self.summed = self.summed.saturating_add(u32::from(piece.len()));
            self.checksum = self.checksum.with(piece.as_slice());
        }
        self.sent = self.sent.saturating_add(1);
        let last = offset.saturating_add(u32::from(piece.len())) >= self.size;
        if last || self.sent >= self.block.get() {
            self.phase = Phase::Sent;
        }
        Ok(Some(BlockSegment {
            number: self.sent,
            last,
            bytes: piece.bytes(),
        }))
    }

    /// The client has the segments up to `number` and takes `block` in the next block.
    pub fn answered(&mut self, number: u8, block: u8) -> Result<Option<Response>, Abort> {
        let early = match self.phase {
            Phase::Sent => false,
            Phase::Sending => true,
            Phase::Offered | Phase::Ended => return Err(Abort::Specifier),
        };
        if number > self.sent {
            // In the middle of a block: the answer to the one before, twice.
            return if early {
                Ok(None)
            } else {
                Err(Abort::Sequence)
            };
        }
        self.block = BlockSize::new(block).ok_or(Abort::BlockSize)?;
        self.offset = self.offset.saturating_add(bytes_in(number));
        self.sent = 0;
        self.phase = Phase::Sending;
        if number == 0 || self.offset < self.size {
            return Ok(None);
        }
        self.phase = Phase::Ended;
        Ok(Some(Response::BlockUploadEnd {
            // What was taken beyond the size; 7 where the value is empty.
            unused: self.offset.saturating_sub(self.size).min(7) as u8,
            crc: self.checksum.get(),
        }))
    }
}

/// Bytes in so many full segments.
fn bytes_in(segments: u8) -> u32 {
    u32::from(segments).saturating_mul(u32::from(SEGMENT))
}
