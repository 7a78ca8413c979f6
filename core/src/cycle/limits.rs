//! Travel, zones and time of the moves of a call. A groove counts its moves instead of making them.

use core::time::Duration;

use super::Moves;
use super::groove::{groove_clear_of_zones, groove_time, groove_within_limits};
use crate::alarm::Alarm;
use crate::call::Position;
use crate::feasible::{Forbidden, each_clear_of_zones, each_within_limits, time_of_each};
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

/// Checks that no move of `moves` leads the tip of the tool into a zone, anywhere on its way. The first move begins at
/// `from`. The check of a groove takes the same time for any number of columns and infeeds.
///
/// # Errors
/// [`Code::ZoneEntered`](crate::alarm::Code::ZoneEntered) with the zone, the axis in which the way goes less far into it,
/// and how far; [`Code::TipUnknown`](crate::alarm::Code::TipUnknown) where zones are set and the tool was not measured.
pub fn clear_of_zones(moves: &Moves, from: Position, forbidden: &Forbidden) -> Result<(), Alarm> {
    if forbidden.zones.are_off() {
        return Ok(());
    }
    match moves {
        Moves::Groove(groove) => groove_clear_of_zones(groove, forbidden),
        _ => each_clear_of_zones(*moves, from, forbidden),
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
