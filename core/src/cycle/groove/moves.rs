//! G75 and G74: turns one call into its moves, lazily and in constant memory ([G75 sheet]).

use super::refuse::refuse_groove;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{GrooveCall, TapAxis};
use crate::cycle::check::blame;
use crate::moves::{Cycle, Move, MoveKind, Stage, Tag};
use crate::units::Length;

/// The moves of a G75 or G74 cycle.
///
/// In each column the tool pecks along X (G74: Z) with a retract of e between pecks, moves Δd aside at the bottom, returns
/// to the start level and goes on to the next column. Targets are absolute and independent of the retract. Moves of zero
/// length are left out. The last move ends at A. Nothing can fail after the value is made.
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
    /// The column.
    column_at: Length,
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

const fn cycle_of(call: &GrooveCall) -> Cycle {
    match call.axis {
        TapAxis::X => Cycle::G75,
        TapAxis::Z => Cycle::G74,
    }
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

    /// Which cycle.
    #[must_use]
    pub const fn cycle(&self) -> Cycle {
        cycle_of(&self.call)
    }

    /// The moves of a call that [`refuse_groove`] has accepted.
    pub(crate) fn of(call: &GrooveCall, span: Span) -> Self {
        let infeed = (call.bottom().value - call.level()).signum();
        let across = (call.last().value - call.first()).signum();
        // Against the way to the last column; the sheet's step 4 puts an equal Z on the negative side, its R word a
        // missing Z on the positive one.
        let aside = match across {
            0 if call.last_written => -1,
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
                    cycle: cycle_of(call),
                    pass: 1,
                    start: 0,
                    peck: 0,
                    stage: Stage::Peck,
                    depth: Length::ZERO,
                }),
            },
            next: Next::Peck,
            target: call.level(),
            column_at: call.first(),
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

    /// The tool, on the axis of the pecks and on the other.
    const fn at(&self) -> (Length, Length) {
        let axis = self.call.axis;
        (axis.of(self.made.to), axis.other().of(self.made.to))
    }

    /// Moves to a depth and a column as a rapid, unless the tool is there.
    fn rapid(&mut self, depth: Length, across: Length, stage: Stage) -> bool {
        if (depth, across) == self.at() {
            return false;
        }
        self.made.kind = MoveKind::Rapid;
        self.go(depth, across, stage, 0)
    }

    /// Completes the last move, which already has its kind.
    fn go(&mut self, depth: Length, across: Length, stage: Stage, peck: u32) -> bool {
        self.made.to = self.call.place(depth, across);
        if let Some(tag) = &mut self.made.tag {
            tag.pass = self.column;
            tag.peck = peck;
            tag.stage = stage;
            tag.depth = (depth - self.call.level()).abs();
        }
        true
    }

    /// The next move by reference: [`Iterator::next`] without the copy.
    pub fn advance(&mut self) -> Option<&Move> {
        loop {
            let level = self.call.level();
            let (depth, across) = self.at();
            let made = match self.next {
                Next::Peck => {
                    let bottom = self.call.bottom().value;
                    self.target = clip(self.target + self.peck, bottom, self.peck);
                    self.pecks = self.pecks.saturating_add(1);
                    self.next = if self.target == bottom {
                        Next::Relief
                    } else {
                        Next::Back
                    };
                    self.made.kind = MoveKind::Feed(self.call.feed);
                    self.go(self.target, across, Stage::Peck, self.pecks)
                }
                Next::Back => {
                    self.next = Next::Peck;
                    let back = clip(depth - self.retract, level, -self.peck);
                    self.rapid(back, across, Stage::Retract)
                }
                Next::Relief => {
                    self.next = Next::Level;
                    self.rapid(depth, across + self.relief, Stage::Relief)
                }
                Next::Level => {
                    self.next = if self.column_at == self.call.last().value {
                        Next::Return
                    } else {
                        Next::Shift
                    };
                    self.rapid(level, across, Stage::Retract)
                }
                Next::Shift => {
                    let last = self.call.last().value;
                    self.column_at = clip(self.column_at + self.step, last, self.step);
                    let made = self.rapid(level, self.column_at, Stage::Shift);
                    self.column = self.column.saturating_add(1);
                    self.target = level;
                    self.pecks = 0;
                    self.next = Next::Peck;
                    made
                }
                Next::Return => {
                    self.next = Next::Done;
                    self.rapid(level, self.call.first(), Stage::Return)
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
