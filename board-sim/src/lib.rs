#![no_std]
#![forbid(unsafe_code)]
//! A machine that is not there: the plant around a board, for tests, for `--bus sim` and for emulated firmware.
//!
//! Integers only and no allocation, so that the same plant gives the same bits wherever it runs. It knows the board only
//! by its frames.

pub mod line;
pub mod plant;
mod sim;
mod storage;

pub use sim::{Direction, Doing, Row, Sim, SimError, SpindleAngle, TapPoint};
pub use storage::{keep, stored_params, stored_tap};
