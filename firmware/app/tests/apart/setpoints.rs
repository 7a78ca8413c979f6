//! The setpoints of both kinds of board are the same.

use std::collections::VecDeque;

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Sim};
use leadscrew_core::call::Call;
use leadscrew_core::link::SetpointHash;
use leadscrew_core::params::{Entry, Params};

use crate::board::{Apart, calls};

/// The board in one piece.
pub fn whole(sim: &mut Sim, text: &str, params: &Params) -> u64 {
    let mut calls: VecDeque<Call> = calls(text, params).into();
    let mut hash = SetpointHash::new();
    let push = |hash: &mut SetpointHash, row: leadscrew_board_sim::Row| {
        let spindle = leadscrew_core::call::TapSpindle::ALL
            .iter()
            .find_map(|spindle| Some((*spindle, row.angle(*spindle).set?)));
        hash.push(row.position, spindle, row.doing == Doing::Run);
    };
    while !calls.is_empty() || sim.is_busy() {
        while calls.front().is_some_and(|call| sim.offer(call)) {
            calls.pop_front();
        }
        if let Some(row) = sim.step() {
            push(&mut hash, row);
        }
        while sim.event().is_some() {}
    }
    sim.last_rows(|row| push(&mut hash, row));
    hash.value()
}

pub fn sim(params: &Params) -> Sim {
    Sim::new(params, &PlantOptions::default()).expect("the machine starts")
}

/// One of the example programs for users.
fn example(name: &str) -> String {
    let path = format!("{}/../../examples/{name}.nc", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn programs_give_the_same_setpoints_as_on_a_board_in_one_piece() {
    let params = Params::sheets();
    for name in ["shaft", "o0008-g75-grooves", "g84-tap", "g84-floating"] {
        let (mut apart, mut sim) = (Apart::new(&params), sim(&params));
        let text = example(name);
        let hash = apart.run(&text, &params);
        assert_ne!(hash, SetpointHash::new().value(), "{name} moves");
        assert_eq!(hash, whole(&mut sim, &text, &params), "{name}");
    }
}

/// The drives on other nodes; one of them takes the node of another drive of the built-in machine.
fn moved() -> Params {
    let mut params = Params::sheets();
    let nodes = [("9015.X", 126), ("9015.Z", 16), ("9015.C", 2), ("9016", 99)];
    for (key, node) in nodes {
        let entry = Entry::find_text(key).expect("a parameter");
        params.set(entry, node).expect("in its range");
    }
    params
}

#[test]
fn programs_give_the_same_setpoints_wherever_the_drives_are() {
    for name in ["shaft", "g84-tap"] {
        let text = example(name);
        let hashes = [Params::sheets(), moved()].map(|params| {
            let hash = Apart::new(&params).run(&text, &params);
            assert_eq!(hash, whole(&mut sim(&params), &text, &params), "{name}");
            hash
        });
        assert_eq!(hashes[0], hashes[1], "{name}");
    }
}
