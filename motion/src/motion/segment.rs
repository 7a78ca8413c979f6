//! Segments: the planned pieces of work that the background hands to the tick.

use super::plan::Timed;
use super::tap::{FloatPlan, Tap};
use super::thread::ThreadPlan;
use super::turn::Orientation;
use crate::alarm::{Alarm, Span};
use crate::call::{Aux, Position, SurfaceSpeed, TapSpindle};
use crate::params::FunctionRow;
use crate::units::{Length, Rpm};

/// Counts how often a board has forgotten its queued segments. A segment with an older epoch is left over in a queue;
/// the board recognises it by its epoch and drops it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Epoch(u8);

impl Epoch {
    /// The epoch of a new board.
    pub(super) const FIRST: Self = Self(0);

    /// The next epoch. A queue holds far fewer segments than there are epochs.
    #[must_use]
    pub const fn next(self) -> Self {
        Self(self.0.wrapping_add(1))
    }
}

/// Tells to which thread or hole of a program a segment belongs. All segments of one call of a threading cycle, or of
/// one hole, have the same number. The number counts up from one thread or hole to the next and wraps. Different
/// numbers mean different threads or holes; the number tells nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Number of the thread or hole.
    pub number: u8,
    /// For a stroke: this is the last stroke of the thread, or the stroke out of the hole.
    pub last: bool,
}

impl Cut {
    /// The value before anything is cut.
    pub const NONE: Self = Self {
        number: 0,
        last: true,
    };

    /// The next thread or hole, at its beginning.
    #[must_use]
    pub const fn next(self) -> Self {
        Self {
            number: self.number.wrapping_add(1),
            last: false,
        }
    }
}

/// One planned piece of work with its place in the program.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Number of the (first) move from which the segment came, as `expand` counts moves, from 1.
    pub number: u32,
    /// The block from which the segment came.
    pub span: Span,
    /// The epoch in which the segment was planned.
    pub epoch: Epoch,
    /// The thread or hole to which the segment belongs, or the last one before it.
    pub cut: Cut,
    /// The effect that feed hold and single block may have here.
    pub stops: Stops,
    /// The work.
    pub action: Action,
}

/// A segment together with its plan, as the tick sees them: each at the head of its queue.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The segment.
    pub segment: &'a Segment,
    /// The plan, if the action is [`Action::Planned`].
    pub plan: Option<&'a Plan>,
}

impl<'a> Task<'a> {
    /// The threading pass, if this is one.
    #[must_use]
    pub const fn pass(self) -> Option<&'a Pass> {
        match self.plan {
            Some(Plan::Thread(pass)) => Some(pass),
            _ => None,
        }
    }

    /// The strokes of a rigid tap, if this is one.
    #[must_use]
    pub const fn tap(self) -> Option<&'a Tap> {
        match self.plan {
            Some(Plan::Tap(tap)) => Some(tap),
            _ => None,
        }
    }

    /// The hole of an ordinary tap, if this is one.
    #[must_use]
    pub const fn float(self) -> Option<&'a FloatPlan> {
        match self.plan {
            Some(Plan::Float(plan)) => Some(plan),
            _ => None,
        }
    }

    /// The move, if it is driven by time.
    #[must_use]
    pub const fn timed(self) -> Option<&'a Timed> {
        match &self.segment.action {
            Action::Timed(timed) => Some(timed),
            _ => None,
        }
    }
}

/// The work of a segment.
#[derive(Clone, Copy, Debug)]
pub enum Action {
    /// Driven by time: rapid, feed, arc.
    Timed(Timed),
    /// A motion bound to the spindle. Its [`Plan`] lies in a separate queue.
    Planned,
    /// The tap is already out of its hole: clear its journal.
    TapOut,
    /// Stand still for this many ticks.
    Dwell(u32),
    /// Command a spindle speed; with a law, the speed follows the tool from then on.
    Spindle(Rpm, Option<SurfaceSpeed>),
    /// Stop spindle 1 and switch this spindle to position mode, for tapping.
    Rigid(TapSpindle),
    /// Stop spindle 1, switch it to position mode, and turn it to an angle.
    Orient(Orientation),
    /// Switch a machine function, as its row says where it has one.
    Aux(Aux, Option<FunctionRow>),
    /// All earlier planned work is done, and the next call cannot be done: raise this alarm.
    Alarm(Alarm),
    /// The program has ended.
    End,
    /// A line that was typed has ended.
    LineEnd,
}

