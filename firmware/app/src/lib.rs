#![no_std]
#![forbid(unsafe_code)]
#![deny(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_arithmetic
)]
#![cfg_attr(
    test,
    allow(
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::unwrap_used,
        clippy::expect_used
    )
)]
//! The part that all board images share: how the two sides of a board (tick and background) meet the hardware, how a board
//! comes up, and the memory of a failure.
//!
//! `leadscrew-core` has the two sides and the queues between them, and decides what a board does. An image owns the
//! hardware and the two sides: it calls [`tick`](tick()) in a timer interrupt, once a SYNC period, and [`step`] in a loop.
//! It implements [`TickMachine`] and [`Machine`] for its hardware. This crate knows no chip and no pin.
//!
//! # Priorities
//!
//! | level | context | runs | may be delayed by |
//! |---|---|---|---|
//! | 0 (highest) | timer interrupt | [`tick`](tick()): sample, tick, SYNC and setpoints | nothing |
//! | 1 | bus and encoder interrupts | frames into and out of rings; time of the last encoder edge, index | the tick |
//! | 2 and below | everything else of the image | log output, storage | the above |
//! | thread | main | [`step`] until there is nothing to do, then sleep | all interrupts |
//!
//! A fault is above all of them: it stops the tick for good, writes its record down and resets.
//!
//! # All shared data
//!
//! The sides share the queues of [`Queues`](leadscrew_core::board::Queues), whose module has a table of them, and nothing
//! else. The parameter set belongs to the background; the tick keeps the values that it needs.

mod background;
mod failure;
mod left;
mod power_up;
mod reset;
mod serial;
mod tick;

pub use background::{Machine, step};
pub use failure::{Failure, FailureKind, VERSION};
pub use left::Left;
pub use power_up::{Memory, PowerUp, Sides};
pub use reset::{ResetCause, ResetFlags};
pub use serial::serial_of;
pub use tick::{TickMachine, tick};
