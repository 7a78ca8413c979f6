//! `board-sim`: a simulated board with its drives, spindle and encoder, on a real CAN bus.
//!
//! ```text
//! board-sim --bus vcan0 --node 1              in real time, until Ctrl-C
//! board-sim --bus vcan0 --lockstep            in virtual time: nothing depends on how fast the bus is
//! board-sim drives --bus vcan0                the drives of the axes alone, for a board that is elsewhere
//! ```
//!
//! Every setpoint and every answer goes over the wire, even where board and drives live in one process.
//! `leadscrew_core` has the board and `leadscrew_board_sim` its surroundings; this crate has clocks, sockets and options.

mod claim;
mod cli;
mod drives;
mod hand;
mod lockstep;
mod machine;
mod program;
mod real_time;
mod spoil;
mod when;
mod wire;

use std::process::ExitCode;

use clap::Parser as _;
use leadscrew_common::failure::Outcome;
use leadscrew_common::{interrupt, mistyped};
use leadscrew_core::alarm::Lang;

use crate::cli::{Cli, Command};
use crate::machine::Machine;

fn main() -> ExitCode {
    let typed: Vec<_> = std::env::args_os().collect();
    let cli = match Cli::try_parse_from(&typed) {
        Ok(cli) => cli,
        Err(error) => return mistyped::report(&error, &typed),
    };
    interrupt::watch(Lang::En, false);
    // An interruption lets the machine end in order, with its flash saved and its figures printed.
    interrupt::defer(interrupt::UnderWay::Machine);
    match run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(Lang::En, false),
    }
}

fn run(cli: &Cli) -> Outcome {
    if let Some(Command::Drives(args)) = &cli.command {
        return drives::run(args);
    }
    let machine = Machine::new(&cli.board)?;
    if cli.board.lockstep {
        lockstep::run(machine)
    } else {
        real_time::run(machine)
    }
}
