//! A client writes: expedited, segment by segment, or in blocks. The client sends segments until the block is full.
//! Then the server answers with the number of segments that it has received.
//!
//! The server takes only the next segment in sequence. After a lost segment it ignores the rest of the block, and its
//! answer asks for that rest again. It ignores repeated segments, too. Only the end of the transfer gives the number of
//! used bytes in the last segment, so the server holds the last segment back until then.

use super::{LAST, SdoServer, State, TOGGLE, Transfer, long, reply};
use crate::bus::sdo::wire::{Bytes, SEGMENT};
use crate::bus::{Abort, Object, Objects};

impl SdoServer {
    /// Begins a write; an expedited write is complete at once.
    pub(super) fn begin_write<O: Objects + ?Sized>(
        &mut self,
        bytes: &Bytes,
        reply: &mut Bytes,
        objects: &mut O,
    ) -> Result<(), Abort> {
        let [head, _, _, _, value @ ..] = bytes;
        let in_blocks = head >> 5 == 6;
        let at_once = !in_blocks && head & 2 != 0;
        let size = match (at_once, head & 3) {
            (true, 3) => Some(4_u32.saturating_sub((head >> 2 & 3).into())),
            // No length given: the object's present length, or all four bytes where that is unknown.
            (true, _) => match objects.size(self.object) {
                Ok(size @ 1..=4) => Some(size),
                _ => Some(4),
            },
            (false, 0) => None,
            (false, _) => Some(long(*bytes)),
        };
        objects.begin_write(self.object, size)?;
        // From here on a refusal must abandon the write.
        self.transfer = Transfer::new(size, self.block, head & 4 != 0);
        if in_blocks {
            self.state = State::Taking;
            reply[0] = reply::BLOCK_DOWNLOAD;
            reply[4] = self.block.get();
            return Ok(());
        }
        self.state = State::Download;
        reply[0] = reply::DOWNLOAD;
        if at_once {
            let length = size.unwrap_or(0);
            let value = value.get(..length as usize).unwrap_or(value);
            objects.write(self.object, 0, value)?;
            self.commit(length, objects)?;
        }
        Ok(())
    }

    /// Takes the next segment of a segmented write.
    pub(super) fn take_piece<O: Objects + ?Sized>(
        &mut self,
        bytes: &Bytes,
        reply: &mut Bytes,
        objects: &mut O,
    ) -> Result<(), Abort> {
        if self.state != State::Download {
            return Err(Abort::Specifier);
        }
        let [head, ..] = *bytes;
        let toggle = head & TOGGLE;
        if (toggle != 0) != self.transfer.toggle {
            return Err(Abort::Toggle);
        }
        self.transfer.toggle = !self.transfer.toggle;
        let piece = piece(bytes, head >> 1 & 7);
        let begin = self.advance(piece)?;
        let last = head & 1 != 0;
        if last && self.is_short() {
            return Err(Abort::TooShort);
        }
        self.hand_on(begin, piece, objects)?;
        if last {
            self.commit(self.transfer.offset, objects)?;
        }
        reply[0] = reply::DOWNLOAD_SEGMENT | toggle;
        Ok(())
    }

    /// Takes a segment of a block. False where there is no answer yet.
    pub(super) fn take_segment<O: Objects + ?Sized>(
        &mut self,
        bytes: &Bytes,
        reply: &mut Bytes,
        objects: &mut O,
    ) -> Result<bool, Abort> {
        let [head, ..] = *bytes;
        let (number, last) = (head & !LAST, head & LAST != 0);
        let most = self.transfer.block.get();
        if number == 0 || number > most {
            return Err(Abort::Sequence);
        }
        let over = last || number == most;
        if number == self.transfer.number.saturating_add(1) {
            if let Some(before) = self.transfer.held {
                let handed_on = self.sum_and_hand_on(piece(&before, 0), objects);
                if handed_on.is_err() && over {
                    // No segment follows in this block, so there is nothing to discard.
                    self.state = State::Taken;
                }
                handed_on?;
            }
            self.transfer.held = Some(*bytes);
            self.transfer.number = number;
            if last {
                self.state = State::Taken;
            }
        }
        if !over {
            return Ok(false);
        }
        reply[0] = reply::BLOCK_DOWNLOAD_ANSWER;
        reply[1] = core::mem::take(&mut self.transfer.number);
        reply[2] = most;
        Ok(true)
    }

    /// The client has sent all blocks; `unused` bytes of the last segment are not used.
    pub(super) fn end_blocks<O: Objects + ?Sized>(
        &mut self,
        unused: u8,
        crc: u16,
        objects: &mut O,
    ) -> Result<(), Abort> {
        let (State::Taken, Some(last)) = (self.state, self.transfer.held.take()) else {
            return Err(Abort::Specifier);
        };
        let piece = piece(&last, unused);
        if self.transfer.sums && self.transfer.checksum.with(piece).get() != crc {
            return Err(Abort::Crc);
        }
        self.sum_and_hand_on(piece, objects)?;
        if self.is_short() {
            return Err(Abort::TooShort);
        }
        self.commit(self.transfer.offset, objects)
    }

    fn sum_and_hand_on<O: Objects + ?Sized>(
        &mut self,
        piece: &[u8],
        objects: &mut O,
    ) -> Result<(), Abort> {
        let begin = self.advance(piece)?;
        self.transfer.checksum = self.transfer.checksum.with(piece);
        self.hand_on(begin, piece, objects)
    }

    /// Advances by a piece and gives the piece's offset.
    fn advance(&mut self, piece: &[u8]) -> Result<u32, Abort> {
        let begin = self.transfer.offset;
        match begin.checked_add(piece.len() as u32) {
            Some(end) if self.transfer.size.is_none_or(|size| end <= size) => {
                self.transfer.offset = end;
                Ok(begin)
            }
            _ => Err(Abort::TooLong),
        }
    }

    fn is_short(&self) -> bool {
        self.transfer.size > Some(self.transfer.offset)
    }

    fn hand_on<O: Objects + ?Sized>(
        &self,
        begin: u32,
        piece: &[u8],
        objects: &mut O,
    ) -> Result<(), Abort> {
        if piece.is_empty() {
            return Ok(());
        }
        objects.write(self.object, begin, piece)
    }

    /// The only place where a write takes effect.
    fn commit<O: Objects + ?Sized>(&mut self, length: u32, objects: &mut O) -> Result<(), Abort> {
        // The write ends here either way: nothing is left to abandon.
        self.state = State::Idle;
        objects.end_write(self.object, length)?;
        self.object = Object::new(0, 0);
        Ok(())
    }
}

/// The bytes of a segment without its last `unused` bytes.
fn piece([_, value @ ..]: &Bytes, unused: u8) -> &[u8] {
    let length = SEGMENT.saturating_sub(unused);
    value.get(..length.into()).unwrap_or_default()
}
