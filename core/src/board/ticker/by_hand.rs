//! Axes that are moved by hand.
//!
//! Says when a press may move the machine, and ends it where something else does. Must not know who presses.

use super::{State, Ticker};
use crate::motion::{JogConditions, Press};

impl Ticker {
    /// Takes a press, if the machine may be moved by hand now. The background has asked the same of an older state.
    pub(in crate::board) fn press(&mut self, press: &Press) {
        let stands = match self.state {
            State::Idle => !self.course.in_program() && self.executor.is_free(),
            State::ByHand => true,
            _ => false,
        };
        if !stands || self.operator.hold || self.journal.has_hole() {
            return self.jog.refuse(press.number);
        }
        self.jog
            .press(press, &self.given.travel_x, &self.given.travel_z);
        if self.jog.is_busy() {
            self.transition_to_by_hand();
        }
    }

    /// One tick of the axes that are moved by hand.
    #[cold]
    #[inline(never)]
    pub(super) fn move_by_hand(&mut self) {
        if self.operator.hold {
            self.jog.release();
        }
        let conditions = JogConditions {
            now: self.now,
            feed: self.operator.feed(),
            rapid: self.operator.rapid(),
        };
        let mut position = self.executor.position();
        let (x, z) = (&self.given.travel_x, &self.given.travel_z);
        self.jog.tick(&conditions, x, z, &mut position);
        self.executor.set_position(position);
    }
}
