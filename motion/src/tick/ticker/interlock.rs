//! What follows from door, chuck and pressure: the truth table of `docs/functions.md`.
//!
//! Nothing here is a safety function. A door that is opened holds the program, leaves a thread at once and stops the
//! spindle; closing it starts nothing [D272]. Must not know which input means what.

use super::away::LastPass;
use super::{Ends, State, Ticker, emit};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{Aux, TapSpindle};
use crate::motion::{Action, Phase, Segment, ThreadRun};
use crate::operating::Interlock;
use crate::params::gear_of_code;
use crate::tick::Event;
use crate::tick::machine::interlocked;

/// Whether a segment may begin.
pub(super) enum Admitted {
    Yes,
    Waits,
    Refused(Interlock),
    /// By the gear or the tool that is in, or by that none is known; or it cannot be planned.
    Wrong(Alarm),
}

impl Ticker {
    /// Takes the inputs as the board sees them at this tick.
    #[inline]
    pub(in crate::tick) fn hear_machine(&mut self, told: Option<u16>) {
        self.machine.hear(told);
    }

    /// Something of the machine has changed, or the program waits for its spindle.
    #[cold]
    #[inline(never)]
    pub(super) fn heed_machine(&mut self, ends: &mut Ends<'_>) {
        let Some(change) = self.machine.takes_change() else {
            return self.await_spindle(ends);
        };
        // Before what follows from its inputs: it says why.
        if let Some(loss) = self.machine.takes_loss() {
            self.retreat(&loss.alarm(), ends);
        }
        if change.opened {
            self.open_door(ends);
        } else if change.released {
            self.jog.release();
        }
        if let Some(interlock) = self.machine.interlocks().of_clamping()
            && (self.spindle.is_ordered() || self.observer.is_turning())
        {
            let alarm = Alarm::of(Code::ClampingLost, &[Arg::Interlock(interlock)]);
            self.retreat(&alarm, ends);
        }
        if let Some((input, output)) = self.machine.lost() {
            let figures = [input, output].map(|contact| Arg::Int(contact.number().into()));
            self.retreat(&Alarm::of(Code::AnswerLost, &figures), ends);
        }
    }

    fn open_door(&mut self, ends: &mut Ends<'_>) {
        let alarm = interlocked(Interlock::Door, Span::default());
        self.resuming = None;
        match self.state {
            State::Homing => {
                emit(&mut ends.events, Event::Warning(alarm));
                self.transition_to_stopping_by_reset(ends);
            }
            State::ByHand => {
                self.jog.release();
                self.stay_away();
                self.stop_for_hand();
            }
            State::Idle if !self.course.in_program() => self.spindle.stop(),
            State::Held if self.has_left() => self.stop_for_hand(),
            State::Idle | State::Running | State::Held => {
                // A tap, and a stroke that nothing says a side of, cannot be left and taken up again.
                let stays = |pass: &LastPass| pass.ways.stays();
                let is_cutting = |run: &ThreadRun| run.phase() != Phase::Waiting;
                let stroke = self.executor.thread().is_some_and(is_cutting);
                let taps = self.executor.is_tapping() || self.executor.is_floating();
                // A spindle on its way to an angle has no speed that could be taken from it.
                if taps
                    || self.spindle.is_orienting()
                    || stroke && self.away.pass().is_some_and(stays)
                {
                    return self.retreat(&alarm, ends);
                }
                self.operator.hold = true;
                self.spindle.suspend();
                self.leave_stroke(ends);
            }
            State::Starting | State::Stopping(_) | State::Alarm(_) => {}
        }
    }

    /// The spindle stops where axes are moved by hand. For a program that was left it is told to turn again when that goes
    /// on.
    fn stop_for_hand(&mut self) {
        match self.has_left() {
            true => self.spindle.suspend(),
            false => self.spindle.stop(),
        }
    }

    /// Stops on an alarm, out of the thread if the tool is in one. The spindle turns until the tool is clear of it.
    fn retreat(&mut self, alarm: &Alarm, ends: &mut Ends<'_>) {
        match self.state {
            State::Idle | State::Running | State::Held | State::ByHand | State::Homing => {}
            State::Starting | State::Stopping(_) | State::Alarm(_) => return,
        }
        if self.executor.thread().is_none() && (self.has_left() || !self.in_thread()) {
            return self.raise(alarm, ends);
        }
        self.transition_to_stopping_out_of_thread(alarm, ends);
    }

