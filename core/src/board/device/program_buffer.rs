//! The incoming program: batches in, calls out, in a fixed memory.
//!
//! Calls stay encoded here, as short as they travelled, and are decoded one by one when the planner has room. So a program
//! of any size goes through; how much of it fits at once depends on its calls.
//!
//! | phase | batches | `run` |
//! |---|---|---|
//! | none, closed | the beginning of a program only | does nothing |
//! | loading | go on | begins to hand calls over |
//! | running | go on | does nothing |
//!
//! Knows the link's messages; knows nothing of transfers, frames or the effect of calls.

use super::ring::Ring;
use crate::bus::Abort;
use crate::call::{Call, CallKind};
use crate::link::{Batch, BatchError, CALL_BYTES, decode_call};
use crate::offsets::Revision;

/// Bytes of program that a board keeps ahead of its planner: four of the longest batches, or more than a hundred short
/// moves.
pub const PROGRAM_BYTES: usize = 2048;

/// The phases of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Finished, or dropped by a reset or an alarm. Only another program may begin.
    Closed,
    /// It comes in and waits for `run`.
    Loading,
    /// It comes in, and its calls are handed over.
    Running,
}

/// The memory for programs.
#[derive(Debug)]
pub struct ProgramBuffer {
    phase: Phase,
    program: u32,
    /// The table of offsets that it was resolved with.
    offsets: Revision,
    /// Number of the next call.
    next: u32,
    /// The end of the program is in the memory.
    ended: bool,
    ring: Ring<PROGRAM_BYTES>,
}

impl ProgramBuffer {
    pub const fn new() -> Self {
        Self {
            ring: Ring::new(),
            phase: Phase::Closed,
            program: 0,
            offsets: Revision(0),
            next: 0,
            ended: false,
        }
    }

    /// The last program.
    pub const fn program(&self) -> u32 {
        self.program
    }

    /// The table of offsets that it was resolved with.
    pub const fn offsets(&self) -> Revision {
        self.offsets
    }

    /// True where its calls wait for `run`.
    pub const fn is_loading(&self) -> bool {
        matches!(self.phase, Phase::Loading)
    }

    /// Number of the next call that the board expects.
    pub const fn next_call(&self) -> u32 {
        self.next
    }

    /// Bytes of calls that have room now.
    pub fn credit(&self) -> u16 {
        u16::try_from(self.ring.free()).unwrap_or(u16::MAX)
    }

    /// Drops the program. Further batches of it are refused.
    pub const fn close(&mut self) {
        self.phase = Phase::Closed;
        self.ring.clear();
    }

    /// `run`: hands calls over from now on. False where no program waits for it.
    pub const fn run(&mut self) -> bool {
        let waits = matches!(self.phase, Phase::Loading);
        if waits {
            self.phase = Phase::Running;
        }
        waits
    }

    /// True where the program runs and its next part has not come.
    pub const fn awaits_more(&self) -> bool {
        matches!(self.phase, Phase::Running) && !self.ended && self.ring.used() == 0
    }

    /// True where the program runs, or its calls wait for `run`.
    #[cfg(test)]
    pub const fn is_open(&self) -> bool {
        !matches!(self.phase, Phase::Closed)
    }

