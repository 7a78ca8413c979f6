//! What the contract names and this version does not do: each is a usage error that says so, never ignored.

use crate::cli::{Cli, Command};
use crate::failure::{Failure, Outcome};
use crate::values::Bus;

/// Refuses options that this version does not know how to honour.
pub fn refuse(cli: &Cli) -> Outcome {
    let global = &cli.global;
    let option = if global.state.is_some() {
        Some("--state")
    } else if global.cut_power.is_some() {
        Some("--cut-power")
    } else {
        None
    };
    if let Some(option) = option {
        return Err(Failure::Usage(format!("`{option}` is not available yet")));
    }
    if global.bus != Bus::Sim && touches_a_board(&cli.command) {
        return Err(Failure::Usage(format!(
            "`--bus {}` is not available yet; `--bus sim` (the default) runs on a simulated machine",
            global.bus
        )));
    }
    Ok(())
}

/// `check`, `expand`, `simulate` and `plot` compute; the others talk to a board.
fn touches_a_board(command: &Command) -> bool {
    !matches!(
        command,
        Command::Check(_)
            | Command::Expand(_)
            | Command::Simulate(_)
            | Command::Plot(_)
            | Command::Params { .. }
            | Command::Completions { .. }
    )
}

/// Refuses a command that is not available, with the reason.
pub fn command(cli: &Cli) -> Outcome {
    let (name, needs_a_board) = match &cli.command {
        Command::Status => ("status", false),
        Command::Monitor => ("monitor", true),
        Command::Hold => ("hold", true),
        Command::Resume => ("resume", true),
        Command::Reset => ("reset", true),
        Command::Stop => ("stop", true),
        Command::Override { .. } => ("override", true),
        Command::Signal { .. } => ("signal", true),
        Command::Record { .. } => ("record", true),
        Command::Retract { .. } => ("retract", false),
        _ => ("this command", false),
    };
    Err(Failure::Usage(if needs_a_board {
        format!(
            "`{name}` needs a board that goes on running between commands, and `--bus sim` lives inside one command; \
             boards on a real bus are not available yet"
        )
    } else {
        format!("`{name}` is not available yet")
    }))
}
