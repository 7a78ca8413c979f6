//! `fleet`: the sets that all machines have in force, as their agents have told a broker.
//!
//! ```text
//! heard   what the broker retains, as machines     list, diff   one file a verb
//! words   what is said of a broker and of times, in two languages
//! ```
//!
//! It reads and compares, and must not change anything anywhere: that is `params push` at the machine.

mod diff;
mod heard;
mod list;
mod words;

use crate::cli::{FleetCommand, Global};
use crate::failure::Outcome;

/// Does what was typed.
pub fn run(global: &Global, command: &FleetCommand) -> Outcome {
    match command {
        FleetCommand::List(asked) => list::run(global, asked),
        FleetCommand::Diff { folder, asked } => diff::run(global, folder, asked),
    }
}
