//! The `leadscrew` binary: parses the command line and lets the library do the rest.

use std::process::ExitCode;

use clap::Parser as _;
use leadscrew::{cli, commands};
use leadscrew_common::{interrupt, mistyped};
use leadscrew_core::alarm::Lang;

fn main() -> ExitCode {
    let typed: Vec<_> = std::env::args_os().collect();
    let mut cli = match cli::Cli::try_parse_from(&typed) {
        Ok(cli) => cli,
        Err(error) => {
            let error = match mistyped::lang(&typed) {
                Lang::En => error,
                Lang::Zh => cli::chinese::instead_of(error, &typed),
            };
            return mistyped::report(&error, &typed);
        }
    };
    interrupt::watch(cli.global.lang(), cli.global.json);
    match cli.settle().and_then(|()| commands::dispatch(&cli)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(cli.global.lang(), cli.global.json),
    }
}
