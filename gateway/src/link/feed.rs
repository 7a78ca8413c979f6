//! Sends a program to the board: calls in batches, as many as the board has room for, in bounded memory.

use std::collections::VecDeque;

use leadscrew_core::board::device::objects::{BATCH, CREDIT};
use leadscrew_core::bus::Abort;
use leadscrew_core::call::Call;
use leadscrew_core::link::{BATCH_BYTES, BatchWriter, CallBytes, encode_call};
use leadscrew_core::offsets::Revision;

use super::{Link, LinkResult};

/// Calls that wait here until they fit into a batch.
const WAITING: usize = 64;

/// The feed of one program.
#[derive(Debug)]
pub struct Feed {
    program: u32,
    /// The table of offsets that it was resolved with.
    offsets: Revision,
    /// Number of the first waiting call.
    next: u32,
    waiting: VecDeque<CallBytes>,
    /// Bytes that the board is known to have room for; `None`: unknown.
    credit: Option<usize>,
}

impl Feed {
    /// A program with a number that differs from the last one, resolved with this table of offsets.
    #[must_use]
    pub const fn new(program: u32, offsets: Revision) -> Self {
        Self {
            program,
            offsets,
            next: 0,
            waiting: VecDeque::new(),
            credit: None,
        }
    }

    /// True where another call can be [pushed](Self::push).
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.waiting.len() < WAITING
    }

    /// True where the board has every pushed call.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Number of the program.
    #[must_use]
    pub const fn program(&self) -> u32 {
        self.program
    }

    /// Number of calls that the board has taken.
    #[must_use]
    pub const fn taken(&self) -> u32 {
        self.next
    }

    /// Appends a call.
    pub fn push(&mut self, call: &Call) {
        // Every call of the interpreter is shorter than the longest call.
        if let Ok(bytes) = encode_call(call) {
            self.waiting.push_back(bytes);
        }
    }

    /// Sends one batch if the board has room for a call. False where it has no room, or where no call waits.
    ///
    /// # Errors
    /// The board does not take the batch: it is not ready for a program, or the link is lost.
    pub fn send(&mut self, link: &mut Link) -> LinkResult<bool> {
        let Some(first) = self.waiting.front() else {
            return Ok(false);
        };
        let shortest = first.len();
        if self.credit.is_none_or(|credit| credit < shortest) {
            let credit = link.read_number(CREDIT)?;
            self.credit = usize::try_from(credit).ok();
        }
        let credit = self.credit.unwrap_or(0);
        let mut batch = BatchWriter::new(self.program, self.offsets, self.next);
        let mut used = 0;
        for call in &self.waiting {
            if used + call.len() > credit || batch.bytes().len() + call.len() > BATCH_BYTES {
                break;
            }
            if batch.push(call).is_err() {
                break;
            }
            used += call.len();
        }
        if batch.count() == 0 {
            return Ok(false);
        }
        match link.write(BATCH, batch.bytes()) {
            Ok(()) => {}
            Err(trouble) if trouble.is_abort(Abort::OutOfMemory) => {
                self.credit = None;
                return Ok(false);
            }
            Err(trouble) => return Err(trouble),
        }
        self.waiting.drain(..batch.count() as usize);
        self.next = self.next.wrapping_add(batch.count());
        self.credit = Some(credit - used);
        Ok(true)
    }
}
