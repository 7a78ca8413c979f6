//! One file a command.

mod completions;
mod params;
mod unavailable;

use crate::cli::{Cli, Command};
use crate::failure::Outcome;

/// Does what was typed.
pub fn dispatch(cli: &Cli) -> Outcome {
    unavailable::refuse(cli)?;
    match &cli.command {
        Command::Completions { shell } => completions::print(*shell),
        Command::Params { command } => params::run(&cli.global, command),
        _ => unavailable::command(cli),
    }
}
