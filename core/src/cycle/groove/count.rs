//! Counts the work of a G75 or G74 cycle without making its moves: the columns, the infeeds, and each different move once
//! with its number of repeats. So a check takes as long for a thousand columns as for three.

use core::num::NonZero;

use super::moves::{GrooveMoves, clip};
use crate::alarm::{Alarm, At, Span};
use crate::call::{GrooveCall, Position};
use crate::moves::{Move, MoveKind};
use crate::units::Length;

/// Columns and infeeds of a groove.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrooveCount {
    /// Infeeds of a column.
    pub infeeds: u64,
    /// Columns.
    pub columns: u64,
}

impl GrooveCount {
    /// The columns and infeeds of a call that has its steps.
    #[must_use]
    pub fn of(call: &GrooveCall) -> Self {
        let steps = |way, step: &Option<At<Length>>| step.map_or(0, |step| steps(way, step.value));
        Self {
            infeeds: steps(call.bottom().value - call.level(), &call.peck),
            columns: steps(call.last().value - call.first(), &call.step).saturating_add(1),
        }
    }
}

/// The number of steps that cover a distance. The last step may be shorter.
fn steps(way: Length, step: Length) -> u64 {
    let way = way.nm().unsigned_abs();
    match NonZero::new(step.nm().unsigned_abs()) {
        None => 0,
        Some(step) => way.wrapping_add(step.get().wrapping_sub(1)) / step,
    }
}

/// The tool's position, one move from this position, and how often such a move comes.
type Each<'a> = &'a mut dyn FnMut(&Position, &Move, u64) -> Result<(), Alarm>;

impl GrooveMoves {
    /// How many columns and infeeds there are.
    #[must_use]
    pub fn totals(&self) -> GrooveCount {
        GrooveCount::of(&self.call)
    }

    /// Hands each move that differs in kind or length to `each`, with its start and how often such a move comes. The order
    /// is that of first appearance. Together these are all moves of the cycle. There are never more than a few dozen of
    /// them, however many infeeds and columns there are: a retract takes back ten infeeds at most.
    ///
    /// # Errors
    /// The first error that `each` returns.
    pub fn tally(&self, each: Each<'_>) -> Result<(), Alarm> {
        let mut tally = Tally {
            groove: self,
            depth: self.call.level(),
            column: self.call.first(),
            each,
        };
        tally.all()
    }

    /// Its words.
    pub(crate) const fn call(&self) -> &GrooveCall {
        &self.call
    }

    /// The G word.
    pub(crate) const fn span(&self) -> Span {
        self.made.span
    }

    /// Where the relief of a column ends.
    pub(crate) fn relief_end(&self, column: Length) -> Length {
        column + self.relief
    }

    /// Where infeed `n` of a column ends. Beyond the last infeed this is the bottom.
    pub(crate) fn infeed_end(&self, n: u64) -> Length {
        let end = self.call.level() + self.peck.times(n as i64);
        clip(end, self.call.bottom().value, self.peck)
    }

    /// Where the retract from a depth ends.
    pub(crate) fn retract_end(&self, depth: Length) -> Length {
        clip(depth - self.retract, self.call.level(), -self.peck)
    }

    /// The position of column `n`, from 0. Beyond the last column this is the last column's position.
    pub(crate) fn column_at(&self, n: u64) -> Length {
        let column = self.call.first() + self.step.times(n as i64);
        clip(column, self.call.last().value, self.step)
    }

    /// The number, from 1, of the first infeed that goes beyond `bound`.
    pub(crate) fn infeed_beyond(&self, bound: Length) -> u64 {
        beyond(self.call.level(), bound, self.peck)
    }

    /// The number, from 1, of the first column beyond `bound`.
    pub(crate) fn column_beyond(&self, bound: Length) -> u64 {
        beyond(self.call.first(), bound, self.step)
    }
}

/// The number of the first step from `start` that ends beyond `bound`, which lies at `start` or before it in the
/// direction of the steps.
fn beyond(start: Length, bound: Length, step: Length) -> u64 {
    let way = (bound - start).nm().unsigned_abs();
    match NonZero::new(step.nm().unsigned_abs()) {
        None => 0,
        Some(step) => (way / step).wrapping_add(1),
    }
}

/// A tally that is still being counted.
struct Tally<'g, 'e> {
    groove: &'g GrooveMoves,
    /// The tool, on the axis of the pecks and on the other.
    depth: Length,
    column: Length,
    each: Each<'e>,
}

impl Tally<'_, '_> {
    fn all(&mut self) -> Result<(), Alarm> {
        let groove = self.groove;
        let GrooveCount { infeeds, columns } = groove.totals();
        self.infeeds(infeeds, columns)?;
        if columns > 2 {
            self.shift(1, columns.wrapping_sub(2))?;
        }
        if columns > 1 {
            self.column = groove.column_at(columns.wrapping_sub(2)) + groove.relief;
            self.shift(columns.wrapping_sub(1), 1)?;
        }
        self.column = groove.call.last().value + groove.relief;
        self.rapid(groove.call.level(), groove.call.first(), 1)
    }

    /// From the start level to the bottom, aside and back to the start level. All columns are alike here.
    fn infeeds(&mut self, infeeds: u64, columns: u64) -> Result<(), Alarm> {
        let groove = self.groove;
        let level = groove.call.level();
        let mut n = 1;
        loop {
            self.infeed(n, columns)?;
            if n >= infeeds {
                break;
            }
            self.back(columns)?;
            let whole = (groove.infeed_end(n) - level).abs() >= groove.retract.abs();
            n = n.wrapping_add(1);
            if whole && n < infeeds {
                // From here on no retract ends at the start level, so the infeeds are alike up to the last but one.
                let alike = columns.saturating_mul(infeeds.wrapping_sub(n));
                self.infeed(n, alike)?;
                self.back(alike)?;
                n = infeeds;
                self.depth = groove.retract_end(groove.infeed_end(n.wrapping_sub(1)));
            }
        }
        self.rapid(self.depth, self.column + groove.relief, columns)?;
        self.rapid(level, self.column, columns)
    }

    fn infeed(&mut self, n: u64, times: u64) -> Result<(), Alarm> {
        let feed = MoveKind::Feed(self.groove.call.feed);
        self.go(self.groove.infeed_end(n), self.column, feed, times)
    }

    fn back(&mut self, times: u64) -> Result<(), Alarm> {
        self.rapid(self.groove.retract_end(self.depth), self.column, times)
    }

    /// To column `n`, from 0.
    fn shift(&mut self, n: u64, times: u64) -> Result<(), Alarm> {
        self.rapid(self.groove.call.level(), self.groove.column_at(n), times)
    }

    /// A rapid, unless the tool is there.
    fn rapid(&mut self, depth: Length, column: Length, times: u64) -> Result<(), Alarm> {
        if (depth, column) == (self.depth, self.column) {
            return Ok(());
        }
        self.go(depth, column, MoveKind::Rapid, times)
    }

    fn go(
        &mut self,
        depth: Length,
        column: Length,
        kind: MoveKind,
        times: u64,
    ) -> Result<(), Alarm> {
        let call = &self.groove.call;
        let from = call.place(self.depth, self.column);
        (self.depth, self.column) = (depth, column);
        let step = Move {
            span: self.groove.span(),
            to: call.place(depth, column),
            kind,
            tag: None,
        };
        (self.each)(&from, &step, times)
    }
}
