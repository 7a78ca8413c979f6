#![no_std]
#![forbid(unsafe_code)]
//! A simulated machine: the plant around a board, for tests, for `--bus sim` and for emulated firmware.
//!
//! The plant uses integers only and no allocation, so that the same plant gives the same bits on every computer. It
//! knows the board only by its frames.

mod around;
pub mod line;
pub mod plant;
mod sim;
mod storage;
mod turret;

pub use around::Around;
pub use sim::{CutPoint, Direction, Doing, Row, Sim, SimError, SpindleAngle, TapPoint};
pub use storage::{keep, stored_params, stored_tap};
pub use turret::TurretFault;
