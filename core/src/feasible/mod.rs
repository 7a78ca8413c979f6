//! Feasibility checks before anything moves: speeds, lead-in, run-out and travel limits of calls and moves.
//!
//! This is arithmetic on figures, without state. `cycle` has already decided what the geometry allows; here only the
//! limits of the machine count. The command line prints the reports. The board asks the same functions before it starts
//! a block, and plans with the same planner, so both see the same numbers. This module knows nothing of the bus or the
//! board.

mod encoder;
mod float;
mod groove;
mod limits;
mod pass;
mod tap;
#[cfg(test)]
mod tests;
mod thread;
mod time;

pub use float::TapJoin;
pub use groove::groove_warning;
pub use limits::within_limits;
pub use tap::{TapReport, tap, tap_return, tap_spindle};
pub(crate) use tap::{tap_can_begin, tap_strokes};
pub use thread::{
    FINDINGS, ThreadFindings, ThreadReport, rpm_max, thread, thread_can_run, thread_findings,
};
pub use time::time;
