//! Calls in, moves out: what each cycle does with its words, move by move.
//!
//! One file a family; each is a lazy iterator of [`Move`]s with constant memory. Refuses what geometry forbids before
//! the first move. Knows nothing of program text, motion or the bus.

mod moves;

pub use moves::*;
