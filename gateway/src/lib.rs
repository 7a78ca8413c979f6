//! The `leadscrew` command line: programs in; moves, setpoints, pictures and diagnostics out.
//!
//! One file a command ([`commands`]); what several share has a room of its own: words for alarms ([`diagnostics`]), both
//! languages of all other words ([`words`]), the
//! move list's formats ([`movelist`]), exact numbers ([`number`]), JSON ([`json`]) and standard output ([`output`]).
//! Data goes there, words for people to standard error.
//!
//! A program file becomes a stream of events ([`program`]); [`checking`] looks at all of it without a machine, and
//! [`execution`] runs it on one ([`machine`]) while [`trace`] watches the setpoints and [`drawing`] and [`plot`] make the
//! picture. What the simulated board keeps between commands is in
//! [`state`]. Knows nothing of how motion is made.

pub mod checking;
pub mod cli;
pub mod commands;
pub mod diagnostics;
pub mod drawing;
pub mod execution;
pub mod failure;
pub mod feeder;
pub mod hole;
pub mod interrupt;
pub mod json;
pub mod length;
pub mod line_ends;
pub mod link;
pub mod machine;
pub mod mistyped;
pub mod movelist;
pub mod number;
pub mod origin;
pub mod output;
pub mod params;
pub mod plot;
pub mod program;
pub mod recording;
pub mod replace;
pub mod setup;
pub mod source;
pub mod state;
pub mod synchronism;
pub mod tapping;
pub mod threads;
pub mod trace;
pub mod values;
pub mod words;
