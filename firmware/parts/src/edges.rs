//! Makes a sample from the timers of an encoder.
//!
//! One timer counts the edges, all four of a line. A second timer runs freely on a fast clock, and the hardware
//! captures its value at each edge. A third register holds the count at the index pulse.

use leadscrew_core::spindle::EncoderSample;

/// The registers at the instant of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// The counter of edges, 32 bits, wrapping.
    pub count: u32,
    /// The free-running clock now, wrapping.
    pub now: u32,
    /// The clock at the last edge, if there was one since the last reading.
    pub edge: Option<u32>,
    /// The counter at the index pulse, if there was one since the last reading.
    pub index: Option<u32>,
}

/// Keeps the age of the last edge, even after the clock has wrapped.
#[derive(Clone, Copy, Debug)]
pub struct EdgeClock {
    /// Periods of the clock in a microsecond.
    mhz: u32,
    last: u32,
    /// Clock periods since the last edge; `None` before the first.
    age: Option<u32>,
}

impl EdgeClock {
    /// For a clock of `mhz` megahertz (above zero) that now shows `now`.
    #[must_use]
    pub const fn new(mhz: u32, now: u32) -> Self {
        Self {
            mhz,
            last: now,
            age: None,
        }
    }

    /// Makes a sample from a reading. Needs at least one call in each turn of the clock.
    pub fn sample(&mut self, reading: &Reading) -> EncoderSample {
        let passed = reading.now.wrapping_sub(self.last);
        self.last = reading.now;
        self.age = match reading.edge {
            Some(edge) => Some(reading.now.wrapping_sub(edge)),
            None => self.age.map(|age| age.saturating_add(passed)),
        };
        EncoderSample {
            count: reading.count.cast_signed(),
            edge_age_ns: self.age.map(|age| self.nanoseconds(age)),
            index: reading.index.map(u32::cast_signed),
        }
    }

    fn nanoseconds(&self, clocks: u32) -> u32 {
        let scaled = u64::from(clocks) * 1000;
        let ns = scaled.checked_div(self.mhz.into()).unwrap_or(u64::MAX);
        u32::try_from(ns).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MHZ: u32 = 170;

    fn reading(count: u32, now: u32, edge: Option<u32>) -> Reading {
        Reading {
            count,
            now,
            edge,
            index: None,
        }
    }

    #[test]
    fn the_age_is_the_time_since_the_capture_to_a_clock() {
        let mut edges = EdgeClock::new(MHZ, 0);
        let sample = edges.sample(&reading(7, 17_000, Some(17_000 - 170)));
        assert_eq!((sample.count, sample.edge_age_ns), (7, Some(1000)));
        // 3 clocks of 170 MHz are 17.6 ns.
        let sample = edges.sample(&reading(8, 34_000, Some(33_997)));
        assert_eq!(sample.edge_age_ns, Some(17));
    }

    #[test]
    fn before_the_first_edge_there_is_no_age() {
        let mut edges = EdgeClock::new(MHZ, 5);
        assert_eq!(edges.sample(&reading(0, 1_000, None)).edge_age_ns, None);
        assert_eq!(edges.sample(&reading(0, 2_000, None)).edge_age_ns, None);
    }

    #[test]
    fn without_a_new_edge_the_age_grows_and_does_not_wrap() {
        let mut edges = EdgeClock::new(MHZ, 0);
        let mut now = 170_000_u32;
        edges.sample(&reading(1, now, Some(now)));
        for tick in 1..=60_000_u32 {
            now = now.wrapping_add(170_000);
            let age = edges.sample(&reading(1, now, None)).edge_age_ns.unwrap();
            if tick < 4_294 {
                assert_eq!(age, tick * 1_000_000);
            } else {
                // Beyond the range of nanoseconds in 32 bits, and later beyond a turn of the clock itself (25 s).
                assert!(age > 4_293_000_000, "{age} at {tick}");
            }
        }
    }

    #[test]
    fn wrapping_clocks_and_counters_make_no_jump() {
        let mut edges = EdgeClock::new(MHZ, u32::MAX - 100);
        let sample = edges.sample(&reading(u32::MAX, 69, Some(u32::MAX - 100)));
        assert_eq!((sample.count, sample.edge_age_ns), (-1, Some(1000)));
        let sample = edges.sample(&reading(0, 239, Some(239)));
        assert_eq!((sample.count, sample.edge_age_ns), (0, Some(0)));
    }

    #[test]
    fn the_index_is_the_captured_count() {
        let mut edges = EdgeClock::new(MHZ, 0);
        let mut seen = reading(4100, 100, Some(90));
        seen.index = Some(4096);
        assert_eq!(edges.sample(&seen).index, Some(4096));
        seen.index = Some(u32::MAX);
        assert_eq!(edges.sample(&seen).index, Some(-1));
        assert_eq!(edges.sample(&reading(4101, 200, None)).index, None);
    }
}
