//! Travel and time of the moves of a call. A groove counts its moves instead of making them.

use core::time::Duration;

use super::Moves;
use super::groove::{groove_time, groove_within_limits};
use crate::alarm::Alarm;
use crate::call::Position;
use crate::feasible::{each_within_limits, time_of_each};
use crate::params::Params;

/// Checks that no move of `moves` leaves the travel of an axis. The first move begins at `from`. The check of a groove
/// takes the same time for any number of columns and infeeds.
///
/// # Errors
/// [`Code::SoftLimit`](crate::alarm::Code::SoftLimit) with the axis, its target and its limit (machine coordinates).
pub fn within_limits(moves: &Moves, from: Position, params: &Params) -> Result<(), Alarm> {
    match moves {
        Moves::Groove(groove) => groove_within_limits(groove, params),
        _ => each_within_limits(*moves, from, params),
    }
}

/// The time of the moves of a call at full override. The first move begins at `from`. For a groove each kind of move is
/// planned only once, so the computation takes no longer for many columns and infeeds than for few.
///
/// # Errors
/// The errors of the planner.
pub fn time(moves: &Moves, from: Position, params: &Params) -> Result<Duration, Alarm> {
    match moves {
        Moves::Groove(groove) => groove_time(groove, params),
        _ => time_of_each(*moves, from, params),
    }
}
