//! `completions`: a script for a shell, on standard output.

use std::io::Write as _;

use clap::CommandFactory as _;
use clap_complete::Shell;

use crate::cli::Cli;
use crate::failure::{Failure, Outcome};

/// Prints the script.
pub fn print(shell: Shell) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "leadscrew", &mut script);
    std::io::stdout()
        .write_all(&script)
        .map_err(|error| Failure::stdout(&error))
}
