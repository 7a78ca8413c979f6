//! M19: spindle 1 turns to an angle and stays there, in position mode.
//!
//! ```text
//! comes to a stand ─► position mode ─► the index, if it has not been seen ─► the shorter way ─► there
//! ```
//!
//! The drive counts from a place of its own, so the encoder says where the spindle stands, and the drive how far it turns
//! from there [D508]. Each motion begins and ends at rest. The segment stays at the head of its queue until it is done.

use super::spindle::Rigid;
use super::{Ends, Ticker, emit};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::TapSpindle;
use crate::motion::{Action, Motion, Orientation, Segment};
use crate::tick::Event;
use crate::units::{Angle, Rpm, Turns};

/// How far from its angle the spindle may be: 0.1°, in 2⁻³² turns.
const TOLERANCE: i64 = (1 << 32) / 3600;

/// It is there after this part of a second within the tolerance.
const SETTLED: u32 = 20;

/// A way that passes the index: a turn, and an eighth for what the encoder may have missed at its beginning.
const SEARCH: Turns = Turns::from_raw((1 << 32) + (1 << 29));

/// What the spindle is doing on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// It stands, and where it stands is to be found.
    Stands,
    /// It turns past the index.
    Searches,
    /// It turns to its angle.
    Approaches,
}

/// On the way to an angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    stage: Stage,
    /// Ticks since the motion of this stage has ended.
    ticks: u32,
    /// Ticks in a row within the tolerance.
    within: u32,
}

impl Turning {
    const fn new(stage: Stage) -> Self {
        Self {
            stage,
            ticks: 0,
            within: 0,
        }
    }
}

impl Ticker {
    /// M19 at the head of the queue: the spindle is brought into position mode, then to its angle.
    #[cold]
    #[inline(never)]
    pub(super) fn orient(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let next = ends.segments.head()?;
        let (number, line) = (next.number, next.span.line);
        self.ask_for_rigid(TapSpindle::First, number, line);
        if self.spindle.is_rigid() {
            self.spindle.rigid = Rigid::Turning(Turning::new(Stage::Stands));
            emit(&mut ends.events, Event::Started { number, line });
            emit(&mut ends.events, Event::Spindle(Rpm::STOPPED));
        }
        Some((number, line, Motion::Wait))
    }

    /// A tick in which the spindle stands on its way to an angle: the next motion begins, or it is there.
    #[cold]
    #[inline(never)]
    pub(super) fn go_on_turning(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let Rigid::Turning(mut turning) = self.spindle.rigid else {
            return None;
        };
        let Some(Order { number, span, to }) = self.course.next(ends).and_then(Order::of) else {
            self.spindle.rigid = Rigid::Oriented;
            return None;
        };
        let beside = self.drives.spindles().beside();
        let (here, half) = self.observer.count_at_rest();
        let left = to.way(here);
        let near = |by: Turns, allowed: i64| by.raw().saturating_abs() <= allowed;
        let rests = beside.is_some_and(|beside| near(beside, TOLERANCE));
        let settles = match turning.stage {
            Stage::Stands | Stage::Searches => rests,
            // The count says the same, as well as it can.
            Stage::Approaches => rests && near(left, TOLERANCE.saturating_add(half.raw() << 1)),
        };
        turning.ticks = turning.ticks.saturating_add(1);
        turning.within = if settles {
            turning.within.saturating_add(1)
        } else {
            0
        };
        let is_settled = turning.within >= self.given.second / SETTLED;
        self.spindle.rigid = Rigid::Turning(turning);
        match turning.stage {
            // It has not been seen, or was lost on the way.
            Stage::Searches | Stage::Approaches if is_settled && !self.observer.indexed() => {
                self.raise(&Alarm::new(Code::NoIndex, span), ends);
            }
            Stage::Approaches if is_settled => return self.is_oriented(ends),
            Stage::Stands | Stage::Searches if is_settled => {
                let (stage, way) = match self.observer.indexed() {
                    true => (Stage::Approaches, left + beside.unwrap_or_default()),
                    false => (Stage::Searches, SEARCH),
                };
                self.spindle.rigid = Rigid::Turning(Turning::new(stage));
                self.executor.begin_turn(way, &to, number, span);
            }
            _ if turning.ticks > self.given.arrival.speed_ticks => {
                let angle = |turns: Turns| {
                    let part = i64::from(turns.raw() as u32);
                    Arg::Angle(Angle::from_udeg(part.wrapping_mul(360_000_000) >> 32))
                };
                let figures = [angle(here), angle(to.angle)];
                let alarm = Alarm::new(Code::SpindleNotOriented, span).with(figures);
                self.raise(&alarm, ends);
            }
            _ => {}
        }
        Some((number, span.line, Motion::Wait))
    }

    /// The spindle is at its angle.
    fn is_oriented(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        self.spindle.rigid = Rigid::Oriented;
        let over = ends.segments.head()?;
        let (number, line, stops) = (over.number, over.span.line, over.stops);
        ends.segments.take();
        self.course.pause_after(stops, self.operator.single_block);
        Some((number, line, Motion::Run))
    }
}

/// What a segment asks for.
struct Order {
    number: u32,
    span: Span,
    to: Orientation,
}

impl Order {
    const fn of(segment: &Segment) -> Option<Self> {
        match segment.action {
            Action::Orient(to) => Some(Self {
                number: segment.number,
                span: segment.span,
                to,
            }),
            _ => None,
        }
    }
}
