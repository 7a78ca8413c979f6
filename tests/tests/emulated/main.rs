//! The board on the emulated Cortex-M4F, driven as any board by `leadscrew` over a serial line: the same setpoints as in
//! simulation, the same answers to an operator.
//!
//! `cargo xtask emulated` builds the image, says in `LEADSCREW_IMAGE` where it is, and runs these tests.

mod board;
mod failure;
mod operate;
mod run;
