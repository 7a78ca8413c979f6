//! Real time: a SYNC at every multiple of the period, by deadlines that never shift. A setpoint that leaves after the SYNC
//! that is to latch it is late, and counted; the beat goes on as it was.
//!
//! A board that follows ticks with the SYNC that comes from the wire, by the time at which it came. One that comes
//! before half a period is over is a second one in that period; where none has come within one and a half, there was
//! none in it. A beat of another period than the board's own is none to follow.

use std::time::{Duration, Instant};

use leadscrew_common::failure::Outcome;
use leadscrew_common::interrupt;

use leadscrew_can::Stamp;

use crate::machine::{Machine, say};

/// Behind by more than this the process was stopped, and what it missed is not made up for.
const STOPPED: Duration = Duration::from_secs(1);

/// How often lateness is told.
const TELL: Duration = Duration::from_secs(1);

/// Runs until the user ends it, or what it was started for is done.
pub fn run(mut machine: Machine) -> Outcome {
    let period = machine.period();
    let mut next = Instant::now() + period;
    let last = Stamp::now();
    let mut grid = Grid {
        period,
        last,
        pace: Pace::new(last),
    };
    let (mut late, mut told) = (0_u64, Instant::now());
    while !interrupt::requested() && !machine.is_over() {
        if machine.follows() {
            next = wait_for_sync(&mut machine, &mut grid)?;
            machine.keeps_to_beat(grid.pace.is_right);
        } else {
            loop {
                let left = next.saturating_duration_since(Instant::now());
                machine.listen(left)?;
                if left.is_zero() {
                    break;
                }
            }
        }
        machine.tick()?;
        next += period;
        let now = Instant::now();
        if now > next {
            machine.note_late();
            late += 1;
        }
        if now > next + STOPPED {
            say("stood still for more than a second; the time is not made up for");
            next = now + period;
        }
        if late > 0 && told.elapsed() >= TELL {
            say(&format!("{late} setpoints came late for their SYNC"));
            (late, told) = (0, now);
        }
    }
    machine.conclude()
}

/// Where the SYNCs of another board are expected.
struct Grid {
    period: Duration,
    /// The last one, or where it should have been.
    last: Stamp,
    pace: Pace,
}

/// Whether the SYNCs have the board's own period: in 64 of these no more than one
/// too many or too few. The computer may stand still in between and make up for it,
/// so four such windows in a row have to be wrong, and one that is right is enough.
struct Pace {
    is_right: bool,
    begun: Stamp,
    /// Periods since.
    periods: u32,
    /// Windows in a row that were wrong.
    wrong: u32,
    /// Periods in a row without a SYNC.
    missed: u32,
}

impl Pace {
    const WINDOW: u32 = 64;

    /// Not known to be right before the first window is over.
    const fn new(begun: Stamp) -> Self {
        Self {
            is_right: false,
            begun,
            periods: 0,
            wrong: 0,
            missed: 0,
        }
    }

    /// A period without a SYNC is over. With three in a row there is no beat, and nothing is known of the next one.
    fn misses(&mut self, now: Stamp) {
        self.periods += 1;
        self.missed += 1;
        if !self.is_right || self.missed >= 3 {
            *self = Self::new(now);
        }
    }

    /// A period is over with a SYNC at `time`.
    fn hears(&mut self, time: Stamp, period: Duration) {
        self.periods += 1;
        self.missed = 0;
        if self.periods < Self::WINDOW {
            return;
        }
        let off = time.since(self.begun).abs_diff(period * self.periods);
        self.wrong = if off > period { self.wrong + 1 } else { 0 };
        match self.wrong {
            0 => self.is_right = true,
            4.. => self.is_right = false,
            _ => {}
        }
        (self.begun, self.periods) = (time, 0);
    }
}

impl Grid {
    /// One that came at `time`: true where it is the next, and not a second one in the same period.
    fn takes(&mut self, time: Stamp) -> bool {
        let next = time.since(self.last) >= self.period / 2;
        if next {
            self.last = time;
            self.pace.hears(time, self.period);
        }
        next
    }

    /// How long the next one is still waited for.
    fn left(&self, now: Stamp) -> Duration {
        (self.period + self.period / 2).saturating_sub(now.since(self.last))
    }

    /// There was none. What was missed by a process that stood still is not made up for.
    fn misses(&mut self, now: Stamp) {
        let since = now.since(self.last);
        let on = if since > STOPPED { since } else { self.period };
        self.last = Stamp::from_nanos(self.last.nanos() + on.as_nanos() as u64);
        self.pace.misses(self.last);
    }
}

