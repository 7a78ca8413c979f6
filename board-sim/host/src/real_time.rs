//! Real time: a SYNC at every multiple of the period, by deadlines that never shift. A setpoint that leaves after the SYNC
//! that is to latch it is late, and counted; the beat goes on as it was.
//!
//! A board that follows ticks with the SYNC that comes from the wire, by the time at which it came. One that comes before half
//! a period is over is a second one in that period; where none has come within one and a half, there was none in it.

use std::time::{Duration, Instant};

use leadscrew::failure::Outcome;
use leadscrew::interrupt;

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
    let mut grid = Grid { period, last };
    let (mut late, mut told) = (0_u64, Instant::now());
    while !interrupt::requested() && !machine.is_over() {
        if machine.follows() {
            next = wait_for_sync(&mut machine, &mut grid)?;
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
}

impl Grid {
    /// One that came at `time`: true where it is the next, and not a second one in the same period.
    fn takes(&mut self, time: Stamp) -> bool {
        let next = time.since(self.last) >= self.period / 2;
        if next {
            self.last = time;
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
