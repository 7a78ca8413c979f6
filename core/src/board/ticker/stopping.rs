//! Coming to rest: alarms, emergency stop and reset, and what has to be forgotten with them.

use super::super::detour::Detour;
use super::super::event::{Event, Switching};
use super::super::queue::{EventIn, take};
use super::{Ends, Mode, Notice, Then, Ticker, emit};
use crate::alarm::Alarm;
use crate::motion::Phase;
use crate::program::Position;
use crate::units::{Length, Rpm};

impl Ticker {
    /// An alarm: the axes come to rest on their path, and what is queued is forgotten. The first one stays.
    #[cold]
    #[inline(never)]
    pub(super) fn raise(&mut self, alarm: &Alarm, ends: &mut Ends<'_, '_>) {
        if self.has_alarm() {
            return;
        }
        self.executor.stop(ends.current(self.source));
        self.detour = Detour::None;
        // A reset may have been on its way out of a thread: an alarm moves nothing any more.
        self.clearing = false;
        self.commanded = Rpm::STOPPED;
        self.stay_rigid();
        self.mode = Mode::Stopping(Then::Alarm);
        self.alarm = *alarm;
        emit(ends.events, Event::Alarm(*alarm));
    }

    /// A reset acts as soon as the machine is not on its way to rest with an alarm [D110].
    pub(super) fn reset(&mut self, ends: &Ends<'_, '_>) {
        match self.mode {
            Mode::Stopping(Then::Alarm) => return,
            Mode::Alarm if self.stays_at_rest() => {}
            Mode::Alarm => {
                self.drives.reset();
                self.paused = false;
                // To the nanometre, where the drives have not been moved meanwhile.
                self.remembered = self.remembered.or(Some(self.executor.position()));
                self.mode = Mode::Starting;
                self.is_up = false;
                self.switching = self.switching_of_reset();
            }
            Mode::Idle | Mode::Running | Mode::Held => self.reset_in_motion(ends),
            // What it asks for is under way.
            Mode::Starting | Mode::Stopping(Then::Reset) => {}
        }
        self.operator.reset_acts();
    }

    /// What a reset has for the board's switches.
    const fn switching_of_reset(&self) -> Switching {
        if self.has_tap_in_hole() {
            Switching::ResetInHole
        } else {
            Switching::Reset
        }
    }

    /// A stroke is left along the run-out's slope until the tool is clear of the crests or at the start level, and
    /// the way out behind a stroke goes on until then; anything else stops on its
    /// path. The spindle goes on turning until the axes stand.
    fn reset_in_motion(&mut self, ends: &Ends<'_, '_>) {
        self.paused = false;
        self.detour = Detour::None;
        self.clearing = false;
        self.pauses_unless_hole = false;
        self.stay_rigid();
        self.mode = Mode::Stopping(Then::Reset);
        let current = ends.current(self.source);
        match &self.pass {
            Some(pass) if self.in_thread() => {
                self.clearing = true;
                self.executor.retract(current, pass.ways.clear);
            }
            _ => self.executor.stop(current),
        }
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
    pub(super) fn not_clear(&self) -> Option<Position> {
        let ways = &self.pass.as_ref()?.ways;
        let mut target = self.executor.position();
        let here = ways.short_of(target);
        ways.set_short(&mut target, ways.clear);
        // Only outwards.
        let way = ways.clear - here;
        let outwards = ways.short_of(ways.home) - here;
        (way != Length::ZERO && way.signum() == outwards.signum()).then_some(target)
    }

    /// What is wrong with the bus is an alarm; drives that nothing reaches any more are let go.
    #[inline(never)]
    pub(super) fn suffer(&mut self, ends: &mut Ends<'_, '_>) {
        let Some(trouble) = self.operator.takes_trouble() else {
            return;
        };
        if self.operator.takes_cut_off() {
            self.drives.cut_off();
        }
        self.raise(&trouble.alarm(), ends);
    }

    pub(super) fn finish_stop(&mut self, then: Then, events: &mut EventIn<'_>) {
        self.note_stop();
        self.in_program = false;
        self.commanded = Rpm::STOPPED;
        self.stood = 0;
        self.mode = match then {
            Then::Reset => {
                self.switching = self.switching_of_reset();
                emit(events, Event::Reset);
                Mode::Idle
            }
            Then::Alarm => Mode::Alarm,
        };
        self.restart(self.executor.position());
    }

    /// What is queued, and what the background still plans until it has heard of this, is dropped.
    pub(super) fn restart(&mut self, position: Position) {
        self.epoch = self.epoch.next();
        self.waited = 0;
        self.notice = Some(Notice::Restart(position, self.epoch));
    }

    /// Drops what was queued before the last start, one entry a tick.
    pub(super) fn drop_stale(&self, ends: &mut Ends<'_, '_>) {
        let segment = ends.segments.head().map(|oldest| oldest.epoch);
        if segment.is_some_and(|epoch| epoch != self.epoch) {
            ends.segments.take();
        }
        let leg = ends.detours.peek().map(|oldest| oldest.epoch);
        if leg.is_some_and(|epoch| epoch != self.route_epoch) {
            take(ends.detours);
        }
    }
}
