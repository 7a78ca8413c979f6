//! What the programs of the host share: the command line `leadscrew` and the simulator `board-sim`.
//!
//! Words for people in both languages ([`words`]), for alarms ([`diagnostics`]) and for what goes wrong ([`failure`],
//! [`mistyped`]); machine files and `--set` ([`params`]); profiles of drives ([`profiles`]); values of the command line
//! ([`values`]); program files as streams of events ([`source`], [`program`]) and their lines ([`place`]); the flash of a
//! simulated board ([`state`]); standard output ([`output`], [`json`]); SIGINT and SIGTERM ([`interrupt`]). Knows no
//! command, and nothing of a board on a bus.
//!
//! ```
//! use leadscrew_common::params::load_text;
//! use leadscrew_core::alarm::Lang;
//!
//! let machine = load_text("lathe.toml", "rapid_rate.X = \"12 m/min\"\n", Lang::En);
//! assert!(machine.is_good());
//! assert!(!load_text("lathe.toml", "rapid_rte.X = \"12 m/min\"\n", Lang::En).is_good());
//! ```

pub mod diagnostics;
pub mod failure;
pub mod interrupt;
pub mod json;
pub mod line_ends;
pub mod mistyped;
pub mod output;
pub mod params;
pub mod place;
pub mod profiles;
pub mod program;
pub mod replace;
pub mod source;
pub mod state;
pub mod tools;
pub mod values;
pub mod words;

pub use leadscrew_wording::number;
