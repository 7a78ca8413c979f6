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
//! What every board image has in common: the two contexts of a board, taken apart, and what lies between them.
//!
//! An image owns the hardware and this crate's two sides. It calls [`TickSide::tick`] in a timer interrupt, once a SYNC
//! period, and [`BackgroundSide::step`] in a loop; [`TickMachine`] and [`Machine`] are what it brings. What a board does is
//! `leadscrew-core`'s; the simulated board is put together of the same halves.
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
//! # Every shared datum
//!
//! | datum | from | to | where it is full |
//! |---|---|---|---|
//! | orders: commands, inputs, answers of the storage, signs of life | background | tick | waits in the background |
//! | segments, detours | background | tick | waits in the background |
//! | events | tick | background | the newest is lost |
//! | entries of the tap journal | tick | background | waits in the tick; only the newest counts |
//! | notices: begin anew, plan a way | tick | background | waits in the tick; only the newest counts |
//! | frames that are not a drive's | tick | background | the newest is lost, as on a bus that is flooded |
//! | reports: the tick side after each tick | tick | background | that tick's is lost; the next says how many |
//! | the [`Ticker`](leadscrew_core::board::Ticker) itself, to be made anew with other parameters, and back | tick, background | background, tick | there is one |
//!
//! All of them are single-producer queues ([`Queues`]); neither side locks anything, and the tick never waits. Nothing
//! else is shared. The parameter set belongs to the background: the tick keeps what it needs of it in its ticker.

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
