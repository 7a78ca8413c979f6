//! Real time: a SYNC at every multiple of the period, by deadlines that never shift. A setpoint that leaves after the
//! SYNC that has to latch it is late and is counted; the deadlines stay the same.

use std::time::{Duration, Instant};

use leadscrew_common::failure::Outcome;
use leadscrew_common::interrupt;

use crate::machine::{Machine, say};

/// A process that is later than this was stopped. It does not make up for the lost time.
const STOPPED: Duration = Duration::from_secs(1);

/// The interval between reports of late setpoints.
const TELL: Duration = Duration::from_secs(1);

/// Runs until the user ends it, or its task is done.
pub fn run(mut machine: Machine) -> Outcome {
    let mut next = Instant::now() + machine.period();
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
        let period = machine.period();
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
