//! Programs through the line onto the board: the setpoints are those of `--bus sim`.

use std::process::Command;

use crate::board::{Board, example, field, ours, program};

/// What `--bus sim` makes of it, with the increments of the board's image.
fn simulated(program: &str) -> String {
    let output = Command::new(ours())
        .args(["run", program, "--json", "--set", "1004.1=1"])
        .output()
        .expect("it starts");
    assert!(output.status.success());
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs it there and here. The machine begins where the board's stands at power-up.
#[track_caller]
pub fn same_as_simulated(board: &Board, program: &str) {
    let simulated = simulated(program);
    let ran = board.good(&["run", program, "--json"]);
    for name in ["ok", "moves", "setpoint_hash", "late"] {
        assert_eq!(
            field(&ran, name),
            field(&simulated, name),
            "{name} of {program}\n{ran}\n{simulated}"
        );
    }
    assert_eq!(field(&ran, "late"), "0");
}

#[test]
fn a_thread_by_g76() {
    same_as_simulated(&Board::start(), &example("o0013-g76-m68x6.nc"));
}

#[test]
fn grooves_by_g75() {
    let path = program(
        "O0075\nG50 X40 Z20\nM3 S800\nG0 X34 Z-10\nG75 R0.3\nG75 X30 Z-16 P1000 Q6000 F200\nG0 X40 Z20\nM30\n",
    );
    same_as_simulated(&Board::start(), &path);
}

#[test]
fn taps_by_g84() {
    same_as_simulated(&Board::start(), &example("g84-tap.nc"));
    same_as_simulated(&Board::start(), &example("g84-floating.nc"));
}

#[test]
fn a_shaft() {
    same_as_simulated(&Board::start(), &example("shaft.nc"));
}
