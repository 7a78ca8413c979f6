#![no_std]
//! Lathe threading, grooving and tapping cycles: from program text to drive setpoints.
//!
//! # One way through
//!
//! ```text
//! program text ─► blocks ─► calls ─►│ moves ─► segments ─► setpoints ─► CAN frames ─► drives
//!     program/     program/  program/│  cycle/   motion/     motion/       bus/
//!               the side with the text │ the board
//! ```
//!
//! Data goes one way. Each arrow is one type, each type has one home, and each stage can be run, printed and tested
//! alone. [`program`] turns text into calls: blocks with all their modal meaning resolved, in machine units, with the
//! place they came from. [`cycle`] turns a call into moves, lazily and in constant memory.
//!
//! # House rules
//!
//! No allocation, no floating point, no `unsafe`, nothing that can panic, no clock. Time and input are arguments.
//! Quantities carry their unit in the type ([`units`]); operators on them saturate and inputs are bounded far below
//! that. What goes wrong is an [`alarm::Alarm`]: data, with its place in the text; words are put to it where a person
//! reads it.

pub mod alarm;
pub mod board;
pub mod bus;
pub mod cycle;
pub mod feasible;
pub mod motion;
pub mod params;
pub mod program;
pub mod spindle;
pub mod units;
