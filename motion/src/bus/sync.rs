//! SYNC: the periodic frame on which every drive latches its setpoint and samples its position.

use super::frame::{CobId, Frame};

/// Produces SYNC with a counter that runs from 1 to 240 and starts again at 1 (object 1019h = 240).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncProducer {
    /// Counter of the last SYNC; 0 before the first.
    counter: u8,
}

impl SyncProducer {
    /// The highest counter value; 1 comes after it.
    pub const LAST: u8 = 240;

    /// A producer whose first SYNC carries 1.
    #[must_use]
    pub const fn new() -> Self {
        Self { counter: 0 }
    }

    /// The next SYNC.
    pub const fn next(&mut self) -> Frame {
        self.counter = match self.counter {
            Self::LAST => 1,
            counter => counter.saturating_add(1),
        };
        Frame::of(CobId::SYNC, [self.counter])
    }
}

/// True where `frame` is a SYNC, with or without a counter. A SYNC that is too long counts as well, because a drive may
/// latch on any frame with this identifier.
#[must_use]
pub fn is_sync(frame: &Frame) -> bool {
    frame.id() == CobId::SYNC
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_counter_runs_from_1_to_240_and_around() {
        let mut sync = SyncProducer::new();
        for round in 0..3 {
            for counter in 1..=240 {
                let frame = sync.next();
                assert_eq!(frame.id().get(), 0x080);
                assert_eq!(frame.payload(), [counter], "round {round}");
                assert!(is_sync(&frame));
            }
        }
        assert!(is_sync(&Frame::new(CobId::SYNC, &[1, 2]).unwrap()));
        assert!(is_sync(&Frame::new(CobId::SYNC, &[]).unwrap()));
    }
}
