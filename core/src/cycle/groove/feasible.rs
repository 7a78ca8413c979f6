//! Grooves on the machine: travel and zones by the extremes of the repeated moves, time by one of each kind, and a
//! warning for the programmer.

use core::time::Duration;

use super::moves::GrooveMoves;
use crate::alarm::{Alarm, Arg, Code};
use crate::call::{GrooveCall, TapAxis};
use crate::feasible::{Forbidden, Way, inside};
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

/// Gives the same result as [`each_clear_of_zones`](crate::feasible::each_clear_of_zones), but without making the moves.
/// All columns are alike, so of those that reach a zone the first one counts: by itself, or by its relief.
pub(crate) fn groove_clear_of_zones(
    groove: &GrooveMoves,
    forbidden: &Forbidden,
) -> Result<(), Alarm> {
    let (call, span) = (groove.call(), groove.span());
    let (level, bottom) = (call.level(), call.bottom().value);
    let (first, last) = (call.first(), call.last().value);
    let way = |[from, to]: [(Length, Length); 2]| {
        let [from, to] = [from, to].map(|(depth, column)| call.place(depth, column));
        forbidden.way(from, to, &Way::Line, Length::ZERO, span)
    };
    let relief = groove.relief_end(first) - first;
    way([(level, first + relief), (level, first)])?;
    way([(level, first + relief), (level, last)])?;
    for zone in forbidden.extents(axis(call.axis.other())) {
        for aside in [Length::ZERO, relief] {
            let number = if last >= first {
                let border = zone.low - aside;
                let before = border - Length::from_nm(1);
                if first < border {
                    groove.column_beyond(before)
                } else {
                    0
                }
            } else {
                let border = zone.high - aside;
                let before = border + Length::from_nm(1);
                if first > border {
                    groove.column_beyond(before)
                } else {
                    0
                }
            };
            let column = groove.column_at(number);
            way([(level, column), (bottom, column)])?;
            way([(bottom, column), (bottom, column + relief)])?;
            way([(bottom, column + relief), (level, column + relief)])?;
        }
    }
    Ok(())
}

const fn axis(axis: TapAxis) -> Axis {
    match axis {
        TapAxis::X => Axis::X,
        TapAxis::Z => Axis::Z,
    }
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
