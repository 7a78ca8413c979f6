//! `fleet`: what is typed to ask a broker about the sets of all machines.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use leadscrew_agent::mqtt::Address;

use super::agent::Access;
use super::examples;

/// `fleet`.
#[derive(Debug, Subcommand)]
pub enum FleetCommand {
    /// Print the machines that agents have told of: board, firmware, set in force, since when, last seen
    #[command(after_help = examples::FLEET_LIST)]
    List(Asked),
    /// Compare machine files with the sets in force; exit code 1 where anything differs, or cannot be compared
    ///
    /// DIR holds `MACHINE.toml`, the files of `params push`, under the names that the agents give to the machines. What a
    /// file does not name is as it is in force. Objects of drives are not compared: an agent does not read them.
    #[command(after_help = examples::FLEET_DIFF)]
    Diff {
        /// The folder of machine files; every `*.toml` in it is one
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Whom to ask.
        #[command(flatten)]
        asked: Asked,
    },
}

/// Whom to ask, and how long.
#[derive(Args, Debug)]
pub struct Asked {
    /// The broker: `mqtt://HOST[:1883]`, or by TLS `mqtts://HOST[:8883]`
    #[arg(long, value_name = "URL")]
    pub broker: Address,
    /// Whom the broker lets in.
    #[command(flatten)]
    pub access: Access,
    /// Seconds that the broker has to tell all
    #[arg(long, value_name = "S", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=3600))]
    pub wait: u64,
}
