//! Begins segments, and changes the state after a motion has come to rest.

use super::away::LastPass;
use super::course::Source;
use super::interlock::Admitted;
use super::{Detour, Ends, State, Ticker, emit};
use crate::alarm::{Alarm, Code};
use crate::call::Aux;
use crate::motion::{Action, Motion, Scaling};
use crate::tick::Event;
use crate::tick::command::Switching;
use crate::tick::machine::interlocked;

impl Ticker {
    /// Begins the next segment if it may begin now. Returns number and line of a segment that is over at once, or that
    /// waits for the spindle.
    pub(super) fn take_up(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        if !self.executor.is_free() {
            return None;
        }
        if self.function.is_some()
            && let Some(waits) = self.await_function(ends)
        {
            return Some(waits);
        }
        if self.spindle.is_entering() {
            return self.enter_rigid(ends);
        }
        if self.away.is_under_way() {
            if !self.has_left() {
                self.go_on_with_detour(ends);
            }
            return None;
        }
        if self.course.is_paused() || self.has_left() || !self.state.takes_calls() {
            return None;
        }
        let stops = self.course.next(ends)?.stops;
        if self.handwheel.is_on() && self.asks_for_start(ends) {
            return None;
        }
        if self.course.pauses_before(stops, self.operator.single_block)
            || self.operator.hold && !stops.hold_not_before
        {
            return None;
        }
        self.transition_to_running();
        self.course.begin_program(false);
        if self.given.waits_for_rgtap && self.spindle.is_rigid() {
            let wait = self.wait_for_release(ends);
            if wait.is_some() {
                return wait;
            }
        }
        if self.awaits {
            let next = ends.segments.head()?;
            return Some((next.number, next.span.line, Motion::Wait));
        }
        if self.spindle.is_rigid()
            && let Some(waits) = self.wait_for_journal(ends)
        {
            return Some(waits);
        }
        self.start(ends)
    }

    /// Begins the segment at the head of the program's queue.
    pub(super) fn start(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let task = ends.segments.peek()?;
        let segment = task.segment;
        let (number, line, stops) = (segment.number, segment.span.line, segment.stops);
        let refusal = match self.admit(segment) {
            Admitted::Yes => None,
            Admitted::Waits => return Some((number, line, Motion::Wait)),
            Admitted::Refused(by) => Some(interlocked(by, segment.span)),
            Admitted::Wrong(alarm) => Some(alarm),
        };
        if let Some(alarm) = refusal {
            ends.segments.take();
            self.refuse(&alarm, ends);
            return None;
        }
        self.course.do_something();
        let events = &mut ends.events;
        let instant = match segment.action {
            Action::Planned
                if let Some(tap) = task.tap()
                    && !self.spindle.is_rigid() =>
            {
                if tap.part.returns {
                    self.ask_for_rigid(tap.hole.spindle, number, line);
                    return Some((number, line, Motion::Wait));
                }
                // Only a way out may enter rigid mode by itself. For any other tap the program has to command it first.
                let alarm = Alarm::new(Code::TapModePlace, segment.span);
                ends.segments.take();
                self.raise(&alarm, ends);
                return None;
            }
            Action::Planned
                if let Some(tap) = task.tap()
                    && tap.hole.spindle != self.spindle.taps_with() =>
            {
                // The E word names another spindle. The change happens at standstill, and the hole begins after it.
                let spindle = tap.hole.spindle;
                self.enter_with(spindle, number, line);
                return Some((number, line, Motion::Wait));
            }
            Action::Timed(_) | Action::Planned | Action::Dwell(_) => {
                if let Some(pass) = task.pass() {
                    self.away.begin_pass(LastPass::of(segment, pass));
                }
                if let Some(tap) = task.tap() {
                    self.tap_begins(tap);
                }
                // A rapid cuts nothing: the spindle goes to the speed of the rapid's end at once.
                let rapid = task.timed().filter(|timed| timed.scaling == Scaling::Rapid);
                self.spindle.aim(rapid.map(|timed| timed.end().x));
                emit(events, Event::Started { number, line });
                self.executor.begin(task);
                // The segment stays in its queue until it is done.
                self.course.take_from(Source::Program);
                return None;
            }
            Action::Spindle(rpm, law) => {
                self.spindle.turn(rpm, law);
                Event::Spindle(rpm)
            }
            Action::Rigid(spindle) => {
                self.ask_for_rigid(spindle, number, line);
                Event::Rigid
            }
            Action::Orient(_) => return self.orient(ends),
            Action::TapOut => {
                self.tap_is_out();
                ends.segments.take();
                self.executor.tell_stops(stops);
                emit(&mut ends.events, Event::Started { number, line });
                return Some((number, line, Motion::Run));
            }
            Action::Aux(aux, row) => {
                self.switching = Switching::Function(aux);
                // M00, and M01 where it is wanted: the program stops behind it, until it is resumed [D494].
                if let Aux::M(0 | 1) = aux {
                    self.course.pause();
                }
                if let Some(row) = row {
                    self.begin_function(&row, number, segment.span);
                } else {
                    match aux {
                        Aux::M(code) => self.shift(code, true),
                        Aux::T(tool) => self.begin_tool(tool, number, segment.span, ends),
                    }
                }
                Event::Aux(aux)
            }
            // Not admitted.
            Action::Alarm(_) => return None,
            Action::End | Action::LineEnd => {
                if matches!(segment.action, Action::End) {
                    self.spindle.stop();
                }
                self.transition_to_idle(events);
                ends.segments.take();
                return None;
            }
        };
        ends.segments.take();
        self.executor.tell_stops(stops);
        emit(&mut ends.events, Event::Started { number, line });
        emit(&mut ends.events, instant);
        self.course.pause_after(stops, self.operator.single_block);
        Some((number, line, Motion::Run))
    }

