//! The `leadscrew` command line: programs in; moves, setpoints, pictures and diagnostics out.
//!
//! One file a command ([`commands`]); what several share has a room of its own, such as the move list's formats
//! ([`movelist`]). What `board-sim` needs too is in `leadscrew_common`: words for people in both languages, machine files,
//! values of the command line, programs as files, JSON and standard output. Data goes to standard output, words for people
//! to standard error.
//!
//! A program file becomes a stream of events ([`program`]); [`checking`] looks at all of it without a machine, and
//! [`execution`] runs it on one ([`machine`]) while [`trace`] watches the setpoints and [`drawing`] and [`plot`] make the
//! picture. What the simulated board keeps between commands is in
//! [`state`]. Knows nothing of how motion is made.
//!
//! ```
//! use clap::Parser as _;
//! use leadscrew::cli::{Cli, Command};
//!
//! let typed = Cli::try_parse_from(["leadscrew", "check", "examples/shaft.nc"])?;
//! assert!(matches!(typed.command, Command::Check(_)));
//! # Ok::<(), clap::Error>(())
//! ```

pub mod beside;
mod block;
pub mod certified;
pub mod checking;
pub mod cli;
pub mod commands;
pub mod doctor;
pub mod drawing;
pub mod execution;
pub mod features;
pub mod feeder;
pub mod in_force;
pub mod inspection;
mod itself;
pub mod link;
pub mod machine;
pub mod movelist;
pub mod origin;
pub mod page;
pub mod pixels;
pub mod plot;
pub mod recording;
pub mod setup;
pub mod start;
pub mod synchronism;
pub mod tapping;
pub mod threads;
pub mod trace;
pub mod tuning;
pub mod variables;
pub mod walk;

// Named once for the whole crate: `crate::words` here is `leadscrew_common::words`.
use leadscrew_common::{
    diagnostics, failure, interrupt, json, number, output, params, place, profiles, program,
    replace, source, state, tools, values, words,
};
