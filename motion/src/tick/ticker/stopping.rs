//! Coming to rest: alarms, emergency stop and reset.

use super::{Ends, Outcome, State, Ticker};
use crate::alarm::Alarm;
use crate::call::Position;
use crate::motion::Phase;

impl Ticker {
    /// An alarm. The first one stays.
    #[cold]
    #[inline(never)]
    pub(super) fn raise(&mut self, alarm: &Alarm, ends: &mut Ends<'_>) {
        if self.state.alarm().is_none() {
            self.transition_to_stopping_on_alarm(alarm, ends);
        }
    }

    /// A reset acts as soon as the machine is not on its way to rest with an alarm [D110].
    pub(super) fn reset(&mut self, ends: &Ends<'_>) {
        match self.state {
            State::Stopping(Outcome::Alarm(_)) => return,
            State::Alarm(_) if self.state.stays_at_rest() => {}
            State::Alarm(_) => self.transition_to_starting(),
            State::Idle | State::Running | State::Held | State::ByHand | State::Homing => {
                self.transition_to_stopping_by_reset(ends);
            }
            // What the reset asks for is under way.
            State::Starting | State::Stopping(Outcome::Reset) => {}
        }
        self.operator.reset_acts();
    }

    /// The tool is in the thread, or may be: in a stroke, after it, or on its way out.
    pub(super) fn in_thread(&self) -> bool {
        let stops = self.executor.stops();
        match self.executor.thread() {
            Some(run) => run.phase() != Phase::Waiting,
            None if self.executor.is_free() => stops.frozen.is_some() && stops.hold_not_inside,
            None => stops.frozen.is_some() && stops.hold_not_before,
        }
    }

    /// Where the tool still has to go to be clear of the crests: on the short axis alone, away from the work.
    pub(super) fn not_clear(&self) -> Option<Position> {
        let ways = &self.away.pass()?.ways;
        let mut target = self.executor.position();
        let here = ways.short_of(target);
        ways.set_short(&mut target, ways.clear);
        // Only outwards.
        let way = (ways.clear - here).signum();
        (way != 0 && way == ways.side).then_some(target)
    }

    /// What is wrong with the bus is an alarm; drives that nothing reaches any more are let go.
    #[inline(never)]
    pub(super) fn suffer(&mut self, ends: &mut Ends<'_>) {
        let Some(trouble) = self.operator.takes_trouble() else {
            return;
        };
        if self.operator.takes_cut_off() {
            self.drives.cut_off();
        }
        self.raise(&trouble.alarm(), ends);
    }
}
