//! The event log: the last events with their numbers. Object 5040h.

use super::ring::Ring;
use crate::link::Event;
use crate::link::encode_event;

/// Bytes of events kept.
const LOG_BYTES: usize = 1024;

/// The longest event: an alarm with four figures.
const ENTRY_BYTES: usize = 128;

/// The event log.
#[derive(Debug)]
pub struct Log {
    /// Entries in the ring.
    count: u32,
    /// Number of the newest.
    newest: u32,
    /// Each entry follows its length, which takes one byte.
    ring: Ring<LOG_BYTES>,
}

impl Log {
    pub const fn new() -> Self {
        Self {
            ring: Ring::new(),
            count: 0,
            newest: 0,
        }
    }

    pub const fn newest(&self) -> u32 {
        self.newest
    }

    /// Adds an event. The oldest events are dropped where there is no room.
    pub fn push(&mut self, tick: u64, event: &Event) {
        self.newest = self.newest.saturating_add(1);
        let mut bytes = [0; ENTRY_BYTES];
        let Ok(length) = encode_event(self.newest, tick, event, &mut bytes) else {
            return;
        };
        while self.ring.free() <= length {
            self.drop_oldest();
        }
        // There is room now.
        self.ring.push(&[length as u8]);
        self.ring.push(bytes.get(..length).unwrap_or(&[]));
        self.count = self.count.saturating_add(1);
    }

    fn drop_oldest(&mut self) {
        self.ring.drop_front(self.length(0).saturating_add(1));
        self.count = self.count.saturating_sub(1);
    }

    /// Length of the entry that begins `ahead` bytes after the oldest byte.
    fn length(&self, ahead: usize) -> usize {
        let mut length = [0];
        self.ring.copy(ahead, &mut length);
        let [length] = length;
        usize::from(length)
    }

    /// Copies whole entries, from number `from` or from the oldest entry, as many as fit. Returns the number of bytes.
    pub fn read(&self, from: u32, into: &mut [u8]) -> usize {
        let mut number = self.newest.saturating_sub(self.count).saturating_add(1);
        let (mut ahead, mut used) = (0_usize, 0_usize);
        for _ in 0..self.count {
            let length = self.length(ahead);
            ahead = ahead.saturating_add(1);
            if number >= from {
                let end = used.saturating_add(length);
                let Some(place) = into.get_mut(used..end) else {
                    break;
                };
                used = used.saturating_add(self.ring.copy(ahead, place));
            }
            ahead = ahead.saturating_add(length);
            number = number.saturating_add(1);
        }
        used
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::alarm::{Alarm, Arg, Code, Span};
    use crate::link::{EventReader, Logged};
    use crate::units::Length;

    fn read(log: &Log, from: u32, room: usize) -> Vec<Logged> {
        let mut bytes = [0; 600];
        let used = log.read(from, &mut bytes[..room]);
        EventReader::new(&bytes[..used])
            .map(Result::unwrap)
            .collect()
    }

    #[test]
    fn the_newest_are_kept_whole_and_read_from_any_number() {
        let mut log = Log::new();
        assert_eq!(read(&log, 0, 600), []);
        for number in 1..=500 {
            log.push(
                u64::from(number) * 3,
                &Event::Started {
                    number,
                    line: number,
                },
            );
        }
        assert_eq!(log.newest(), 500);
        let all = read(&log, 0, 600);
        let oldest = all[0].number;
        assert!((350..450).contains(&oldest), "{oldest}");
        for (number, entry) in (oldest..).zip(&all) {
            assert_eq!((entry.number, entry.tick), (number, u64::from(number) * 3));
        }
        // Page by page.
        let mut from = oldest;
        while from <= 500 {
            let page = read(&log, from, 100);
            assert_eq!(page[0].number, from);
            from += page.len() as u32;
        }
        assert_eq!(read(&log, 501, 600), []);
    }

    #[test]
    fn the_longest_event_fits() {
        let span = Span {
            line: u32::MAX,
            column: u16::MAX,
            end: u16::MAX,
        };
        let alarm = Alarm::new(Code::FollowingError, span)
            .word(b'X')
            .with([Arg::Decimal(i64::MIN, u8::MAX); 4]);
        let mut log = Log::new();
        for _ in 0..100 {
            log.push(u64::MAX, &Event::Alarm(alarm));
        }
        assert_eq!(read(&log, 100, 600)[0].event, Event::Alarm(alarm));
        let small = Arg::Length(Length::ZERO);
        log.push(0, &Event::Alarm(alarm.with([small; 4])));
        assert_eq!(log.newest(), 101);
        assert_eq!(read(&log, 101, 600).len(), 1);
    }
}
