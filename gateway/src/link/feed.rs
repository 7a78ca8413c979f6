//! A program on its way to the board: calls in batches, as many as there is room for, in bounded memory.

use std::collections::VecDeque;

use leadscrew_core::board::device::objects::{BATCH, CREDIT};
use leadscrew_core::bus::Abort;
use leadscrew_core::link::{BATCH_BYTES, BatchWriter, CallBytes, encode_call};
use leadscrew_core::program::Call;

use super::{Link, LinkResult};

/// Calls kept here until they fit into a batch.
const WAITING: usize = 64;

/// The feed of one program.
#[derive(Debug)]
pub struct Feed {
    program: u32,
    /// Number of the first call that waits.
    next: u32,
    waiting: VecDeque<CallBytes>,
    /// Bytes that the board is known to have room for; `None`: not known.
    credit: Option<usize>,
}

impl Feed {
    /// A program with a number of its own, other than the last one's.
    #[must_use]
    pub const fn new(program: u32) -> Self {
        Self {
            program,
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

    /// All that was pushed is on the board.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Its number.
    #[must_use]
    pub const fn program(&self) -> u32 {
        self.program
    }

    /// Calls that the board has taken.
    #[must_use]
    pub const fn taken(&self) -> u32 {
        self.next
    }

    /// Appends a call.
    pub fn push(&mut self, call: &Call) {
        // Every call that the interpreter makes is shorter than the longest one.
        if let Ok(bytes) = encode_call(call) {
            self.waiting.push_back(bytes);
        }
    }

    /// Sends one batch if there is room for a call on the board. False where there is not, or where nothing waits.
    ///
    /// # Errors
    /// The board does not take it: it is not ready for a program, or the link is lost.
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
        let mut batch = BatchWriter::new(self.program, self.next);
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
