//! A client reads: expedited, segment by segment, or in blocks. The server sends segments until the block is full. Then
//! the client answers with the number of segments that it has received.

use super::{BlockSize, SdoServer, State, TOGGLE, Transfer, reply};
use crate::bus::sdo::wire::{Bytes, SEGMENT};
use crate::bus::{Abort, Object, Objects};

impl SdoServer {
    /// Begins a read.
    pub(super) fn begin_read<O: Objects + ?Sized>(
        &mut self,
        bytes: &Bytes,
        reply: &mut Bytes,
        objects: &mut O,
    ) -> Result<(), Abort> {
        let [head, _, _, _, block, threshold, ..] = *bytes;
        let in_blocks = head >> 5 == 5;
        let block = match BlockSize::new(block) {
            Some(block) => block,
            None if in_blocks => return Err(Abort::BlockSize),
            None => self.block,
        };
        let size = objects.size(self.object)?;
        self.transfer = Transfer::new(Some(size), block, true);
        // Up to the threshold the client accepts an expedited or segmented transfer instead; 0: never.
        if in_blocks && (threshold == 0 || size > u32::from(threshold)) {
            self.state = State::Offered;
            reply[0] = reply::BLOCK_UPLOAD;
        } else if let 1..=4 = size {
            let [_, _, _, _, value @ ..] = reply;
            let length = self.read(0, value, objects)?;
            self.object = Object::new(0, 0);
            reply[0] = reply::UPLOAD | 4_u8.saturating_sub(length) << 2 | 3;
            return Ok(());
        } else {
            self.state = State::Upload;
            reply[0] = reply::UPLOAD | 1;
        }
        [reply[4], reply[5], reply[6], reply[7]] = size.to_le_bytes();
        Ok(())
    }

    /// Answers a request for the next segment of a segmented read.
    pub(super) fn give_piece<O: Objects + ?Sized>(
        &mut self,
        head: u8,
        reply: &mut Bytes,
        objects: &mut O,
    ) -> Result<(), Abort> {
        if self.state != State::Upload {
            return Err(Abort::Specifier);
        }
        let wanted = head & TOGGLE;
        if (wanted != 0) != self.transfer.toggle {
            return Err(Abort::Toggle);
        }
        self.transfer.toggle = !self.transfer.toggle;
        let [head, value @ ..] = reply;
        let length = self.read(self.transfer.offset, value, objects)?;
        *head = reply::UPLOAD_SEGMENT | wanted | SEGMENT.saturating_sub(length) << 1;
        self.transfer.offset = self.transfer.offset.saturating_add(length.into());
        if self.transfer.size <= Some(self.transfer.offset) {
            *head |= 1;
            self.close(objects);
        }
        Ok(())
    }

    /// Makes the next segment of a block that is not full yet.
    pub(super) fn next_segment<O: Objects + ?Sized>(
        &mut self,
        reply: &mut Bytes,
        objects: &mut O,
    ) -> Result<(), Abort> {
        let [head, value @ ..] = reply;
        let offset = self.offset_behind(self.transfer.number);
        let length = self.read(offset, value, objects)?;
        let transfer = &mut self.transfer;
        let end = offset.saturating_add(length.into());
        if offset == transfer.summed {
            transfer.summed = end;
            let sent = value.get(..length.into()).unwrap_or_default();
            transfer.checksum = transfer.checksum.with(sent);
        }
        transfer.number = transfer.number.saturating_add(1);
        *head = transfer.number;
        if transfer.size <= Some(end) {
            *head |= super::LAST;
            self.state = State::Sent;
        } else if transfer.number >= transfer.block.get() {
            self.state = State::Sent;
        }
        Ok(())
    }

    /// The client has received the segments of a block up to `number` and takes `block` segments in the next one. False
    /// where there is no answer.
    pub(super) fn answered(
        &mut self,
        number: u8,
        block: u8,
        reply: &mut Bytes,
    ) -> Result<bool, Abort> {
        let early = self.state == State::Sending;
        if !early && self.state != State::Sent {
            return Err(Abort::Specifier);
        }
        if number > self.transfer.number {
            // In the middle of a block: a repeated answer to the block before.
            return if early {
                Ok(false)
            } else {
                Err(Abort::Sequence)
            };
        }
        let offset = self.offset_behind(number);
        let transfer = &mut self.transfer;
        transfer.block = BlockSize::new(block).ok_or(Abort::BlockSize)?;
        transfer.offset = offset;
        transfer.number = 0;
        let size = transfer.size.unwrap_or(0);
        if number == 0 || offset < size {
            self.state = State::Sending;
            return Ok(false);
        }
        self.state = State::Read;
        // Unused bytes in the last segment; 7 where the value is empty.
        let unused = offset.saturating_sub(size).min(7) as u8;
        reply[0] = reply::BLOCK_UPLOAD_END | unused << 2;
        [reply[1], reply[2]] = transfer.checksum.get().to_le_bytes();
        Ok(true)
    }

    /// Offset of the end of the block's first `segments` segments.
    fn offset_behind(&self, segments: u8) -> u32 {
        let bytes = u32::from(segments).saturating_mul(SEGMENT.into());
        self.transfer.offset.saturating_add(bytes)
    }

    /// Reads the bytes from `offset` on and gives their number. A value that is shorter than its announced size is an
    /// error of the device.
    #[inline(never)]
    fn read<O: Objects + ?Sized>(
        &self,
        offset: u32,
        into: &mut [u8],
        objects: &mut O,
    ) -> Result<u8, Abort> {
        let rest = self.transfer.size.unwrap_or(0).saturating_sub(offset);
        let length = rest.min(into.len() as u32);
        if length == 0 {
            return Ok(0);
        }
        let into = into.get_mut(..length as usize).unwrap_or_default();
        if objects.read(self.object, offset, into)? != length as usize {
            return Err(Abort::General);
        }
        Ok(length as u8)
    }
}
