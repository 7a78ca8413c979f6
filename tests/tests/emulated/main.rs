//! The board on the emulated Cortex-M4F, driven as any board by `leadscrew`, over its serial line and over an interface
//! of the kernel behind it: the same setpoints as in simulation, the same answers to an operator.
//!
//! `cargo xtask emulated` builds the image, says in `LEADSCREW_IMAGE` where it is (in `LEADSCREW_IMAGE_DEFMT` the one with
//! messages), and runs these tests.

mod board;
mod desk;
mod failure;
mod hour;
mod kernel;
mod messages;
mod operate;
mod params;
mod restart;
mod run;
