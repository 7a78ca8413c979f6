//! The `leadscrew` binary: parses the command line and lets the library do the rest.

use std::process::ExitCode;

use clap::Parser as _;
use leadscrew::{cli, commands};

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    match commands::dispatch(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(cli.global.lang(), cli.global.json),
    }
}