/// Waits for the SYNC of another board, or until there was none; when that was.
fn wait_for_sync(machine: &mut Machine, grid: &mut Grid) -> Outcome<Instant> {
    while !interrupt::requested() {
        while let Some(time) = machine.take_beat() {
            if grid.takes(time) {
                return Ok(at(time));
            }
        }
        let now = Stamp::now();
        let left = grid.left(now);
        if left.is_zero() {
            grid.misses(now);
            return Ok(at(grid.last));
        }
        machine.listen(left)?;
    }
    Ok(Instant::now())
}

/// The same on the other clock.
fn at(time: Stamp) -> Instant {
    let now = Instant::now();
    now.checked_sub(Stamp::now().since(time)).unwrap_or(now)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid {
            period: Duration::from_millis(2),
            last: Stamp::from_micros(10_000),
            pace: Pace::new(Stamp::from_micros(10_000)),
        }
    }

    /// Another's SYNCs, every so many µs; each is late by what `jitter` says of its number.
    fn hear(grid: &mut Grid, every: u64, count: u64, jitter: impl Fn(u64) -> u64) {
        let begun = grid.last.nanos() / 1_000;
        for number in 1..=count {
            let time = Stamp::from_micros(begun + number * every + jitter(number));
            while grid.left(time).is_zero() {
                grid.misses(time);
            }
            grid.takes(time);
        }
    }

    #[test]
    fn a_beat_of_another_period_is_not_kept_to() {
        for every in [1_100, 1_400, 1_900, 2_050, 2_100, 2_800, 2_990, 3_200] {
            let mut grid = grid();
            hear(&mut grid, every, 1_000, |_| 0);
            assert!(!grid.pace.is_right, "{every}");
        }
        let mut grid = grid();
        hear(&mut grid, 2_000, 63, |_| 0);
        assert!(!grid.pace.is_right, "nothing is known yet");
        hear(&mut grid, 2_000, 1, |_| 0);
        assert!(grid.pace.is_right);
        hear(&mut grid, 2_800, 64 * 4, |_| 0);
        assert!(!grid.pace.is_right);
        // Nobody gives it for a while, and then somebody else.
        hear(&mut grid, 2_000, 200, |_| 0);
        assert!(grid.pace.is_right);
        hear(&mut grid, 2_800, 200, |_| 10_000);
        assert!(!grid.pace.is_right);
        // Two clocks are never the same.
        for every in [1_990, 2_010] {
            let mut grid = self::grid();
            hear(&mut grid, every, 1_000, |_| 0);
            assert!(grid.pace.is_right, "{every}");
        }
    }

    #[test]
    fn a_computer_that_is_busy_keeps_to_a_beat() {
        let mut grid = grid();
        hear(&mut grid, 2_000, 200, |_| 0);
        // Nearly half a period late now and then, and stops of 50 ms.
        for round in 0..10 {
            hear(&mut grid, 2_000, 500, |number| match number {
                100..=125 => (125 - number) * 2_000,
                _ => number * 7_919 % 900,
            });
            assert!(grid.pace.is_right, "{round}");
        }
    }

    #[test]
    fn one_in_each_period_is_the_next_wherever_it_comes() {
        let mut grid = grid();
        for time in [12_000, 13_000, 15_900, 17_900, 19_000] {
            assert!(grid.takes(Stamp::from_micros(time)), "{time}");
        }
        assert_eq!(
            grid.left(Stamp::from_micros(19_000)),
            Duration::from_millis(3)
        );
    }

    #[test]
    fn twice_as_many_are_two_in_a_period_and_half_as_many_none_in_every_second() {
        let mut grid = grid();
        let comes = |grid: &mut Grid, time| grid.takes(Stamp::from_micros(time));
        let taken = [10_999, 11_998, 12_997, 13_996].map(|time| comes(&mut grid, time));
        assert_eq!(taken, [false, true, false, true]);
        let mut grid = self::grid();
        for time in [14_000, 18_000] {
            let passed = Stamp::from_micros(time - 1_000);
            assert!(grid.left(passed).is_zero());
            grid.misses(passed);
            assert_eq!(grid.last, Stamp::from_micros(time - 2_000));
            assert!(comes(&mut grid, time));
        }
    }

    #[test]
    fn who_stood_still_goes_on_from_now() {
        let mut grid = grid();
        let now = Stamp::from_micros(5_000_000);
        grid.misses(now);
        assert_eq!(grid.last, now);
    }
}
