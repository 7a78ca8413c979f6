//! G75: one call to its moves, lazily and in constant memory ([G75 sheet]; cycles.md section 5).

use super::check::{blame, groove_ranges};
use super::{Cycle, Move, MoveKind, Stage, Tag};
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::program::{FeedRate, GrooveCall, Position};
use crate::units::Length;

/// The moves of a G75 cycle.
///
/// Column by column: pecks along X with a retract of e between them, Δd aside at the bottom, back to the start level, on
/// to the next column. Targets are absolute, whatever the retract was. Moves of no length are left out. The last one ends
/// at A. Nothing can fail once it is made.
#[derive(Clone, Copy, Debug)]
pub struct GrooveMoves {
    span: Span,
    start: Position,
    end_x: Length,
    end_z: Length,
    /// Δi with the direction of the infeed.
    peck: Length,
    /// Δk with the direction from A to D; zero where there is one column.
    step: Length,
    /// e, against the infeed.
    retract: Length,
    /// Δd with its direction.
    relief: Length,
    feed: FeedRate,
    warning: Option<Alarm>,
    next: Next,
    x: Length,
    z: Length,
    /// Deepest target of the column so far.
    target: Length,
    /// Z of the column.
    column_z: Length,
    column: u32,
    pecks: u32,
}

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    Peck,
    Back,
    Relief,
    Level,
    Shift,
    Return,
    Done,
}

impl GrooveMoves {
    /// The moves of `call`, whose G word stands at `span`.
    ///
    /// # Errors
    /// No depth (4109), no P, or no Q where the last column is not the first (0319), lengths out of range (4110).
    #[inline(never)]
    pub fn new(call: &GrooveCall, span: Span) -> Result<Self, Alarm> {
        groove_ranges(call, span)?;
        let depth = call.end_x.value - call.start.x;
        if depth == Length::ZERO {
            return Err(blame(
                Code::GrooveWithoutDepth,
                span,
                &call.end_x.span,
                b'X',
            ));
        }
        let width = call.end_z.value - call.start.z;
        let peck = step(call.peck, b'P', span)?;
        let step = if width == Length::ZERO {
            Length::ZERO
        } else {
            step(call.step, b'Q', span)?
        };
        // Against the infeed along Z; the sheet's step 4 puts an equal Z on the negative side, its R word a missing Z on
        // the positive one.
        let aside = match width.signum() {
            0 if call.z_written => -1,
            0 => 1,
            sign => sign.wrapping_neg(),
        };
        let relief = call.relief.value;
        let warning = (relief != Length::ZERO).then(|| {
            blame(Code::ReliefInSlot, span, &call.relief.span, b'R').with([Arg::Length(relief)])
        });
        Ok(Self {
            span,
            start: call.start,
            end_x: call.end_x.value,
            end_z: call.end_z.value,
            peck: peck.times(depth.signum()),
            step: step.times(width.signum()),
            retract: call.retract.value.times(depth.signum()),
            relief: relief.times(aside),
            feed: call.feed,
            warning,
            next: Next::Peck,
            x: call.start.x,
            z: call.start.z,
            target: call.start.x,
            column_z: call.start.z,
            column: 1,
            pecks: 0,
        })
    }

    /// The warning that belongs to the cycle: Δd has no room in the first column of a groove.
    #[must_use]
    pub const fn warning(&self) -> Option<Alarm> {
        self.warning
    }

    /// Moves to (`x`, `z`) as a rapid, unless the tool is there.
    fn rapid(&mut self, x: Length, z: Length, stage: Stage) -> Option<Move> {
        if x == self.x && z == self.z {
            return None;
        }
        Some(self.go(x, z, MoveKind::Rapid, stage, 0))
    }

    fn go(&mut self, x: Length, z: Length, kind: MoveKind, stage: Stage, peck: u32) -> Move {
        self.x = x;
        self.z = z;
        Move {
            span: self.span,
            to: Position {
                x,
                z,
                c: self.start.c,
            },
            kind,
            tag: Some(Tag {
                cycle: Cycle::G75,
                pass: self.column,
                start: 0,
                peck,
                stage,
                depth: (x - self.start.x).abs(),
            }),
        }
    }
}

impl Iterator for GrooveMoves {
    type Item = Move;

    fn next(&mut self) -> Option<Move> {
        loop {
            let level = self.start.x;
            let made = match self.next {
                Next::Peck => {
                    self.target = clip(self.target + self.peck, self.end_x, self.peck);
                    self.pecks = self.pecks.saturating_add(1);
                    self.next = if self.target == self.end_x {
                        Next::Relief
                    } else {
                        Next::Back
                    };
                    let kind = MoveKind::Feed(self.feed);
                    Some(self.go(self.target, self.z, kind, Stage::Peck, self.pecks))
                }
                Next::Back => {
                    self.next = Next::Peck;
                    let back = clip(self.x - self.retract, level, -self.peck);
                    self.rapid(back, self.z, Stage::Retract)
                }
                Next::Relief => {
                    self.next = Next::Level;
                    self.rapid(self.x, self.z + self.relief, Stage::Relief)
                }
                Next::Level => {
                    self.next = if self.column_z == self.end_z {
                        Next::Return
                    } else {
                        Next::Shift
                    };
                    self.rapid(level, self.z, Stage::Retract)
                }
                Next::Shift => {
                    self.column_z = clip(self.column_z + self.step, self.end_z, self.step);
                    let made = self.rapid(level, self.column_z, Stage::Shift);
                    self.column = self.column.saturating_add(1);
                    self.target = level;
                    self.pecks = 0;
                    self.next = Next::Peck;
                    made
                }
                Next::Return => {
                    self.next = Next::Done;
                    self.rapid(level, self.start.z, Stage::Return)
                }
                Next::Done => return None,
            };
            if made.is_some() {
                return made;
            }
        }
    }
}

impl core::iter::FusedIterator for GrooveMoves {}

/// `value`, or `bound` where going in `direction` (not zero, or `value` is the bound) has passed it.
fn clip(value: Length, bound: Length, direction: Length) -> Length {
    if direction < Length::ZERO {
        value.max(bound)
    } else {
        value.min(bound)
    }
}

/// A peck or step that must be there.
fn step(written: Option<At<Length>>, letter: u8, span: Span) -> Result<Length, Alarm> {
    match written {
        Some(step) if step.value > Length::ZERO => Ok(step.value),
        Some(step) => Err(Alarm::new(Code::GrooveStepMissing, step.span).word(letter)),
        None => Err(Alarm::new(Code::GrooveStepMissing, span)),
    }
}
