//! Which frame goes into the CAN controller next.
//!
//! A controller has few places for frames (three here). It sends the smallest identifier first; of equal identifiers,
//! the order is not defined. So:
//!
//! - the tick's frames come first, in their order; one place is kept free for the next SYNC;
//! - of all other frames (statuses, answers, transfers) only one is in the controller at a time, and none beside a frame of
//!   the tick. Otherwise segments of a transfer could overtake each other, and a status the setpoints;
//! - shortly before a SYNC no other frame is begun: a frame on the wire cannot be stopped, and SYNC would wait for its end.

/// Microseconds of the longest frame at 1 Mbit/s: 8 bytes, worst stuffing, and the gap after it.
const LONGEST_FRAME_US: u32 = 135;

/// Who may put in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// The oldest of the tick's frames may go.
    Tick,
    /// The oldest of the other frames may go.
    Other,
    /// No frame may go now.
    Nothing,
}

/// The rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gate {
    tick_us: u32,
    /// From this time on in a period only frames of the tick are begun.
    closes_us: u32,
}

impl Gate {
    /// The gate for a period of `tick_us` microseconds at `kbit` kilobits a second. At any bit
    /// rate half of the period stays open for other frames.
    #[must_use]
    pub const fn new(tick_us: u32, kbit: u32) -> Self {
        let frame = match (LONGEST_FRAME_US * 1000).checked_div(kbit) {
            Some(frame) => frame,
            None => u32::MAX,
        };
        let closes = tick_us.saturating_sub(frame);
        let half = tick_us / 2;
        Self {
            tick_us,
            closes_us: if closes > half { closes } else { half },
        }
    }

    /// Decides whose turn it is. `free`: free places in the controller; `waiting`: frames of the tick and other frames
    /// wait; `other`: one of the other frames is in the controller; `at_us`: microseconds since the period began.
    #[must_use]
    pub const fn turn(&self, free: u8, waiting: (bool, bool), other: bool, at_us: u32) -> Turn {
        if free < 2 {
            return Turn::Nothing;
        }
        match waiting {
            (true, _) => Turn::Tick,
            (false, true) if !other && at_us < self.closes_us => Turn::Other,
            _ => Turn::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::collections::VecDeque;
    use std::vec::Vec;

    use super::*;

    #[test]
    fn the_others_wait_for_the_tick_and_one_place_stays_free() {
        let gate = Gate::new(1000, 1000);
        assert_eq!(gate.turn(3, (true, true), false, 0), Turn::Tick);
        assert_eq!(gate.turn(2, (true, true), false, 0), Turn::Tick);
        assert_eq!(gate.turn(1, (true, true), false, 0), Turn::Nothing);
        assert_eq!(gate.turn(3, (false, true), false, 0), Turn::Other);
        assert_eq!(gate.turn(2, (false, true), true, 0), Turn::Nothing);
        assert_eq!(gate.turn(3, (false, false), false, 0), Turn::Nothing);
    }

    #[test]
    fn nothing_else_begins_shortly_before_sync() {
        let gate = Gate::new(1000, 1000);
        assert_eq!(gate.turn(3, (false, true), false, 864), Turn::Other);
        assert_eq!(gate.turn(3, (false, true), false, 865), Turn::Nothing);
        // The tick's frames are late already: they may go at any time.
        assert_eq!(gate.turn(3, (true, true), false, 999), Turn::Tick);
        // On a slow bus half of the period stays open.
        let slow = Gate::new(1000, 125);
        assert_eq!(slow.turn(3, (false, true), false, 499), Turn::Other);
        assert_eq!(slow.turn(3, (false, true), false, 500), Turn::Nothing);
    }

    /// A model of the controller: sends the smallest identifier, and any one of equal identifiers.
    #[derive(Default)]
    struct Controller {
        places: Vec<(u16, u32)>,
    }

    impl Controller {
        fn send(&mut self) -> Option<(u16, u32)> {
            let smallest = self.places.iter().map(|(id, _)| *id).min()?;
            // The worst case: the newest of equal identifiers.
            let at = self.places.iter().rposition(|(id, _)| *id == smallest)?;
            Some(self.places.remove(at))
        }
    }

    #[test]
    fn a_transfer_keeps_its_order_and_setpoints_go_first() {
        let gate = Gate::new(1000, 1000);
        let mut controller = Controller::default();
        let mut other: VecDeque<(u16, u32)> = (0..40).map(|n| (0x581, n)).collect();
        let mut sent = Vec::new();
        for period in 0..10_u32 {
            controller.places.push((0x080, period));
            let mut tick: VecDeque<(u16, u32)> =
                [0x210, 0x211, 0x212, 0x320].map(|id| (id, period)).into();
            // Seven frames fit into a period.
            for slot in 0..7_u32 {
                loop {
                    let free = 3 - u8::try_from(controller.places.len()).unwrap();
                    let in_there = controller.places.iter().any(|(id, _)| *id == 0x581);
                    let waiting = (!tick.is_empty(), !other.is_empty());
                    let next = match gate.turn(free, waiting, in_there, slot * 130) {
                        Turn::Tick => tick.pop_front(),
                        Turn::Other => other.pop_front(),
                        Turn::Nothing => break,
                    };
                    controller.places.push(next.unwrap());
                }
                sent.extend(controller.send());
            }
            assert!(tick.is_empty());
        }
        for frames in sent.chunks(7) {
            let ids: Vec<u16> = frames.iter().map(|(id, _)| *id).collect();
            assert_eq!(ids[..5], [0x080, 0x210, 0x211, 0x212, 0x320]);
        }
        let transfer: Vec<u32> = sent
            .iter()
            .filter_map(|(id, n)| (*id == 0x581).then_some(*n))
            .collect();
        assert!(transfer.len() > 10);
        assert!(transfer.is_sorted(), "{transfer:?}");
    }
}
