//! The alarm of a machine as the person at it must see it: one at a time, the first cause, until a reset.
//!
//! A reset that was carried out ends an alarm in any case. A fault that is still present, or shows only now, is the next
//! alarm and counts as the first [D181]. The same holds for a reset of the node.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Outcome, State};

/// The alarm on which a machine stands or stops.
#[derive(Debug, Default)]
pub struct Latch {
    /// The alarm and its tick.
    alarm: Option<(Alarm, u64)>,
    /// The last tick in which a reset was on its way to the board.
    asked: Option<u64>,
}

impl Latch {
    /// A reset of the machine or of the node is on its way in this tick.
    pub fn asks(&mut self, now: u64) {
        self.asked = Some(now);
    }

    /// The board has reported an alarm.
    pub fn raise(&mut self, alarm: &Alarm, now: u64) {
        assert_eq!(
            self.alarm, None,
            "a second alarm without a reset: {alarm:?}"
        );
        self.alarm = Some((*alarm, now));
    }

    /// Takes the state of the machine after all reports of the board.
    pub fn look(&mut self, state: &State) {
        if let State::Alarm(shown) | State::Stopping(Outcome::Alarm(shown)) = state {
            let first = self.alarm.map(|(alarm, _)| alarm);
            assert_eq!(Some(*shown), first, "the alarm that came is not shown");
        } else if let Some((alarm, since)) = self.alarm.take() {
            // A reset that was on its way when the alarm came clears it as well [D110].
            let asked = self.asked.is_some_and(|asked| asked + 1 >= since);
            assert!(asked, "an alarm is gone without a reset: {alarm:?}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_core::alarm::{Code, Span};

    fn alarm(code: Code) -> Alarm {
        Alarm::new(code, Span::default())
    }

    #[test]
    fn what_a_reset_finds_is_the_next_alarm() {
        let mut latch = Latch::default();
        let (fault, stays) = (alarm(Code::DriveFault), alarm(Code::DriveFaultNotReset));
        latch.raise(&fault, 10);
        latch.look(&State::Stopping(Outcome::Alarm(fault)));
        latch.look(&State::Alarm(fault));
        latch.asks(30);
        latch.look(&State::Alarm(fault));
        latch.look(&State::Starting);
        // The drives have not come up between the two.
        latch.raise(&stays, 531);
        latch.look(&State::Alarm(stays));
        latch.asks(600);
        latch.look(&State::Starting);
        latch.look(&State::Idle);
    }

    #[test]
    fn a_node_that_is_reset_stops_and_begins_anew_in_one_tick() {
        let mut latch = Latch::default();
        latch.asks(10);
        latch.raise(&alarm(Code::NetworkStop), 10);
        latch.look(&State::Starting);
        let mute = alarm(Code::DriveNoAnswer);
        latch.raise(&mute, 512);
        latch.look(&State::Alarm(mute));
    }

    #[test]
    #[should_panic(expected = "a second alarm without a reset")]
    fn no_alarm_comes_over_another() {
        let mut latch = Latch::default();
        latch.raise(&alarm(Code::DriveFault), 10);
        latch.look(&State::Alarm(alarm(Code::DriveFault)));
        latch.raise(&alarm(Code::DriveSilent), 20);
    }

    #[test]
    #[should_panic(expected = "the alarm that came is not shown")]
    fn the_first_cause_stays_visible() {
        let mut latch = Latch::default();
        latch.raise(&alarm(Code::DriveFault), 10);
        latch.look(&State::Alarm(alarm(Code::DriveSilent)));
    }

    #[test]
    #[should_panic(expected = "the alarm that came is not shown")]
    fn no_alarm_stands_that_was_not_told() {
        Latch::default().look(&State::Alarm(alarm(Code::DriveFault)));
    }

    #[test]
    #[should_panic(expected = "an alarm is gone without a reset")]
    fn nothing_else_ends_one() {
        let mut latch = Latch::default();
        // A reset for another alarm, long ago.
        latch.asks(8);
        latch.raise(&alarm(Code::DriveFault), 10);
        latch.look(&State::Idle);
    }
}