    /// Whether a segment of the program may begin now.
    pub(super) fn admit(&mut self, segment: &Segment) -> Admitted {
        let refusal = match &segment.action {
            // What cannot be planned has moved nothing.
            Action::Alarm(alarm) => return Admitted::Wrong(*alarm),
            // The way out behind a stroke is made whatever holds.
            Action::Timed(_) | Action::Planned if segment.stops.hold_not_before => None,
            Action::Timed(_) | Action::Planned => {
                if self.needs_tool() {
                    return Admitted::Wrong(Alarm::new(Code::TurretBetween, segment.span));
                }
                if let Some(end) = self.hard_limits().first() {
                    let span = segment.span;
                    return Admitted::Wrong(Alarm {
                        span,
                        ..end.alarm()
                    });
                }
                self.refuses_motion()
            }
            Action::Aux(Aux::T(tool), _) => {
                let refused = self.refuses_tool(*tool, segment.span);
                return refused.map_or(Admitted::Yes, Admitted::Wrong);
            }
            Action::Spindle(rpm, law) if rpm.get() != 0 => {
                let speed = law.map_or(rpm.abs(), |law| law.most);
                if let Some(alarm) = self.refuses_by_gear(speed, segment.span) {
                    return Admitted::Wrong(alarm);
                }
                self.refuses_spindle()
            }
            Action::Rigid(TapSpindle::First) | Action::Orient(_) => {
                if let Some(alarm) = self.refuses_by_gear(0, segment.span) {
                    return Admitted::Wrong(alarm);
                }
                self.refuses_spindle()
            }
            Action::Rigid(_) => self.refuses_spindle(),
            Action::Aux(Aux::M(code), _) if *code != 0 && self.needs_a_stand(*code) => {
                let shifts = gear_of_code(*code).is_some();
                if shifts && self.spindle.holds_angle() {
                    return Admitted::Refused(Interlock::Spindle);
                }
                if shifts && self.spindle.is_leaving() {
                    return Admitted::Waits;
                }
                return self.open_chuck();
            }
            _ => None,
        };
        refusal.map_or(Admitted::Yes, Admitted::Refused)
    }

    /// What the program asks for next is not let in. A line that was typed, of which nothing has been done, is forgotten,
    /// and the machine stays ready [D492]. Anything else stops on an alarm.
    #[cold]
    #[inline(never)]
    pub(super) fn refuse(&mut self, alarm: &Alarm, ends: &mut Ends<'_>) {
        if !self.course.in_fresh_line() {
            return self.raise(alarm, ends);
        }
        self.give_up_function();
        self.transition_from_refused(alarm, &mut ends.events);
    }

    /// An M code that waits until the spindle has stood: it opens the chuck, or selects a gear.
    fn needs_a_stand(&self, code: u16) -> bool {
        let gear = gear_of_code(code).and_then(|number| self.given.gears.get(number));
        code == self.machine.chuck_open_code() || gear.is_some()
    }

    /// What keeps an axis from moving for a program.
    fn refuses_motion(&self) -> Option<Interlock> {
        let open = self.machine.interlocks().has_door();
        open.then_some(Interlock::Door)
    }

    /// What keeps the spindle from turning.
    pub(super) fn refuses_spindle(&self) -> Option<Interlock> {
        self.machine.interlocks().against_start()
    }

    /// Resumes. A spindle that was stopped turns first, and the axes wait until it is at its speed.
    pub(super) fn resume(&mut self, ends: &mut Ends<'_>) {
        let refusal = match self.spindle.is_ordered() {
            true => self.refuses_spindle(),
            false => self.refuses_motion(),
        };
        if let Some(interlock) = refusal {
            let alarm = interlocked(interlock, Span::default());
            return emit(&mut ends.events, Event::Warning(alarm));
        }
        if self.spindle.go_on(self.operator.spindle_percent()) {
            self.resuming = self.resuming.or(Some(0));
            return;
        }
        self.go_on_after_hold();
    }

    fn go_on_after_hold(&mut self) {
        self.resuming = None;
        self.operator.hold = false;
        self.course.resume();
        self.take_tool();
        self.go_back();
    }

    /// The spindle was stopped by the door, and the program goes on once it is at its speed again.
    fn await_spindle(&mut self, ends: &mut Ends<'_>) {
        let Some(ticks) = &mut self.resuming else {
            return;
        };
        *ticks = ticks.saturating_add(1);
        let late = *ticks > self.given.arrival.speed_ticks;
        let (wanted, measured) = (
            self.spindle.commanded().get(),
            self.observer.speed().rpm().get(),
        );
        let off = i64::from(wanted)
            .abs_diff(measured.into())
            .saturating_mul(100);
        let allowed = u64::from(wanted.unsigned_abs())
            .saturating_mul(self.given.arrival.tolerance_percent.into())
            .max(100);
        if off <= allowed {
            self.spindle.arrive();
            // Whoever leaves the program in this very tick does not want it to go on.
            if !self.operator.is_to_leave() {
                self.go_on_after_hold();
            }
        } else if late {
            let figures = [self.observer.speed().rpm(), self.spindle.commanded()].map(Arg::Rpm);
            self.raise(&Alarm::of(Code::SpindleNotArrived, &figures), ends);
        }
    }
}
