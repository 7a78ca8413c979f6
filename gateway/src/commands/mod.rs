//! One file a command.

mod check;
mod completions;
mod expand;
mod params;
mod plot;
mod record;
mod run;
mod simulate;
mod status;
mod unavailable;

use leadscrew_can::Address;

use crate::cli::{Cli, Command};
use crate::failure::Outcome;
use crate::setup::Setup;

/// Does what was typed.
pub fn dispatch(cli: &Cli) -> Outcome {
    unavailable::refuse(cli)?;
    match &cli.command {
        Command::Completions { shell } => completions::print(*shell),
        Command::Params { command } => params::run(&cli.global, command),
        Command::Check(args) => check::run(&Setup::new(&cli.global)?, args),
        Command::Expand(args) => expand::run(&Setup::new(&cli.global)?, args),
        Command::Simulate(args) => {
            simulate::run(&Setup::with_drive(&cli.global, &args.drive)?, args)
        }
        Command::Plot(args) => {
            plot::format(&args.output)?;
            plot::run(&Setup::with_drive(&cli.global, &args.drive)?, args)
        }
        Command::Run(args) => run::run(&Setup::with_drive(&cli.global, &args.drive)?, args),
        Command::Status => status::run(&cli.global),
        Command::Record(args) if cli.global.bus != Address::Sim => {
            record::run(&Setup::new(&cli.global)?, args)
        }
        _ => unavailable::command(cli),
    }
}
