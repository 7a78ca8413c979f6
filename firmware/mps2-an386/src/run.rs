//! Runs a program from its text to the hash of its setpoints, in lock-step with the plant.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::board;
use leadscrew_core::call::{Call, TapSpindle};
use leadscrew_core::link::SetpointHash;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Events, Options};

/// Ticks after which a run counts as hanging.
const LONGEST: u64 = 1_000_000;

/// The result of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// The hash of every tick from the first to the last one in state run.
    pub hash: u64,
    /// The number of these ticks.
    pub ticks: u64,
    /// Number of the alarm that refused or stopped the program; 0 for none.
    pub alarm: u16,
}

/// Runs a program to its end on the built-in machine.
///
/// # Panics
/// Where the machine does not start or does not come to an end.
#[must_use]
pub fn run(text: &[u8], params: &Params) -> Outcome {
    let calls = || Events::new(text, params, Options::default());
    // The whole program is read before anything moves.
    if let Some(alarm) = calls().find_map(Result::err) {
        return Outcome {
            hash: SetpointHash::new().value(),
            ticks: 0,
            alarm: alarm.number(),
        };
    }
    let mut calls = calls().filter_map(|event| match event {
        Ok(Event::Call(call)) => Some(call),
        _ => None,
    });
    let mut sim = Sim::new(params, &PlantOptions::default()).expect("the machine starts");
    let mut hash = SetpointHash::new();
    let mut alarm = 0;
    let mut next: Option<Call> = calls.next();
    let mut ticks = 0;
    while next.is_some() || sim.is_busy() {
        while next.as_ref().is_some_and(|call| sim.offer(call)) {
            next = calls.next();
        }
        if let Some(row) = sim.step() {
            push(&mut hash, &row);
        }
        ticks += 1;
        assert!(ticks < LONGEST, "the machine does not come to an end");
        while let Some(event) = sim.event() {
            if let board::Event::Alarm(raised) = event {
                alarm = raised.number();
            }
        }
        if alarm != 0 {
            next = None;
        }
    }
    sim.last_rows(|row| push(&mut hash, &row));
    Outcome {
        hash: hash.value(),
        ticks: hash.ticks(),
        alarm,
    }
}

fn push(hash: &mut SetpointHash, row: &Row) {
    let spindle = TapSpindle::ALL
        .iter()
        .find_map(|spindle| Some((*spindle, row.angle(*spindle).set?)));
    hash.push(row.position, spindle, row.doing == Doing::Run);
}
