//! G75: turns one call into its moves, lazily and in constant memory ([G75 sheet]).

use super::refuse::refuse_groove;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::GrooveCall;
use crate::cycle::check::blame;
use crate::moves::{Cycle, Move, MoveKind, Stage, Tag};
use crate::units::Length;

/// The moves of a G75 cycle.
///
/// In each column the tool pecks along X with a retract of e between pecks, moves Δd aside at the bottom, returns to the
/// start level and goes on to the next column. Targets are absolute and independent of the retract. Moves of zero length
/// are left out. The last move ends at A. Nothing can fail after the value is made.
#[derive(Clone, Copy, Debug)]
pub struct GrooveMoves {
    pub(in crate::cycle) call: GrooveCall,
    /// Δi with the direction of the infeed.
    pub(in crate::cycle) peck: Length,
    /// Δk with the direction from A to D; zero where there is one column.
    pub(in crate::cycle) step: Length,
    /// e, against the infeed.
    pub(in crate::cycle) retract: Length,
    /// Δd with its direction.
    pub(in crate::cycle) relief: Length,
    /// The last move. It ends at the tool's position.
    pub(in crate::cycle) made: Move,
    next: Next,
    /// Deepest target of the column so far.
    target: Length,
    /// Z of the column.
    column_z: Length,
    column: u32,
    pecks: u32,
}

/// The next step of the cycle.
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
    /// No depth (4109); no P, or no Q where the last column is not the first (0319); lengths out of range (4110); more
    /// infeeds (4112) or a longer retract (4113) than a groove may have.
    pub fn new(call: &GrooveCall, span: Span) -> Result<Self, Alarm> {
        refuse_groove(call, span)?;
        Ok(Self::of(call, span))
    }

    /// The moves of a call that [`refuse_groove`] has accepted.
    pub(crate) fn of(call: &GrooveCall, span: Span) -> Self {
        let infeed = (call.end_x.value - call.start.x).signum();
        let across = (call.end_z.value - call.start.z).signum();
        // Against the infeed along Z; the sheet's step 4 puts an equal Z on the negative side, its R word a missing Z on
        // the positive one.
        let aside = match across {
            0 if call.z_written => -1,
            0 => 1,
            sign => sign.wrapping_neg(),
        };
        let written = |step: &Option<At<Length>>| step.map_or(Length::ZERO, |step| step.value);
        Self {
            call: *call,
            peck: written(&call.peck).times(infeed),
            step: written(&call.step).times(across),
            retract: call.retract.value.times(infeed),
            relief: call.relief.value.times(aside),
            made: Move {
                span,
                to: call.start,
                kind: MoveKind::Rapid,
                tag: Some(Tag {
                    cycle: Cycle::G75,
                    pass: 1,
                    start: 0,
                    peck: 0,
                    stage: Stage::Peck,
                    depth: Length::ZERO,
                }),
            },
            next: Next::Peck,
            target: call.start.x,
            column_z: call.start.z,
            column: 1,
            pecks: 0,
        }
    }

    /// The warning of this cycle: the first column of a groove has no room for Δd.
    #[must_use]
    pub fn warning(&self) -> Option<Alarm> {
        let relief = &self.call.relief;
        (relief.value != Length::ZERO).then(|| {
            blame(Code::ReliefInSlot, self.made.span, &relief.span, b'R')
                .with([Arg::Length(relief.value)])
        })
    }

    /// Moves to (`x`, `z`) as a rapid, unless the tool is there.
    fn rapid(&mut self, x: Length, z: Length, stage: Stage) -> bool {
        if x == self.made.to.x && z == self.made.to.z {
            return false;
        }
        self.made.kind = MoveKind::Rapid;
        self.go(x, z, stage, 0)
    }

    /// Completes the last move, which already has its kind.
    fn go(&mut self, x: Length, z: Length, stage: Stage, peck: u32) -> bool {
        self.made.to.x = x;
        self.made.to.z = z;
        if let Some(tag) = &mut self.made.tag {
            tag.pass = self.column;
            tag.peck = peck;
            tag.stage = stage;
            tag.depth = (x - self.call.start.x).abs();
        }
        true
    }

    /// The next move by reference: [`Iterator::next`] without the copy.
    pub fn advance(&mut self) -> Option<&Move> {
        loop {
            let level = self.call.start.x;
            let at = self.made.to;
            let made = match self.next {
                Next::Peck => {
                    let bottom = self.call.end_x.value;
                    self.target = clip(self.target + self.peck, bottom, self.peck);
                    self.pecks = self.pecks.saturating_add(1);
                    self.next = if self.target == bottom {
                        Next::Relief
                    } else {
                        Next::Back
                    };
                    self.made.kind = MoveKind::Feed(self.call.feed);
                    self.go(self.target, at.z, Stage::Peck, self.pecks)
                }
                Next::Back => {
                    self.next = Next::Peck;
                    let back = clip(at.x - self.retract, level, -self.peck);
                    self.rapid(back, at.z, Stage::Retract)
                }
                Next::Relief => {
                    self.next = Next::Level;
                    self.rapid(at.x, at.z + self.relief, Stage::Relief)
                }
                Next::Level => {
                    self.next = if self.column_z == self.call.end_z.value {
                        Next::Return
                    } else {
                        Next::Shift
                    };
                    self.rapid(level, at.z, Stage::Retract)
                }
                Next::Shift => {
                    let end = self.call.end_z.value;
                    self.column_z = clip(self.column_z + self.step, end, self.step);
                    let made = self.rapid(level, self.column_z, Stage::Shift);
                    self.column = self.column.saturating_add(1);
                    self.target = level;
                    self.pecks = 0;
                    self.next = Next::Peck;
                    made
                }
                Next::Return => {
                    self.next = Next::Done;
                    self.rapid(level, self.call.start.z, Stage::Return)
                }
                Next::Done => return None,
            };
            if made {
                return Some(&self.made);
            }
        }
    }
}

impl Iterator for GrooveMoves {
    type Item = Move;

    fn next(&mut self) -> Option<Move> {
        self.advance().copied()
    }
}

impl core::iter::FusedIterator for GrooveMoves {}

/// `value`, or `bound` where `value` lies beyond it in `direction`. `direction` is zero only where `value` is `bound`.
pub(in crate::cycle) fn clip(value: Length, bound: Length, direction: Length) -> Length {
    if direction < Length::ZERO {
        value.max(bound)
    } else {
        value.min(bound)
    }
}
