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
    let mut beat = Stamp::now();
    let (mut late, mut told) = (0_u64, Instant::now());
    while !interrupt::requested() && !machine.is_over() {
        if machine.follows() {
            next = wait_for_sync(&mut machine, &mut beat)?;
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

/// Waits for the SYNC of another board, or until there was none; when that was. `last`: the one before, or where it should have
/// been.
fn wait_for_sync(machine: &mut Machine, last: &mut Stamp) -> Outcome<Instant> {
    let period = machine.period();
    let half = period / 2;
    loop {
        while let Some(time) = machine.take_beat() {
            if time.since(*last) >= half {
                *last = time;
                return Ok(at(time));
            }
        }
        let since = Stamp::now().since(*last);
        let left = (period + half).saturating_sub(since);
        if left.is_zero() {
            let ahead = if since > STOPPED { since } else { period };
            *last = Stamp::from_nanos(last.nanos() + ahead.as_nanos() as u64);
            return Ok(at(*last));
        }
        machine.listen(left)?;
        if interrupt::requested() {
            return Ok(Instant::now());
        }
    }
}

/// The same on the other clock.
fn at(time: Stamp) -> Instant {
    let now = Instant::now();
    now.checked_sub(Stamp::now().since(time)).unwrap_or(now)
}