    /// Takes a whole batch or nothing of it. Calls that have come before are not taken twice. `ready`: the machine takes
    /// calls; `at_rest`: no program is under way.
    pub fn take(&mut self, bytes: &[u8], ready: bool, at_rest: bool) -> Result<(), Abort> {
        let batch = Batch::new(bytes).map_err(abort)?;
        let begins = batch.first == 0 && (batch.program != self.program || self.next == 0);
        if !begins && batch.program != self.program {
            return Err(Abort::State);
        }
        let (expected, free) = if begins {
            (0, PROGRAM_BYTES)
        } else {
            (self.next, self.ring.free())
        };
        // The whole batch is checked before any of it is taken.
        let mut number = batch.first;
        let mut wanted = 0_usize;
        let mut ended = self.ended && !begins;
        for read in batch {
            let (call, bytes) = read.map_err(abort)?;
            if number >= expected {
                if ended {
                    // No call may follow the end of a program.
                    return Err(Abort::Value);
                }
                ended = matches!(
                    call.kind,
                    CallKind::End(_) | CallKind::Over | CallKind::LineOver
                );
                wanted = wanted.saturating_add(bytes.len());
            }
            number = number.saturating_add(1);
        }
        if batch.first > expected {
            return Err(Abort::Sequence);
        }
        if number <= expected && !begins {
            // All of its calls have come before.
            return Ok(());
        }
        let allowed = if begins {
            ready && at_rest && self.phase != Phase::Running
        } else {
            ready && self.phase != Phase::Closed
        };
        if !allowed {
            return Err(Abort::State);
        }
        if wanted > free {
            return Err(Abort::OutOfMemory);
        }
        if begins {
            self.ring.clear();
            self.phase = Phase::Loading;
            self.program = batch.program;
            self.offsets = batch.offsets;
        }
        let mut at = batch.first;
        for (_, bytes) in batch.flatten() {
            if at >= expected {
                // The room was checked above.
                self.ring.push(bytes);
            }
            at = at.saturating_add(1);
        }
        self.next = number;
        self.ended = ended;
        Ok(())
    }

    /// Hands calls over until `offer` has no room or none is left. True where any call was taken.
    pub fn hand_over(&mut self, offer: &mut impl FnMut(&Call) -> bool) -> bool {
        let mut worked = false;
        while self.phase == Phase::Running && self.ring.used() > 0 {
            let mut bytes = [0; CALL_BYTES];
            let count = self.ring.copy(0, &mut bytes);
            let Ok((call, length)) = decode_call(bytes.get(..count).unwrap_or(&bytes)) else {
                // It was decoded once before it went in.
                self.close();
                break;
            };
            if !offer(&call) {
                break;
            }
            self.ring.drop_front(length);
            worked = true;
        }
        worked
    }
}

