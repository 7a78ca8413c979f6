//! Virtual time: a tick runs when everything that it depends on is there. No clock influences its result.
//!
//! - A tick waits for the program: while more of it is to come and there is room for it, time stands still.
//! - A tick waits for the answers of drives that are elsewhere, where an answer is due.
//! - A tick waits for the gateway's heartbeat where the machine would run ahead of it: a living gateway is not lost.
//! - A machine with nothing to do runs whole turns of the SYNC counter, 240 ticks each, in real time. So every program
//!   begins at the same count, and its frames are the same at any time of its start.

use std::time::{Duration, Instant};

use leadscrew_common::failure::Outcome;
use leadscrew_common::interrupt;
use leadscrew_core::bus::{NodeId, SyncProducer};

use crate::machine::Machine;

/// The number of ticks in a turn of the SYNC counter.
const TURN: u64 = SyncProducer::LAST as u64;

/// The longest wait for the program. After that time goes on, so that the board notices the loss. The computer may have
/// stood still [D178].
const LOST: Duration = Duration::from_secs(5);

/// The longest wait for a drive that is known to answer.
const ANSWER: Duration = Duration::from_secs(5);

/// The longest wait for a drive that was never heard.
const GREETING: Duration = Duration::from_millis(20);

/// Runs until the user ends it, or its task is done.
pub fn run(mut machine: Machine) -> Outcome {
    let away = machine.away().iter();
    let mut expected: Vec<Expected> = away
        .map(|node| Expected {
            node: *node,
            due: None,
        })
        .collect();
    let mut last = Instant::now();
    let mut lost = false;
    while !interrupt::requested() && !machine.is_over() {
        let up = machine.since_up();
        if machine.is_busy() || up.is_none_or(|ticks| !ticks.is_multiple_of(TURN)) {
            machine.listen(Duration::ZERO)?;
            if up.is_some() && !wait_for_program(&mut machine, &mut lost)? {
                continue;
            }
            wait_for_gateway(&mut machine)?;
            step(&mut machine, &mut expected)?;
            if machine.is_held() || up.is_none() || lost {
                // Only a person or a drive ends this state, so time passes at the pace of real time.
                std::thread::sleep(machine.period());
            }
            last = Instant::now();
        } else {
            let turn = machine.period() * TURN as u32;
            let left = turn.saturating_sub(last.elapsed());
            if left.is_zero() {
                for _ in 0..TURN {
                    step(&mut machine, &mut expected)?;
                }
                last = Instant::now();
            } else {
                machine.listen(left.min(Duration::from_millis(50)))?;
            }
        }
    }
    machine.conclude()
}

/// True where the tick may run. `lost`: the wait for the program was in vain; the next wait comes only after more of
/// the program has come.
fn wait_for_program(machine: &mut Machine, lost: &mut bool) -> Outcome<bool> {
    *lost &= machine.awaits_program();
    let started = Instant::now();
    while !*lost && machine.awaits_program() {
        if interrupt::requested() {
            return Ok(false);
        }
        machine.listen(Duration::from_millis(50))?;
        *lost = started.elapsed() >= LOST;
    }
    Ok(true)
}

/// Waits for a heartbeat of a living gateway, before it counts as lost in virtual time.
fn wait_for_gateway(machine: &mut Machine) -> Outcome {
    while machine.outruns_gateway(LOST) && !interrupt::requested() {
        machine.listen(Duration::from_millis(20))?;
    }
    Ok(())
}

/// A drive that is elsewhere, and when its status is due.
struct Expected {
    node: NodeId,
    /// SYNCs until the status is due; `None` before the first status and after a missing one.
    due: Option<u8>,
}

impl Expected {
    fn has_come(&self, machine: &Machine) -> bool {
        machine.has_status_of(self.node)
    }

    /// The longest wait for the drive now, if any.
    const fn patience(&self) -> Option<Duration> {
        match self.due {
            None => Some(GREETING),
            Some(0) => Some(ANSWER),
            Some(_) => None,
        }
    }
}

/// Runs a tick, and waits for the answers to its SYNC.
fn step(machine: &mut Machine, expected: &mut [Expected]) -> Outcome {
    machine.tick()?;
    for one in &mut *expected {
        one.due = one.due.map(|due| due.saturating_sub(1));
    }
    let started = Instant::now();
    loop {
        let missing = expected.iter().filter(|one| !one.has_come(machine));
        let patience = missing.filter_map(Expected::patience).max();
        let Some(left) = patience.map(|patience| patience.saturating_sub(started.elapsed())) else {
            break;
        };
        if left.is_zero() || interrupt::requested() {
            break;
        }
        machine.listen(left)?;
    }
    for one in expected {
        if one.has_come(machine) {
            one.due = Some(machine.transmission());
        } else if one.due == Some(0) {
            one.due = None;
        }
    }
    Ok(())
}
