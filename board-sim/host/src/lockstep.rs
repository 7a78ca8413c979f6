//! Virtual time: a tick is taken when everything it depends on has come, and no clock has a say in what it gives.
//!
//! - A tick waits for the program: while more of it is to come and there is room for it, time stands still.
//! - A tick waits for the answers of the drives that are elsewhere, where one is due.
//! - A tick waits for the gateway's heartbeat, where the machine would outrun it: a gateway that is there is not lost.
//! - A machine with nothing to do goes on in turns of the SYNC counter, 240 ticks each, one after another in real time;
//!   so every program begins at the same count, and its frames are the same whenever it is started.

use std::time::{Duration, Instant};

use leadscrew::failure::Outcome;
use leadscrew::interrupt;
use leadscrew_core::bus::{NodeId, SyncProducer};

use crate::machine::Machine;

/// Ticks after which the SYNC counter shows the same again.
const TURN: u64 = SyncProducer::LAST as u64;

/// A program that does not go on for so long is not waited for any more: time goes on, so that its loss is noticed.
const LOST: Duration = Duration::from_secs(2);

/// How long a drive that is known to answer is waited for.
const ANSWER: Duration = Duration::from_secs(1);

/// How long any answer of a drive is waited for that has not been heard yet.
const GREETING: Duration = Duration::from_millis(20);

/// Runs until the user ends it, or what it was started for is done.
pub fn run(mut machine: Machine) -> Outcome {
    let mut drives: Vec<Expected> = machine
        .away()
        .iter()
        .map(|node| Expected::of(*node))
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
            step(&mut machine, &mut drives)?;
            if machine.is_held() || up.is_none() || lost {
                // Nothing but a person or a drive ends this: at the pace of either.
                std::thread::sleep(machine.period());
            }
            last = Instant::now();
        } else {
            let turn = machine.period() * TURN as u32;
            let left = turn.saturating_sub(last.elapsed());
            if left.is_zero() {
                for _ in 0..TURN {
                    step(&mut machine, &mut drives)?;
                }
                last = Instant::now();
            } else {
                machine.listen(left.min(Duration::from_millis(50)))?;
            }
        }
    }
    machine.conclude()
}

/// True where the tick may be taken. `lost`: the program has been waited for in vain, and is not again before more of it
/// has come.
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

/// Lets a gateway that is there say so before it counts as lost in virtual time.
fn wait_for_gateway(machine: &mut Machine) -> Outcome {
    while machine.outruns_gateway(LOST) && !interrupt::requested() {
        machine.listen(Duration::from_millis(20))?;
    }
    Ok(())
}

/// What is known of a drive that is elsewhere.
struct Expected {
    node: NodeId,
    /// SYNCs until it answers; `None` before its first answer and after one that did not come.
    due: Option<u8>,
}

impl Expected {
    const fn of(node: NodeId) -> Self {
        Self { node, due: None }
    }
}

/// A tick, and the answers to its SYNC.
fn step(machine: &mut Machine, drives: &mut [Expected]) -> Outcome {
    machine.tick()?;
    for drive in &mut *drives {
        drive.due = drive.due.map(|due| due.saturating_sub(1));
    }
    let started = Instant::now();
    loop {
        let missing = |drive: &&mut Expected| !machine.has_status_of(drive.node);
        let patience = drives
            .iter_mut()
            .filter(missing)
            .filter_map(|drive| match drive.due {
                None => Some(GREETING),
                Some(0) => Some(ANSWER),
                Some(_) => None,
            })
            .max();
        let Some(left) = patience.map(|patience| patience.saturating_sub(started.elapsed())) else {
            break;
        };
        if left.is_zero() {
            break;
        }
        machine.listen(left)?;
    }
    for drive in drives {
        if machine.has_status_of(drive.node) {
            drive.due = Some(machine.transmission());
        } else if drive.due == Some(0) {
            drive.due = None;
        }
    }
    Ok(())
}
