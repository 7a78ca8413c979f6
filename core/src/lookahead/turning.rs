//! What a corner allows, and the ramp that joined cuts may have.
//!
//! Rates are in 1/256 nm per tick, ways in 1/256 nm, turns in 2⁻³⁰. This module knows figures of one corner or one cut. It
//! knows nothing of the window.

use crate::motion::Corner;
use crate::motion::PathRate;
use crate::motion::Ramp;
use crate::units::{mul_div, root};

/// Binary digits of a turn.
pub(super) const TURN_BITS: u32 = 30;

/// The largest rate at which the direction may turn by `turn`.
pub(super) fn allowed(corner: &Corner, turn: u64) -> u64 {
    corner
        .turning
        .saturating_mul(1 << TURN_BITS)
        .checked_div(turn)
        .unwrap_or(u64::MAX)
}

/// How far an arc of this radius turns in a mean, at a rate of at most `top`; `length`: its way.
pub(super) fn turn_of_arc(length: u64, top: u64, radius: u64, corner: &Corner) -> u64 {
    let way = length.min(top.saturating_mul(window(corner)));
    mul_div(way, 1 << (TURN_BITS - 8), radius)
}

/// The ticks of a mean, in which all turns are counted together.
pub(super) fn window(corner: &Corner) -> u64 {
    u64::from(corner.mean.ticks())
}

/// The rate at which a way takes so many ticks.
pub(super) const fn per(way: u64, ticks: u64) -> u64 {
    match way.checked_div(ticks) {
        Some(rate) => rate,
        None => u64::MAX,
    }
}

/// The shortest ramp to `cap` whose input may change in any way.
pub(super) fn ramp(cap: u64, corner: &Corner) -> Option<Ramp> {
    let figure = |limit: u64| limit.max(1);
    // cap / n1 is the acceleration, 2 · cap / (n1·n2) the jerk; limits are in 2⁻³² nm.
    let area = (cap << 25).div_ceil(figure(corner.along.jerk));
    let n1 = root(area)
        .saturating_add(1)
        .max((cap << 24).div_ceil(figure(corner.along.acceleration)))
        .max(corner.least_ramp)
        .max(1);
    let n2 = area.div_ceil(n1).max(1);
    let cap = PathRate::from_raw(u32::try_from(cap).ok()?);
    Ramp::new(cap, u16::try_from(n1).ok()?, u16::try_from(n2).ok()?)
}
