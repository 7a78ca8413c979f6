//! A client writes: at once, segment by segment, or in blocks, of which the segments come in until the block is full, and
//! then the server says how many it has.
//!
//! Of a block only the next segment in sequence is ever taken. What comes behind a lost one is ignored until the block
//! ends, and the answer asks for it again; so are segments that come twice. How many bytes of the last segment count is
//! told only at the very end, so the last one is held back until then.

use super::{LAST, SdoServer, State, TOGGLE, Transfer, long, reply};
use crate::bus::object::{Abort, Object, Objects};
use crate::bus::sdo::wire::{Bytes, SEGMENT};

impl SdoServer {
    /// A write begins; a short one is done at once.
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
            // As many as the object has now; where that cannot be told, all.
            (true, _) => match objects.size(self.object) {
                Ok(size @ 1..=4) => Some(size),
                _ => Some(4),
            },
            (false, 0) => None,
            (false, _) => Some(long(*bytes)),
        };
        objects.begin_write(self.object, size)?;
        // From here on a refusal abandons.
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

    /// The next segment, of those that are answered one by one.
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

    /// Takes a segment of a block. False where nothing is to be said yet.
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
                    // Nothing more of it comes that would have to be swallowed.
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

    /// The client says that these were all blocks; of the last segment so many bytes mean nothing.
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

    /// Goes on by a piece, of which the place comes back.
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

    /// The one place where a write takes effect.
    fn commit<O: Objects + ?Sized>(&mut self, length: u32, objects: &mut O) -> Result<(), Abort> {
        // The write ends here either way: nothing is left to abandon.
        self.state = State::Idle;
        objects.end_write(self.object, length)?;
        self.object = Object::new(0, 0);
        Ok(())
    }
}

/// What a segment brings, without so many of its last bytes.
fn piece([_, value @ ..]: &Bytes, unused: u8) -> &[u8] {
    let length = SEGMENT.saturating_sub(unused);
    value.get(..length.into()).unwrap_or_default()
}
