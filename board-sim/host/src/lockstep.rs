//! Virtual time: a tick is taken when everything it depends on has come, and no clock has a say in what it gives.
//!
//! - A tick waits for the program: while more of it is to come and there is room for it, time stands still.
//! - A tick waits for the answers of the drives that are elsewhere, where one is due.
//! - A tick waits for the gateway's heartbeat, where the machine would outrun it: a gateway that is there is not lost.
//! - A tick waits for the setpoints of further boards, where it is asked to: then they go on with it.
//! - A board that follows ticks with each SYNC that comes, and with nothing else: time is whose beat it is.
//! - A machine with nothing to do goes on in turns of the SYNC counter, 240 ticks each, one after another in real time;
//!   so every program begins at the same count, and its frames are the same whenever it is started.

use std::time::{Duration, Instant};

use leadscrew_common::failure::Outcome;
use leadscrew_common::interrupt;
use leadscrew_core::bus::{NodeId, SyncProducer};

use crate::machine::Machine;

/// Ticks after which the SYNC counter shows the same again.
const TURN: u64 = SyncProducer::LAST as u64;

/// A program that does not go on for so long is not waited for any more: time goes
/// on, so that its loss is noticed. The computer may have stood still [D178].
const LOST: Duration = Duration::from_secs(5);

/// How long a drive that is known to answer is waited for.
const ANSWER: Duration = Duration::from_secs(5);

/// How long a further board is waited for that is known to go on: it may be waiting for its own program.
const NEIGHBOUR: Duration = Duration::from_secs(10);

/// How long any answer of a drive is waited for that has not been heard yet.
const GREETING: Duration = Duration::from_millis(20);

/// Runs until the user ends it, or what it was started for is done.
pub fn run(mut machine: Machine) -> Outcome {
    let away = machine.away().iter().map(|node| Expected {
        node: *node,
        what: What::Status,
        due: None,
    });
    let beside = machine.beside().iter().map(|node| Expected {
        node: *node,
        what: What::Setpoint,
        due: None,
    });
    let mut expected: Vec<Expected> = away.chain(beside).collect();
    let mut last = Instant::now();
    let mut lost = false;
    while !interrupt::requested() && !machine.is_over() {
        let up = machine.since_up();
        if machine.follows() {
            machine.listen(Duration::ZERO)?;
            if machine.take_beat().is_none() {
                machine.listen(Duration::from_millis(50))?;
            } else if up.is_none() || wait_for_program(&mut machine, &mut lost)? {
                wait_for_gateway(&mut machine)?;
                step(&mut machine, &mut expected)?;
            }
            last = Instant::now();
            continue;
        }
        if machine.is_busy() || up.is_none_or(|ticks| !ticks.is_multiple_of(TURN)) {
            machine.listen(Duration::ZERO)?;
            if up.is_some() && !wait_for_program(&mut machine, &mut lost)? {
                continue;
            }
            wait_for_gateway(&mut machine)?;
            step(&mut machine, &mut expected)?;
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

/// What is awaited of a drive.
#[derive(Clone, Copy, PartialEq, Eq)]
enum What {
    /// Of the board's own that is elsewhere: its status, where one is due.
    Status,
    /// Of another board's: what that tells it, in every tick.
    Setpoint,
}

/// What is known of a drive that is waited for.
struct Expected {
    node: NodeId,
    what: What,
    /// SYNCs until it comes; `None` before the first and after one that did not come.
    due: Option<u8>,
}

impl Expected {
    fn has_come(&self, machine: &Machine) -> bool {
        match self.what {
            What::Status => machine.has_status_of(self.node),
            What::Setpoint => machine.has_setpoint_for(self.node),
        }
    }

    /// How long it is waited for now, if at all.
    const fn patience(&self) -> Option<Duration> {
        match (self.due, self.what) {
            (None, _) => Some(GREETING),
            (Some(0), What::Status) => Some(ANSWER),
            (Some(0), What::Setpoint) => Some(NEIGHBOUR),
            (Some(_), _) => None,
        }
    }
}

/// A tick, and the answers to its SYNC.
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
            if one.due.is_none() && one.what == What::Setpoint {
                catch_up(machine)?;
            }
            one.due = Some(match one.what {
                What::Status => machine.transmission(),
                What::Setpoint => 1,
            });
        } else if one.due == Some(0) {
            one.due = None;
        }
    }
    Ok(())
}

/// A further board that is heard for the first time may still have SYNCs before it: until it has none.
fn catch_up(machine: &mut Machine) -> Outcome {
    let mut quiet = Instant::now();
    while quiet.elapsed() < GREETING {
        let before = machine.setpoints();
        machine.listen(GREETING.saturating_sub(quiet.elapsed()))?;
        if machine.setpoints() != before {
            quiet = Instant::now();
        }
    }
    Ok(())
}