const fn abort(error: BatchError) -> Abort {
    match error {
        BatchError::Version(_) => Abort::Incompatible,
        BatchError::Malformed | BatchError::Bounds(..) => Abort::Value,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::alarm::Span;
    use crate::call::Position;
    use crate::link::{BatchWriter, encode_call};
    use crate::units::Millis;

    fn call(number: u32) -> Call {
        Call {
            span: Span {
                line: number,
                ..Span::default()
            },
            origin: Position::ZERO,
            kind: CallKind::Dwell(Millis::new(number)),
        }
    }

    fn over() -> Call {
        Call {
            kind: CallKind::Over,
            ..call(0)
        }
    }

    fn batch(program: u32, first: u32, calls: &[Call]) -> Vec<u8> {
        let mut writer = BatchWriter::new(program, Revision(0), first);
        for call in calls {
            writer.push(&encode_call(call).unwrap()).unwrap();
        }
        writer.bytes().to_vec()
    }

    /// Lines of all that is handed over.
    fn drain(program_buffer: &mut ProgramBuffer) -> Vec<u32> {
        let mut lines = Vec::new();
        program_buffer.hand_over(&mut |call| {
            lines.push(call.span.line);
            true
        });
        lines
    }

    #[test]
    fn calls_wait_for_run_and_come_out_once_and_in_order() {
        let mut program_buffer = ProgramBuffer::new();
        let first = batch(7, 0, &[call(1), call(2)]);
        assert_eq!(program_buffer.take(&first, true, true), Ok(()));
        assert!(drain(&mut program_buffer).is_empty());
        assert!(program_buffer.run());
        assert_eq!(drain(&mut program_buffer), [1, 2]);
        assert!(program_buffer.awaits_more());
        // The answer was lost, and the batch comes again; the next overlaps it.
        assert_eq!(program_buffer.take(&first, true, false), Ok(()));
        let overlapping = batch(7, 1, &[call(2), call(3), over()]);
        assert_eq!(program_buffer.take(&overlapping, true, false), Ok(()));
        assert_eq!(
            (program_buffer.program(), program_buffer.next_call()),
            (7, 4)
        );
        assert_eq!(drain(&mut program_buffer), [3, 0]);
        assert!(!program_buffer.awaits_more(), "the end has come");
        assert_eq!(program_buffer.take(&overlapping, true, false), Ok(()));
        assert!(drain(&mut program_buffer).is_empty());
    }

    #[test]
    fn a_gap_another_program_and_a_call_behind_the_end_are_refused() {
        let mut program_buffer = ProgramBuffer::new();
        let refused = |program_buffer: &mut ProgramBuffer, bytes: &[u8], abort| {
            let before = (
                program_buffer.program(),
                program_buffer.next_call(),
                program_buffer.credit(),
            );
            assert_eq!(program_buffer.take(bytes, true, true), Err(abort));
            assert_eq!(
                before,
                (
                    program_buffer.program(),
                    program_buffer.next_call(),
                    program_buffer.credit()
                )
            );
        };
        refused(&mut program_buffer, &batch(7, 1, &[call(1)]), Abort::State);
        assert_eq!(
            program_buffer.take(&batch(7, 0, &[call(1)]), true, true),
            Ok(())
        );
        refused(
            &mut program_buffer,
            &batch(7, 2, &[call(3)]),
            Abort::Sequence,
        );
        refused(&mut program_buffer, &batch(8, 1, &[call(2)]), Abort::State);
        refused(
            &mut program_buffer,
            &batch(7, 1, &[over(), call(3)]),
            Abort::Value,
        );
        let mut wrong = batch(7, 1, &[call(2)]);
        wrong[1] ^= 1;
        refused(&mut program_buffer, &wrong, Abort::Incompatible);
        let mut short = batch(7, 1, &[call(2)]);
        short.pop();
        refused(&mut program_buffer, &short, Abort::Value);
        // Not ready: on an alarm, or starting.
        let next = batch(7, 1, &[call(2)]);
        assert_eq!(program_buffer.take(&next, false, true), Err(Abort::State));
    }

    #[test]
    fn what_does_not_fit_is_refused_whole() {
        let mut program_buffer = ProgramBuffer::new();
        let calls = [call(1), call(2), call(3), call(4), call(5)];
        let mut number = 0;
        loop {
            let bytes = batch(1, number, &calls);
            let fits =
                bytes.len() - batch(1, number, &[]).len() <= usize::from(program_buffer.credit());
            let expected = if fits {
                Ok(())
            } else {
                Err(Abort::OutOfMemory)
            };
            assert_eq!(program_buffer.take(&bytes, true, true), expected);
            if !fits {
                break;
            }
            number += 5;
        }
        assert!(number > 200, "{number}");
        assert!(program_buffer.run());
        assert_eq!(drain(&mut program_buffer).len(), number as usize);
        assert_eq!(usize::from(program_buffer.credit()), PROGRAM_BYTES);
    }

    #[test]
    fn a_closed_program_is_over_and_another_begins_anew() {
        let mut program_buffer = ProgramBuffer::new();
        let first = batch(7, 0, &[call(1)]);
        assert_eq!(program_buffer.take(&first, true, true), Ok(()));
        assert!(program_buffer.run());
        program_buffer.close();
        assert!(drain(&mut program_buffer).is_empty());
        let rest = batch(7, 1, &[call(2)]);
        assert_eq!(program_buffer.take(&rest, true, true), Err(Abort::State));
        // What came before the reset is still not taken twice.
        assert_eq!(program_buffer.take(&first, true, true), Ok(()));
        assert!(!program_buffer.is_open());
        let other = batch(8, 0, &[call(9)]);
        assert_eq!(program_buffer.take(&other, true, false), Err(Abort::State));
        assert_eq!(program_buffer.take(&other, true, true), Ok(()));
        // A client that begins again before it has run.
        let again = batch(9, 0, &[call(5)]);
        assert_eq!(program_buffer.take(&again, true, true), Ok(()));
        assert!(program_buffer.run());
        assert_eq!(drain(&mut program_buffer), [5]);
        let other = batch(10, 0, &[call(9)]);
        assert_eq!(program_buffer.take(&other, true, true), Err(Abort::State));
    }
}
