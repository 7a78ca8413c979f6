#![forbid(unsafe_code)]
//! A simulated machine that stays while commands come and go: what `leadscrew up` keeps running.
//!
//! ```text
//! clients ◄─ SLCAN lines ─► bus ◄─ frames ─► machine (board, drives, spindle, flash)
//!                            │                  ▲ pins, power
//! leadscrew sim ◄─ JSON ─► server ── clock ─────┘ ticks
//! ```
//!
//! One thread does all of it, so that all clients and the board see the frames in one order ([`server`]). `bus` is the
//! wire, [`machine`] the board with what is around it, [`clock`] says how many ticks are due. [`control`] is the language
//! of `leadscrew sim`, [`callers`] are those who speak it, and [`hand`] carries it out: here, and in `board-sim`. The board
//! is the one of `leadscrew_core`; it joins this bus as it does a real one.
//!
//! It must not know commands of `leadscrew`, nor how motion works inside the board.
//!
//! ```
//! use std::time::{Duration, Instant};
//!
//! use leadscrew_desk::clock::Clock;
//!
//! let start = Instant::now();
//! let mut clock = Clock::new(Duration::from_millis(1), start);
//! assert_eq!(clock.due(start + Duration::from_millis(5)), 5);
//! ```

pub mod bus;
pub mod callers;
pub mod clock;
pub mod control;
pub mod hand;
pub mod machine;
pub mod server;
mod spoilt;
