//! The SYNC of another board, for one that follows: which there were on the wire, and what the board has heard of them.

use std::collections::VecDeque;

use leadscrew_can::Stamp;
use leadscrew_core::bus::{Frame, SyncConsumer, SyncHeard};

/// A SYNC on the wire.
struct Sync {
    time: Stamp,
    frame: Frame,
    /// As often as the board has heard it.
    heard: Vec<Frame>,
}

/// The beat of the bus.
#[derive(Default)]
pub struct Beat {
    /// Those that no tick has been made for.
    waiting: VecDeque<Sync>,
    /// Those of the coming tick, as they were on the wire, and as they were heard.
    syncs: Vec<Frame>,
    heard: Vec<Frame>,
    ear: SyncConsumer,
}

impl Beat {
    /// One is on the wire.
    pub fn comes(&mut self, time: Stamp, frame: Frame) {
        let heard = Vec::new();
        self.waiting.push_back(Sync { time, frame, heard });
    }

    /// The board hears one: that which came last, or a stray one.
    pub fn hear(&mut self, frame: Frame) {
        match self.waiting.back_mut() {
            Some(sync) => sync.heard.push(frame),
            None => self.heard.push(frame),
        }
    }

    /// The oldest that waits belongs to the coming tick; when it came.
    pub fn take(&mut self) -> Option<Stamp> {
        let sync = self.waiting.pop_front()?;
        self.syncs.push(sync.frame);
        self.heard.extend(sync.heard);
        Some(sync.time)
    }

    /// What the period has brought, now that it is over: what the board has heard, and what its drives have.
    pub fn end_period(&mut self) -> (SyncHeard, Vec<Frame>) {
        let mut heard = SyncHeard::NONE;
        for frame in self.heard.drain(..) {
            if let Some(beat) = self.ear.receive(&frame) {
                heard.note(beat);
            }
        }
        (heard, std::mem::take(&mut self.syncs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_core::bus::SyncProducer;

    #[test]
    fn every_tick_has_its_own() {
        let (mut beat, mut other) = (Beat::default(), SyncProducer::new());
        let period = |beat: &mut Beat, take: usize| {
            for _ in 0..take {
                beat.take().expect("one waits");
            }
            let (heard, syncs) = beat.end_period();
            (heard.count, heard.missed, syncs.len())
        };
        assert_eq!(beat.take(), None);
        // Heard once, not at all, twice.
        for times in [1, 0, 2] {
            let frame = other.next();
            beat.comes(Stamp::from_micros(7), frame);
            for _ in 0..times {
                beat.hear(frame);
            }
        }
        assert_eq!(period(&mut beat, 1), (1, 0, 1));
        assert_eq!(period(&mut beat, 1), (0, 0, 1));
        // The same counter again is a whole round missing.
        assert_eq!(period(&mut beat, 1), (2, 240, 1));
        assert_eq!(period(&mut beat, 0), (0, 0, 0));
        for _ in 0..2 {
            let frame = other.next();
            beat.comes(Stamp::from_micros(9), frame);
            beat.hear(frame);
        }
        assert_eq!(period(&mut beat, 2), (2, 0, 2));
        beat.hear(other.next());
        assert_eq!(period(&mut beat, 0), (1, 0, 0));
    }
}
