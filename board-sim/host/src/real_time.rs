//! Real time: a SYNC at every multiple of the period, by deadlines that never shift. A setpoint that leaves after the SYNC
//! that is to latch it is late, and counted; the beat goes on as it was.

use std::time::{Duration, Instant};

use leadscrew_common::failure::Outcome;
use leadscrew_common::interrupt;

use crate::machine::{Machine, say};

/// Behind by more than this the process was stopped, and what it missed is not made up for.
const STOPPED: Duration = Duration::from_secs(1);

/// How often lateness is told.
const TELL: Duration = Duration::from_secs(1);

/// Runs until the user ends it, or what it was started for is done.
pub fn run(mut machine: Machine) -> Outcome {
    let period = machine.period();
    let mut next = Instant::now() + period;
    let (mut late, mut told) = (0_u64, Instant::now());
    while !interrupt::requested() && !machine.is_over() {
        loop {
            let left = next.saturating_duration_since(Instant::now());
            machine.listen(left)?;
            if left.is_zero() {
                break;
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
