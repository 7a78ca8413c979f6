//! SYNC: the beat on which every drive latches its setpoint and samples its position.

use super::frame::{CobId, Frame};

/// Produces SYNC with a counter that runs from 1 to 240 and around (object 1019h = 240).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncProducer {
    /// Counter of the last SYNC; 0 before the first.
    counter: u8,
}

impl SyncProducer {
    /// The highest counter value; 1 follows it.
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

/// True where `frame` is a SYNC, with or without a counter; also one that is longer
/// than it should be, for a drive may latch by whatever has this identifier.
#[must_use]
pub fn is_sync(frame: &Frame) -> bool {
    frame.id() == CobId::SYNC
}

/// Counts along with somebody else's SYNC.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncConsumer {
    /// Counter of the last SYNC.
    last: Option<u8>,
}

/// A SYNC that has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SyncBeat {
    /// Its counter, 1–240; `None` for a SYNC without one.
    pub counter: Option<u8>,
    /// How many are missing between the last one and this, up to 239. The same counter twice counts as 239 missing: to a
    /// consumer that is no other thing than a whole round.
    pub missed: u8,
}

impl SyncConsumer {
    /// One that has heard nothing: the first SYNC is never late.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: None }
    }

    /// Takes a frame; `None` where it is no SYNC.
    pub fn receive(&mut self, frame: &Frame) -> Option<SyncBeat> {
        if !is_sync(frame) {
            return None;
        }
        Some(self.count(frame.payload().first().copied()))
    }

    /// Takes the counter of a SYNC; `None` for one without. One that does not exist, 0 or above 240, is none: drives latch
    /// by that SYNC all the same.
    pub fn count(&mut self, counter: Option<u8>) -> SyncBeat {
        let counter = match counter {
            Some(1..=SyncProducer::LAST) => counter,
            _ => None,
        };
        let before = core::mem::replace(&mut self.last, counter);
        let missed = match (before, counter) {
            (Some(before), Some(counter)) if counter > before => {
                counter.saturating_sub(before).saturating_sub(1)
            }
            (Some(before), Some(counter)) => SyncProducer::LAST
                .saturating_sub(before)
                .saturating_add(counter)
                .saturating_sub(1),
            _ => 0,
        };
        SyncBeat { counter, missed }
    }
}

/// Who gives the beat to a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncSource {
    /// The board itself: it sends SYNC at every tick.
    Own,
    /// Another node: the board sends no SYNC, and ticks with the one that comes.
    Bus,
}

impl SyncSource {
    /// What the parameter says (9029): 0 its own, else the bus.
    #[must_use]
    pub const fn of(parameter: u8) -> Self {
        match parameter {
            0 => Self::Own,
            _ => Self::Bus,
        }
    }
}

/// What one period has brought of the SYNC that somebody else sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SyncHeard {
    /// SYNCs since the last tick.
    pub count: u8,
    /// How many are missing by their counters.
    pub missed: u8,
    /// The board's own beat keeps to theirs; of a board whose tick is the SYNC that comes, always.
    pub locked: bool,
}

impl SyncHeard {
    /// A period without any, and nothing else wrong.
    pub const NONE: Self = Self {
        count: 0,
        missed: 0,
        locked: true,
    };

    /// A period as it should be.
    pub const ONE: Self = Self {
        count: 1,
        ..Self::NONE
    };

    /// One more has come in this period.
    pub const fn note(&mut self, beat: SyncBeat) {
        self.count = self.count.saturating_add(1);
        self.missed = self.missed.saturating_add(beat.missed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_consumer_notices_what_is_missing() {
        let mut consumer = SyncConsumer::new();
        let mut hear = |payload: &[u8]| {
            let frame = Frame::new(CobId::SYNC, payload).unwrap();
            consumer.receive(&frame).map(|beat| beat.missed)
        };
        for (counter, missed) in [
            (17, 0),
            (18, 0),
            (20, 1),
            (240, 219),
            (1, 0),
            (3, 1),
            (2, 238),
            (2, 239),
        ] {
            assert_eq!(hear(&[counter]), Some(missed), "{counter}");
        }
        // With one that does not exist neither: it is a SYNC without.
        for counter in [0, 241, 255] {
            assert_eq!(hear(&[counter]), Some(0));
            assert_eq!(hear(&[3]), Some(0));
            let beat = SyncConsumer::new().count(Some(counter));
            assert_eq!((beat.counter, beat.missed), (None, 0));
        }
        assert_eq!(hear(&[5, 0]), Some(1));
        // Without a counter nothing can be noticed.
        assert_eq!(hear(&[]), Some(0));
        assert_eq!(hear(&[100]), Some(0));
        let mut producer = SyncProducer::new();
        let mut consumer = SyncConsumer::new();
        for _ in 0..500 {
            let beat = consumer.receive(&producer.next()).unwrap();
            assert_eq!(beat.missed, 0);
        }
        assert_eq!(consumer.receive(&Frame::of(CobId::NMT, [1])), None);
    }

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
