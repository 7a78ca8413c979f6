//! What the machine can do, whatever the cycle: travel of the axes, zones, encoder, time.
//!
//! This is arithmetic on moves, without state; the same planner counts here and on the board, so both see the same
//! numbers. A [`cycle`](crate::cycle) asks these functions about its own moves. The module knows no cycle, no bus and no
//! board.

mod encoder;
mod limits;
mod pass;
mod time;
mod way;
mod zones;

pub(crate) use encoder::{OnLead, can_tap, can_thread};
pub(crate) use limits::{each_within_limits, inside};
pub(crate) use pass::{Gather, Pass};
pub(crate) use time::time_of_each;
pub(crate) use way::Way;
pub use zones::Forbidden;
pub(crate) use zones::each_clear_of_zones;
