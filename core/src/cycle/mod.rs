//! Calls in, moves out: each cycle turns its words into single moves.
//!
//! Each family of cycles has a file with a lazy iterator of [`Move`]s in constant memory. [`expand`] makes all of these
//! iterators. A call with an impossible geometry is refused before the first move. Knows nothing of program text, motion
//! or the bus.

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
