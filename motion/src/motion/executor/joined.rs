//! Joined cuts in the executor: one tick, and the change from one cut to the next.

use super::{Conditions, Executor, Setpoint};
use crate::alarm::Alarm;
use crate::motion::plan::Timed;
use crate::motion::rate::Rate;
use crate::motion::segment::{Action, Task};
use crate::units::Length;

impl Executor {
    /// True if the next stretch was taken in the last tick of a joined cut.
    #[must_use]
    pub const fn has_taken(&self) -> bool {
        self.taken
    }

    /// True if the tool has passed the end of the segment in the last tick of a joined cut. The segment is over then, and
    /// [`cross`](Self::cross) has to follow with the next one, in the same tick. Also true after a tick of a stroke from
    /// which the next one of its chain has to [take over](Self::take_over), before the next tick.
    #[must_use]
    pub const fn has_crossed(&self) -> bool {
        self.crossed
    }

    /// A tick of a cut that is joined to others.
    #[inline(never)]
    pub(super) fn flow_on(
        &mut self,
        now: &Conditions<'_>,
        timed: &Timed,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        let hold = now.hold;
        let rate = |scaling| if hold { Rate::HOLD } else { now.rate(scaling) };
        let step = self.run.flow(timed, now.stretch, now.single, rate);
        (self.taken, self.crossed) = (step.taken, step.crossed);
        self.moved(now, timed, hold, step.done, setpoint)
    }

    /// The tool has passed the end of a joined cut of the length `last`, and is in `next` now. Writes the setpoint of this
    /// tick. If `next` is no such cut, which cannot happen, the rest is given up.
    #[inline(never)]
    pub fn cross(&mut self, last: Length, next: Option<Task<'_>>, setpoint: &mut Setpoint) {
        self.crossed = false;
        let Some(Task { segment, .. }) = next else {
            return self.run.abandon();
        };
        let Action::Timed(timed) = &segment.action else {
            return self.run.abandon();
        };
        self.number = segment.number;
        self.span = segment.span;
        self.stops = segment.stops;
        self.run.cross(last, timed);
        self.position = self.run.position();
        setpoint.position = self.position;
        self.tell(setpoint, setpoint.motion);
    }
}
