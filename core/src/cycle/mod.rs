//! The cycles: a room for each family.
//!
//! A room has all that a cycle is: how its words are read, what its geometry forbids, its moves, and what the machine
//! cannot do. Only its call type is elsewhere ([`call`](crate::call)), since the board gets that. The interpreter hands a
//! block to its room and gets a call; [`expand`] gives a call to its room and gets a lazy iterator of
//! [moves](crate::moves) in constant memory. Nothing in a room is known to another.
//!
//! It must not know program flow, the bus or the board.

mod check;
mod context;
mod expand;
mod groove;
mod limits;
mod tap;
#[cfg(test)]
mod tests;
mod thread;
mod turning;

pub use crate::feasible::Forbidden;
pub use context::Context;
pub use expand::{Moves, expand};
pub use groove::{GrooveCount, GrooveMoves, groove_warning};
pub use limits::{clear_of_zones, time, within_limits};
pub use tap::{TapJoin, TapMoves, TapReport, tap_report, tap_return, tap_spindle};
pub use thread::{
    FINDINGS, ThreadFindings, ThreadMoves, ThreadReport, ThreadSummary, chain_report,
    chain_rpm_max, rpm_max, thread_can_run, thread_findings, thread_report,
};

pub(crate) use groove::GrooveWords;
pub(crate) use tap::{
    TapPart, Tapping, is_tap_return, orientation, rigid_code, tap_can_begin, tap_strokes,
};
pub(crate) use thread::{Stroked, ThreadWords, TwoBlock};
pub(crate) use turning::{Turning, TurningWords};
