//! What the background hands to the tick: a planned piece of work.

use super::plan::Timed;
use super::tap::{FloatPlan, Tap};
use super::thread::ThreadPlan;
use crate::alarm::{Alarm, Span};
use crate::program::{Aux, Position, TapSpindle};
use crate::units::{Length, Rpm};

/// Counts how often a board has forgotten what was queued. What is still in a queue from before is told by it, and
/// dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Epoch(u8);

impl Epoch {
    /// The next one. A queue holds far fewer segments than there are epochs.
    #[must_use]
    pub const fn next(self) -> Self {
        Self(self.0.wrapping_add(1))
    }
}

/// Which thread or hole of a program a segment belongs to: those cut by one call of a threading cycle, or on the way
/// through one hole, have the same number. Counted from one to the next, and round:
/// what is apart is told by it, and no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Its number.
    pub number: u8,
    /// Of a stroke: it is the last one of the thread, or out of the hole.
    pub last: bool,
}

impl Cut {
    /// Nothing has been cut yet.
    pub const NONE: Self = Self {
        number: 0,
        last: true,
    };

    /// The next one, at its beginning.
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
    /// Number of the (first) move it came from, as `expand` counts them, from 1.
    pub number: u32,
    /// The block it came from.
    pub span: Span,
    /// When it was planned.
    pub epoch: Epoch,
    /// The thread or hole it belongs to, or the last one before it.
    pub cut: Cut,
    /// What feed hold and single block may do here.
    pub stops: Stops,
    /// The work.
    pub action: Action,
}

/// A segment with its plan beside it, as the tick sees the two: at the head of their queues.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The segment.
    pub segment: &'a Segment,
    /// Of an [`Action::Planned`].
    pub plan: Option<&'a Plan>,
}

impl<'a> Task<'a> {
    /// The pass of a thread, if it is one.
    #[must_use]
    pub const fn pass(self) -> Option<&'a Pass> {
        match self.plan {
            Some(Plan::Thread(pass)) => Some(pass),
            _ => None,
        }
    }

    /// The strokes of a rigid tap, if it is one.
    #[must_use]
    pub const fn tap(self) -> Option<&'a Tap> {
        match self.plan {
            Some(Plan::Tap(tap)) => Some(tap),
            _ => None,
        }
    }

    /// The hole of an ordinary tap, if it is one.
    #[must_use]
    pub const fn float(self) -> Option<&'a FloatPlan> {
        match self.plan {
            Some(Plan::Float(plan)) => Some(plan),
            _ => None,
        }
    }

    /// The move, if it is one that time drives.
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
    /// What is bound to the spindle: its [`Plan`] lies in a queue of its own.
    Planned,
    /// The tap is out of its hole already: its journal is cleared.
    TapOut,
    /// Stand still for so many ticks.
    Dwell(u32),
    /// Command a spindle speed.
    Spindle(Rpm),
    /// Bring spindle 1 to a stand, and this one into position mode, for tapping.
    Rigid(TapSpindle),
    /// Switch a machine function.
    Aux(Aux),
    /// All that was planned before is done and the next call cannot be: raise this.
    Alarm(Alarm),
    /// The program has ended.
    End,
}

/// The plan of a motion that is bound to the spindle. It is several times as large as a segment, and few of many segments
/// have one [D139].
// The largest is what a queue has room for, whichever it holds.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub enum Plan {
    /// Driven by the spindle angle: a whole pass with run-in and run-out.
    Thread(Pass),
    /// Driven by time, the spindle geared to it: a whole way from R into a hole and back.
    Tap(Tap),
    /// Driven by the measured spindle angle, and turning the spindle: a whole hole of ordinary tapping.
    Float(FloatPlan),
}

/// A pass of a thread as the tick needs it.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// The planned pass.
    pub plan: ThreadPlan,
    /// How it can be left.
    pub ways: WaysOut,
    /// Commanded speed, override included.
    pub rpm: Rpm,
}

/// What the ways out of a pass need to know of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WaysOut {
    /// X is the long axis.
    pub long_x: bool,
    /// Where the pass starts.
    pub start: Position,
    /// A: where its cycle starts and ends; a retract in mid-thread goes there.
    pub home: Position,
    /// Where the short axis is clear of both crests, C's and D's, or at the start level.
    pub clear: Length,
}

impl WaysOut {
    /// Out of the pass `plan`, `depth` below the crest, of a cycle that starts at `home`; `clearance`: how far beyond the
    /// crests is clear.
    #[must_use]
    pub fn new(plan: &ThreadPlan, home: Position, depth: Length, clearance: Length) -> Self {
        let mut ways = Self {
            long_x: plan.long_x(),
            start: plan.start(),
            home,
            clear: Length::ZERO,
        };
        let up = ways.short_of(home);
        let level = plan.level_towards(up);
        let out = (depth + clearance).min((up - level).abs());
        ways.clear = level + out.times((up - level).signum());
        ways
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
    /// Whatever is asked for may happen.
    pub const NONE: Self = Self {
        hold_not_inside: false,
        hold_not_before: false,
        single_block: false,
        frozen: None,
        tap_cycle: false,
        stops_after_last_hole: false,
    };
}

/// Where an operator's stop may take effect, and what is frozen meanwhile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stops {
    /// Feed hold does not act inside: the stroke of a thread and the X retract behind it.
    pub hold_not_inside: bool,
    /// Feed hold does not act before it either: the retract behind a stroke.
    pub hold_not_before: bool,
    /// Single block stops after this segment.
    pub single_block: bool,
    /// Part of a thread cycle: the spindle override in percent with which it was planned, frozen.
    pub frozen: Option<u8>,
    /// Part of a tapping cycle.
    pub tap_cycle: bool,
    /// Single block stops after this segment only where no further hole follows (5200.6 = 0).
    pub stops_after_last_hole: bool,
}