/// The plan of a motion bound to the spindle. A plan is several times as large as a segment, and only few segments have
/// one [D139].
// A queue needs room for the largest plan anyway, whichever plan it holds.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub enum Plan {
    /// Driven by the spindle angle: one whole threading pass with run-in and run-out.
    Thread(Pass),
    /// Driven by time, with the spindle geared to the axis: the whole way from R into a hole and back.
    Tap(Tap),
    /// Driven by the measured spindle angle, while the tap also commands the spindle: one whole hole of ordinary
    /// tapping.
    Float(FloatPlan),
}

/// A threading pass as the tick needs it.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// The planned pass.
    pub plan: ThreadPlan,
    /// The ways to leave the pass early.
    pub ways: WaysOut,
    /// Commanded speed, override included.
    pub rpm: Rpm,
}

/// The data of a pass that its ways out need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WaysOut {
    /// X is the long axis.
    pub long_x: bool,
    /// The start of the pass.
    pub start: Position,
    /// Point A, where the pass's cycle starts and ends. A retract in mid-thread goes there.
    pub home: Position,
    /// The short axis' coordinate that is clear of both crests, at C and at D; or the start level if that is nearer. Of a
    /// stroke (G32): beside its whole line, as far as its run-out goes.
    pub clear: Length,
    /// The sign of the short axis' way from the work; 0 for a stroke without a run-out: nothing says on which side of it
    /// the work is.
    pub side: i64,
}

impl WaysOut {
    /// The ways out of the pass `plan`. The pass is `depth` below the crest and belongs to a cycle that starts at
    /// `home`. From `clearance` beyond the crests on, the tool is clear.
    #[must_use]
    pub fn new(plan: &ThreadPlan, home: Position, depth: Length, clearance: Length) -> Self {
        let mut ways = Self {
            long_x: plan.long_x(),
            start: plan.start(),
            home,
            clear: Length::ZERO,
            side: 0,
        };
        let up = ways.short_of(home);
        if ways.stays() {
            let out = plan.beyond_line();
            ways.side = out.signum();
            ways.clear = plan.level_towards(Length::INPUT_LIMIT.times(ways.side)) + out;
            return ways;
        }
        ways.side = (up - ways.short_of(ways.start)).signum();
        let level = plan.level_towards(up);
        let out = (depth + clearance).min((up - level).abs());
        ways.clear = level + out.times((up - level).signum());
        ways
    }

    /// The pass is a stroke, which begins at A and is not followed by a way back: the tool stays where it ends.
    #[must_use]
    pub fn stays(&self) -> bool {
        self.short_of(self.home) == self.short_of(self.start)
    }

    /// The short axis' coordinate.
    #[must_use]
    pub const fn short_of(&self, position: Position) -> Length {
        if self.long_x { position.z } else { position.x }
    }

    /// Sets the short axis' coordinate.
    pub const fn set_short(&self, position: &mut Position, to: Length) {
        if self.long_x {
            position.z = to;
        } else {
            position.x = to;
        }
    }
}

impl Stops {
    /// No stop is forbidden, and nothing is frozen.
    pub const NONE: Self = Self {
        hold_not_inside: false,
        hold_not_before: false,
        single_block: false,
        frozen: None,
        tap_cycle: false,
        stops_after_last_hole: false,
    };
}

/// Where an operator's stop may take effect, and the override that is frozen in the segment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stops {
    /// Feed hold does not act inside this segment: the stroke of a thread, and the X retract after the stroke.
    pub hold_not_inside: bool,
    /// Feed hold does not act before this segment either: the retract after a stroke.
    pub hold_not_before: bool,
    /// Single block stops after this segment.
    pub single_block: bool,
    /// Part of a thread cycle. The value is the frozen spindle override in percent, with which the cycle was planned.
    pub frozen: Option<u8>,
    /// Part of a tapping cycle.
    pub tap_cycle: bool,
    /// Single block stops after this segment only if no further hole follows (5200.6 = 0).
    pub stops_after_last_hole: bool,
}
