//! Machine time against real time: how many ticks are due.
//!
//! A process that comes late by a few periods makes up for them. One that stood still for longer does not: machine time
//! slips, because a burst of ticks would be a machine that jumps.

use std::time::{Duration, Instant};

/// The most periods that are made up for.
const MADE_UP: u32 = 5;

/// Machine time in thousandths of real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Speed(u32);

impl Speed {
    /// Real time.
    pub const REAL: Self = Self(1000);

    /// The slowest and the fastest speed. A gateway sends its heartbeat every 100 ms of real time, and a board counts it as
    /// lost after a second of its own time (9024): at five times the speed one of two may still be missed [D280].
    pub const RANGE: [u32; 2] = [10, 5000];

    /// This many thousandths; `None` outside of the [range](Self::RANGE).
    #[must_use]
    pub const fn of_thousandths(thousandths: u32) -> Option<Self> {
        let [least, most] = Self::RANGE;
        if thousandths < least || thousandths > most {
            return None;
        }
        Some(Self(thousandths))
    }

    /// Thousandths.
    #[must_use]
    pub const fn thousandths(self) -> u32 {
        self.0
    }
}

/// A clock for ticks.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    tick: Duration,
    speed: Speed,
    /// The time of the next tick.
    next: Instant,
    slips: u64,
    lost: u64,
}

impl Clock {
    /// A clock whose first tick is due a period after `now`.
    #[must_use]
    pub fn new(tick: Duration, now: Instant) -> Self {
        let mut clock = Self {
            tick,
            speed: Speed::REAL,
            next: now,
            slips: 0,
            lost: 0,
        };
        clock.next += clock.period();
        clock
    }

    /// Goes on at this speed.
    pub fn set_speed(&mut self, speed: Speed, now: Instant) {
        self.speed = speed;
        self.next = now + self.period();
    }

    /// Goes on with ticks of this length of machine time.
    pub fn set_tick(&mut self, tick: Duration, now: Instant) {
        self.tick = tick;
        self.next = now + self.period();
    }

    /// The speed.
    #[must_use]
    pub const fn speed(&self) -> Speed {
        self.speed
    }

    /// Real time between two ticks.
    fn period(&self) -> Duration {
        self.tick * Speed::REAL.thousandths() / self.speed.thousandths()
    }

    /// Time until the next tick.
    #[must_use]
    pub fn left(&self, now: Instant) -> Duration {
        self.next.saturating_duration_since(now)
    }

    /// The number of ticks to be run now.
    pub fn due(&mut self, now: Instant) -> u32 {
        let period = self.period();
        let Some(late) = now.checked_duration_since(self.next) else {
            return 0;
        };
        let periods = u64::try_from(late.as_nanos() / period.as_nanos().max(1)).unwrap_or(u64::MAX);
        if late > period * MADE_UP {
            self.slips += 1;
            self.lost = self.lost.saturating_add(periods);
            self.next = now + period;
            return 1;
        }
        // At most MADE_UP and one.
        let ticks = u32::try_from(periods).unwrap_or(MADE_UP) + 1;
        self.next += period * ticks;
        ticks
    }

    /// How often time has slipped, and by how many ticks in all.
    #[must_use]
    pub const fn slips(&self) -> (u64, u64) {
        (self.slips, self.lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    fn clock() -> (Clock, Instant) {
        let now = Instant::now();
        (Clock::new(MS, now), now)
    }

    #[test]
    fn a_tick_is_due_at_each_period_and_a_few_late_ones_are_made_up_for() {
        let (mut clock, start) = clock();
        assert_eq!((clock.due(start), clock.left(start)), (0, MS));
        assert_eq!(clock.due(start + MS), 1);
        assert_eq!(clock.due(start + MS * 3 / 2), 0);
        // The deadlines stay multiples of the period.
        assert_eq!(clock.due(start + MS * 7 / 2), 2);
        assert_eq!(clock.due(start + MS * 9), 6);
        assert_eq!(clock.slips(), (0, 0));
        assert_eq!(clock.left(start + MS * 9), MS);
    }

    #[test]
    fn what_is_later_than_five_periods_slips() {
        let (mut clock, start) = clock();
        // The first tick is due after 1 ms: 5 ms later all is made up for, a moment later it is not.
        let mut other = clock;
        assert_eq!(other.due(start + MS * 6), 6);
        let late = start + MS * 6 + Duration::from_micros(1);
        assert_eq!(clock.due(late), 1);
        assert_eq!(clock.slips(), (1, 5));
        assert_eq!(clock.left(late), MS);
        assert_eq!(clock.due(late + MS * 1001), 1);
        assert_eq!(clock.slips(), (2, 1005));
    }

    #[test]
    fn machine_time_can_be_faster_and_slower() {
        for (thousandths, period) in [(5000, MS / 5), (10, MS * 100), (1000, MS)] {
            let (mut clock, start) = clock();
            let speed = Speed::of_thousandths(thousandths).unwrap();
            clock.set_speed(speed, start);
            assert_eq!(clock.due(start + period - Duration::from_nanos(1)), 0);
            assert_eq!(clock.due(start + period), 1);
            assert_eq!(clock.left(start + period), period);
        }
        assert_eq!(Speed::of_thousandths(9), None);
        assert_eq!(Speed::of_thousandths(5001), None);
    }
}
