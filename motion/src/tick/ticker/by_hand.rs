//! Axes that are moved by hand, and a spindle that is turned so.
//!
//! Says when a press may move the machine, and ends it where something else does. Must not know who presses.

use super::{Ends, Outcome, State, Ticker, emit};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::motion::{AxisTravel, JogConditions, Press};
use crate::operating::{Interlock, PressState};
use crate::tick::Event;
use crate::tick::hard_limits::AxisEnd;
use crate::tick::machine::interlocked;
use crate::tick::queue::EventIn;
use crate::units::{Axis, Rpm};

impl Ticker {
    /// Takes a press, if the machine may be moved by hand now. The background has asked the same of an older state.
    pub(in crate::tick) fn press(&mut self, press: &Press, events: &mut EventIn<'_>) {
        if press.returns {
            return self.go_back_to_left(press);
        }
        if let Some(alarm) = self.refuses_by_hand(press) {
            let is_new = self.jog.last() != (press.number, PressState::Refused);
            // Its own event has told the alarm that stands.
            if is_new && self.state.alarm() != Some(&alarm) {
                emit(events, Event::Warning(alarm));
            }
            return self.jog.refuse(press.number, alarm.code);
        }
        self.note_way_out(press);
        let position = self.executor.position();
        let travel = self.off_limits(self.travel());
        self.free = self
            .jog
            .clear_of(&self.given.zones, press, position, travel);
        let [x, z] = &self.free;
        self.jog.press(press, x, z);
        self.turn_by_hand();
        if self.jog.is_busy() {
            self.transition_to_by_hand();
        }
    }

    /// Why the machine may not be moved by this press.
    fn refuses_by_hand(&self, press: &Press) -> Option<Alarm> {
        let turns = press.spindle != Rpm::STOPPED;
        let stands = match self.state {
            State::Idle => !self.course.in_program() && self.executor.is_free(),
            // The spindle is needed as it is when a program that was left goes on.
            State::Held | State::ByHand if turns && self.has_left() => false,
            State::ByHand => !self.is_coming_back(),
            State::Held => self.has_left(),
            State::Alarm(alarm) | State::Stopping(Outcome::Alarm(alarm)) => return Some(alarm),
            _ => false,
        };
        // The door may have been opened since the press was planned.
        let interlocks = self.machine.interlocks();
        let by = if interlocks.has_door() && !press.slow {
            Some(Interlock::Door)
        } else if self.operator.hold {
            Some(Interlock::Hold)
        } else {
            interlocks.against_hand()
        };
        match by {
            _ if !stands => Some(Alarm::of(Code::NotAtRest, &[])),
            Some(by) => Some(interlocked(by, Span::default())),
            None if self.journal.has_hole() => self.journal.hole_alarm(),
            None if turns => self.refuses_to_turn(press.spindle),
            None => self.refuses_towards(press).map(AxisEnd::alarm),
        }
    }

    /// Why the spindle may not be turned by hand at this speed: by what keeps M03, and by a drive that keeps its angle.
    fn refuses_to_turn(&self, rpm: Rpm) -> Option<Alarm> {
        if let Some(by) = self.refuses_spindle() {
            return Some(interlocked(by, Span::default()));
        }
        if self.spindle.holds() {
            return Some(Alarm::of(Code::SpindleHeld, &[]));
        }
        let (asked, most) = (rpm.abs(), self.given.most_rpm);
        if asked > most {
            let figures = [asked, most].map(|figure| Arg::Int(figure.into()));
            return Some(Alarm::of(Code::SpindleJogTooFast, &figures));
        }
        self.refuses_by_gear(asked, Span::default())
    }

    /// The spindle turns as the press that is alive says. It stops with that: what a program has commanded before does not
    /// come back [D525].
    pub(super) fn turn_by_hand(&mut self) {
        self.spindle.turn_by_hand(self.jog.turns());
    }

    /// How far X and Z may go. Where an axis without a reference is, nobody knows: it has no limits.
    pub(super) const fn travel(&self) -> [AxisTravel; 2] {
        let referenced = self.referenced();
        let x = match referenced.contains(Axis::X) {
            true => self.given.travel_x,
            false => AxisTravel::UNLIMITED,
        };
        let z = match referenced.contains(Axis::Z) {
            true => self.given.travel_z,
            false => AxisTravel::UNLIMITED,
        };
        [x, z]
    }

    /// One tick of the axes that are moved by hand.
    #[cold]
    #[inline(never)]
    pub(super) fn move_by_hand(&mut self, ends: &mut Ends<'_>) {
        if self.operator.hold {
            self.jog.release();
            self.stay_away();
        }
        let conditions = JogConditions {
            now: self.now,
            feed: self.operator.feed(),
            rapid: self.operator.rapid(),
        };
        let mut position = self.executor.position();
        let [x, z] = &self.free;
        if self.jog.tick(&conditions, x, z, &mut position) {
            let warning = Alarm::of(Code::WheelTooFast, &[]);
            emit(&mut ends.events, Event::Warning(warning));
        }
        self.executor.set_position(position);
    }
}
