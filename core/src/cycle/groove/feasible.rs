//! Grooves on the machine: travel by the extremes of the repeated moves, time by one of each kind, and a warning for the
//! programmer.

use core::time::Duration;

use super::moves::GrooveMoves;
use crate::alarm::{Alarm, Arg, Code};
use crate::call::{GrooveCall, TapAxis};
use crate::feasible::inside;
use crate::motion::{Limits, plan};
use crate::params::Params;
use crate::units::{Axis, Length};

/// Gives the same result as [`each_within_limits`](crate::feasible::each_within_limits), but without making the moves. All
/// infeeds go one way, and so do all columns. So only these positions can be the first to leave the travel: the first
/// infeed, the retract from the first infeed, the first infeed or the first column beyond a limit, the relief of the
/// first column, and the start level.
pub(crate) fn groove_within_limits(groove: &GrooveMoves, params: &Params) -> Result<(), Alarm> {
    let (call, span) = (groove.call(), groove.span());
    let (level, column) = (call.level(), call.first());
    let axis = |axis| match axis {
        TapAxis::X => Axis::X,
        TapAxis::Z => Axis::Z,
    };
    let to = |depth, column| inside(call.place(depth, column), span, params);
    // The limit in the direction of a way.
    let ahead = |axis, way: Length| {
        Length::from_nm(if way > Length::ZERO {
            params.soft_limit_plus(axis)
        } else {
            params.soft_limit_minus(axis)
        })
    };
    let first = groove.infeed_end(1);
    to(first, column)?;
    if groove.totals().infeeds > 1 {
        to(groove.retract_end(first), column)?;
    }
    let limit = ahead(axis(call.axis), call.bottom().value - level);
    let beyond = groove.infeed_beyond(limit);
    to(groove.infeed_end(beyond), column)?;
    let aside = groove.relief_end(column);
    to(call.bottom().value, aside)?;
    to(level, aside)?;
    let limit = ahead(axis(call.axis.other()), call.last().value - column);
    let beyond = groove.column_beyond(limit);
    to(level, groove.column_at(beyond))
}

/// The time of a groove at full override: each kind of move planned once.
///
/// # Errors
/// The errors of the planner.
pub(crate) fn groove_time(groove: &GrooveMoves, params: &Params) -> Result<Duration, Alarm> {
    let limits = Limits::from_params(params);
    let tick = u64::from(limits.tick_us());
    let mut ticks = 0_u64;
    groove.tally(&mut |from, step, times| {
        let timed = plan::timed(*from, step, &limits)?;
        let each = timed.map_or(0, |timed| timed.duration_ticks());
        ticks = ticks.saturating_add(each.saturating_mul(times));
        Ok(())
    })?;
    Ok(Duration::from_micros(ticks.saturating_mul(tick)))
}

/// The warning for a groove whose retract goes back further than an infeed. Nothing breaks, but time is lost. Usually
/// the programmer meant another P.
#[must_use]
pub fn groove_warning(call: &GrooveCall) -> Option<Alarm> {
    let (peck, retract) = (call.peck?, call.retract.value);
    let pecks = (call.bottom().value - call.level()).abs() > peck.value;
    (pecks && retract > peck.value).then(|| {
        let [_, letter, _] = GrooveCall::letters(call.axis);
        Alarm::new(Code::GrooveRetractLong, peck.span)
            .word(letter)
            .with([Arg::Length(peck.value), Arg::Length(retract)])
    })
}
