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
//! The part that all board images share: the two sides of a board (tick and background) and the queues between them.
//!
//! An image owns the hardware and this crate's two sides. It calls [`TickSide::tick`] in a timer interrupt, once a SYNC
//! period, and [`BackgroundSide::step`] in a loop. It implements [`TickMachine`] and [`Machine`] for its hardware. This
//! crate knows no chip and no pin. `leadscrew-core` decides what a board does; the simulated board uses the same two
//! halves.
//!
//! # Priorities
//!
//! | level | context | runs | may be delayed by |
//! |---|---|---|---|
//! | 0 (highest) | timer interrupt | [`TickSide::tick`]: sample, tick, SYNC and setpoints | nothing |
//! | 1 | bus and encoder interrupts | frames into and out of rings; time of the last encoder edge, index | the tick |
//! | 2 and below | everything else of the image | log output, storage | the above |
//! | thread | main | [`BackgroundSide::step`] until there is nothing to do, then sleep | all interrupts |
//!
//! A fault is above all of them: it stops the tick for good, writes its record down and resets.
//!
//! # All shared data
//!
//! | datum | from | to | where the queue is full |
//! |---|---|---|---|
//! | orders: commands, inputs, answers of the storage, signs of life | background | tick | wait in the background |
//! | segments, detours | background | tick | wait in the background |
//! | events | tick | background | the newest is lost |
//! | entries of the tap journal | tick | background | waits in the tick; only the newest counts |
//! | notices: begin anew, plan a way | tick | background | waits in the tick; only the newest counts |
//! | frames that are not a drive's | tick | background | the newest is lost, as on a flooded bus |
//! | reports: the tick side after each tick | tick | background | this report is lost; the next counts its periods too |
//! | the [`Ticker`](leadscrew_core::board::Ticker), made anew with other parameters | either | the other | never full |
//!
//! All of them are queues with one producer and one consumer ([`Queues`]). Neither side takes a lock, and the tick
//! never waits. Nothing else is shared. The parameter set belongs to the background; the ticker keeps the values that
//! the tick needs.

mod background;
mod failure;
mod left;
mod queues;
mod report;
mod reset;
mod serial;
mod tick;

pub use background::{BackgroundSide, Machine};
pub use failure::{Failure, FailureKind, VERSION};
pub use left::Left;
pub use queues::{BackgroundPlace, PowerUp, Queues, TickPlace, TickerPlace};
pub use report::{Order, Report};
pub use reset::{ResetCause, ResetFlags};
pub use serial::serial_of;
pub use tick::{Inputs, TickMachine, TickSide};