    /// Changes the state after a motion has come to rest. `moved`: a segment was under way in this tick.
    pub(super) fn settle(&mut self, motion: Motion, moved: bool, ends: &mut Ends<'_>) {
        match self.state {
            State::Stopping(_) => {
                if !self.executor.is_free() || self.away.is_under_way() || self.jog.moves() {
                    return;
                }
                if self.is_homing() && self.leaves_homing(ends) {
                    return;
                }
                if self.away.takes_clearing()
                    && let Some(target) = self.not_clear()
                {
                    self.route(Detour::Clearing, [Some(target), None]);
                    return;
                }
                self.transition_from_stopping(&mut ends.events);
            }
            State::Running | State::Held => {
                let free = self.executor.is_free();
                if moved && free {
                    let stops = self.executor.stops();
                    self.course.pause_after(stops, self.operator.single_block);
                }
                let between = free
                    && match self.away.stage() {
                        Detour::None => {
                            (self.course.is_paused() || self.operator.hold)
                                && !self.course.must_go_on(ends)
                                // The stages of the way are one: the program is held behind it [D529].
                                && !self.spindle.is_orienting()
                        }
                        Detour::AtHome => true,
                        _ => false,
                    };
                let resting = motion == Motion::Hold || between;
                if !resting {
                    self.transition_to_running();
                } else if matches!(self.state, State::Running) {
                    self.transition_to_held(&mut ends.events);
                }
            }
            // The program is held before its first block.
            State::Idle => {
                if self.operator.hold
                    && self.course.next(ends).is_some()
                    && !self.course.must_go_on(ends)
                {
                    self.transition_to_held(&mut ends.events);
                }
            }
            State::ByHand => {
                self.turn_by_hand();
                if !self.jog.is_busy() && !self.begin_leg() {
                    self.transition_from_by_hand();
                }
            }
            State::Alarm(_) => self.stood = self.stood.saturating_add(1),
            State::Starting | State::Homing => {}
        }
    }
}
