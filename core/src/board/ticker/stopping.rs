//! Coming to rest: alarms, emergency stop and reset, and what has to be forgotten with them.

use super::super::detour::Detour;
use super::super::event::Event;
use super::super::queue::{EventIn, take};
use super::{Ends, Notice, Outcome, State, Ticker, emit};
use crate::alarm::Alarm;
use crate::motion::{Pass, Phase, Segment};
use crate::program::Position;
use crate::units::{Length, Rpm};

impl Ticker {
    /// An alarm: the axes come to rest on their path, and what is queued is forgotten. The first one stays.
    pub(super) fn raise(&mut self, alarm: Alarm, events: &mut EventIn<'_>) {
        if matches!(
            self.state,
            State::Alarm(_) | State::Stopping(Outcome::Alarm(_))
        ) {
            return;
        }
        self.executor.stop();
        self.detour = Detour::None;
        // A reset may have been on its way out of a thread: an alarm moves nothing any more.
        self.clear_at = None;
        self.commanded = Rpm::STOPPED;
        self.stay_rigid();
        self.state = State::Stopping(Outcome::Alarm(alarm));
        emit(events, Event::Alarm(alarm));
    }

    /// Reset: a stroke is left along the run-out's slope until the tool is clear of the crests or at the start level, and
    /// the way out behind a stroke goes on until then; anything else stops on its path. The spindle goes on turning until the axes stand.
    pub(super) fn reset_in_motion(&mut self) {
        self.operator.hold = false;
        self.paused = false;
        self.detour = Detour::None;
        self.clear_at = None;
        self.pauses_unless_hole = false;
        self.stay_rigid();
        self.state = State::Stopping(Outcome::Reset);
        let pass = self.pass.as_ref().and_then(Segment::pass);
        let Some(pass) = pass.filter(|_| self.in_thread()) else {
            self.executor.stop();
            return;
        };
        let (clear, target) = clear_of(pass, self.clearance);
        self.clear_at = Some(clear);
        self.executor.retract(target);
    }

    /// The tool is in the thread, or may be: in a stroke, behind it, or on its way out.
    pub(super) fn in_thread(&self) -> bool {
        let stops = self.executor.stops();
        match self.executor.thread() {
            Some(run) => run.phase() != Phase::Waiting,
            None if self.executor.is_free() => stops.frozen.is_some() && stops.hold_not_inside,
            None => stops.frozen.is_some() && stops.hold_not_before,
        }
    }

    /// Where the tool still has to go to be clear of the crests: on the short axis alone, away from the work.
    pub(super) fn not_clear(&self, clear: Position) -> Option<Position> {
        let pass = self.pass.as_ref()?.pass()?;
        let at = self.executor.position();
        let mut target = at;
        let (here, wanted, home) = if pass.plan.long_x() {
            target.z = clear.z;
            (at.z, clear.z, pass.home.z)
        } else {
            target.x = clear.x;
            (at.x, clear.x, pass.home.x)
        };
        // Only outwards.
        let way = wanted - here;
        (way != Length::ZERO && way.signum() == (home - here).signum()).then_some(target)
    }

    pub(super) fn finish_stop(&mut self, outcome: Outcome, events: &mut EventIn<'_>) {
        self.in_program = false;
        self.commanded = Rpm::STOPPED;
        self.state = match outcome {
            Outcome::Reset => {
                emit(events, Event::Reset);
                State::Idle
            }
            Outcome::Alarm(alarm) => State::Alarm(alarm),
        };
        self.restart(self.executor.position());
    }

    /// What is queued, and what the background still plans until it has heard of this, is dropped.
    pub(super) fn restart(&mut self, position: Position) {
        self.epoch = self.epoch.next();
        self.notice = Some(Notice::Restart(position, self.epoch));
    }

    /// Drops what was queued before the last start, one entry a tick.
    pub(super) fn drop_stale(&self, ends: &mut Ends<'_, '_>) {
        for (queue, epoch) in [
            (&mut *ends.segments, self.epoch),
            (&mut *ends.detours, self.route_epoch),
        ] {
            if queue.peek().is_some_and(|oldest| oldest.epoch != epoch) {
                take(queue);
            }
        }
    }
}

/// Where the short axis is clear of both crests of a pass, C's and D's, or at the start level: as a position, and on that
/// axis alone.
fn clear_of(pass: &Pass, clearance: Length) -> (Position, Length) {
    let long_x = pass.plan.long_x();
    let home = if long_x { pass.home.z } else { pass.home.x };
    let level = pass.plan.level_towards(home);
    let out = (pass.depth + clearance).min((home - level).abs());
    let target = level + out.times((home - level).signum());
    let mut clear = pass.home;
    if long_x {
        clear.z = target;
    } else {
        clear.x = target;
    }
    (clear, target)
}
