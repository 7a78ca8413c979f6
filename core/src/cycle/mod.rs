//! Calls in, moves out: what each cycle does with its words, move by move.
//!
//! One file a family; each is a lazy iterator of [`Move`]s with constant memory, and [`expand`] is the door to all of
//! them. Refuses what geometry forbids before the first move. Knows nothing of program text, motion or the bus.

mod check;
mod depth;
mod expand;
mod groove;
mod groove_count;
mod helix;
mod moves;
mod refuse;
mod shape;
mod slope;
mod tap;
mod tap_return;
mod taper;
mod thread;

pub use expand::{Context, Moves, expand};
pub use groove::GrooveMoves;
pub use groove_count::GrooveCount;
pub use moves::*;
pub(crate) use refuse::refuse_tap;
pub use tap::TapMoves;
pub use thread::{ThreadMoves, ThreadSummary};
