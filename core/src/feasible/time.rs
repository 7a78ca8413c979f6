//! How long moves take.

use core::time::Duration;

use super::pass::Gather;
use crate::alarm::Alarm;
use crate::cycle::{Move, MoveKind};
use crate::motion::{Limits, ThreadPlan, plan, stroke};
use crate::params::Params;
use crate::program::Position;
use crate::units::{TurnRate, mul_div};

/// The time of `moves`, the first of which begins at `from`, at full override: exact for moves that time drives; a thread
/// counts its turns at the commanded speed and half a turn of waiting; a change of spindle speed and machine functions
/// count nothing.
///
/// # Errors
/// What the planner refuses.
pub fn time(
    moves: impl Iterator<Item = Move>,
    from: Position,
    params: &Params,
) -> Result<Duration, Alarm> {
    let limits = Limits::from_params(params);
    let tick = u64::from(limits.tick_us());
    let mut gather = Gather::default();
    let mut at = from;
    let mut micros = 0_u64;
    for next in moves {
        let more = match next.kind {
            MoveKind::Thread(thread) => match gather.take(at, next) {
                Some(pass) => {
                    let plan = ThreadPlan::new(pass.from, pass.moves(), params, TurnRate::ZERO)?;
                    let half_turn = 1 << 31;
                    let turns = plan.turns().raw().unsigned_abs().saturating_add(half_turn);
                    let speed = TurnRate::of_rpm(thread.rpm).abs().raw().unsigned_abs();
                    mul_div(turns, 1_000_000, speed)
                }
                None => 0,
            },
            MoveKind::Tap(tap) => {
                let travel = tap.axis.of(next.to) - tap.axis.of(at);
                stroke(&tap, travel, params, &limits, next.span)?
                    .duration_ticks()
                    .saturating_mul(tick)
            }
            MoveKind::Dwell(dwell) => u64::from(dwell.get()).saturating_mul(1000),
            _ => plan::timed(at, &next, &limits)?
                .map_or(0, |timed| timed.duration_ticks().saturating_mul(tick)),
        };
        micros = micros.saturating_add(more);
        at = next.to;
    }
    Ok(Duration::from_micros(micros))
}
