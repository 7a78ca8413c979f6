//! The time that moves take.

use core::time::Duration;

use super::pass::Gather;
use crate::alarm::Alarm;
use crate::call::{ChainPart, Position, TapMode};
use crate::motion::{Limits, ThreadPlan, float_ticks, plan, stroke, turns_over};
use crate::moves::{Move, MoveKind};
use crate::params::Params;
use crate::units::{TurnRate, mul_div};

/// Ticks in which nothing moves: a finished pass stands for two ticks, and a waiting pass waits for at least one.
const BETWEEN_PASSES: u64 = 3;

/// In 2⁻³² turns.
const HALF_TURN: u64 = 1 << 31;

/// The time of `moves` at full override. The first move begins at `from`. The time is exact for moves driven by time. A
/// thread counts its turns at the commanded speed and the wait for its start angle; the first pass waits half a turn,
/// the wait of each later pass follows from the pass before. An ordinary tap counts the ramps for which its spindle is
/// planned. A change of spindle speed and machine functions count as zero.
///
/// # Errors
/// The errors of the planner.
pub(crate) fn time_of_each(
    moves: impl Iterator<Item = Move>,
    from: Position,
    params: &Params,
) -> Result<Duration, Alarm> {
    let limits = Limits::from_params(params);
    let tick = u64::from(limits.tick_us());
    let mut gather = Gather::new();
    let mut at = from;
    let mut micros = 0_u64;
    // The spindle's angle at the end of the last pass, and the time of that end.
    let mut spindle = None;
    for next in moves {
        let more = match next.kind {
            // Its turns; joining and braking are small beside them, and the wait is that of the first stroke.
            MoveKind::Thread(thread) if thread.part != ChainPart::Whole => {
                let way = if thread.long_x {
                    next.to.x - at.x
                } else {
                    next.to.z - at.z
                };
                let speed = TurnRate::of_rpm(thread.rpm).abs().raw().unsigned_abs();
                let turns = turns_over(thread.lead, way.abs()).raw().unsigned_abs();
                let wait = match thread.part {
                    ChainPart::First => HALF_TURN,
                    _ => 0,
                };
                mul_div(turns.saturating_add(wait), 1_000_000, speed)
            }
            MoveKind::Thread(thread) => match gather.take(at, &next) {
                Some(pass) => {
                    let plan = ThreadPlan::new(pass.from, &pass.moves, params, TurnRate::ZERO)?;
                    let speed = TurnRate::of_rpm(thread.rpm).abs().raw().unsigned_abs();
                    let begins = micros.saturating_add(tick.saturating_mul(BETWEEN_PASSES));
                    let wait = match spindle {
                        None => HALF_TURN,
                        Some((angle, since)) => {
                            let turned = mul_div(speed, begins.saturating_sub(since), 1_000_000);
                            let left = (plan.leaves_at() - angle).raw().wrapping_sub(turned as i64);
                            u64::from(left as u32)
                        }
                    };
                    let turns = plan.turns().raw().unsigned_abs().saturating_add(wait);
                    let over = begins.saturating_add(mul_div(turns, 1_000_000, speed));
                    spindle = Some((plan.leaves_at() + plan.turns(), over));
                    // The short axis makes up its lag at the run-out in a separate rapid move.
                    let rest = Move {
                        kind: MoveKind::Rapid,
                        ..next
                    };
                    let rest = plan::timed(plan.end(), &rest, &limits)?
                        .map_or(0, |timed| timed.duration_ticks().saturating_mul(tick));
                    over.saturating_add(rest).saturating_sub(micros)
                }
                None => 0,
            },
            MoveKind::Tap(tap) => {
                let travel = tap.axis.of(next.to) - tap.axis.of(at);
                let ticks = match tap.mode {
                    TapMode::Rigid => {
                        stroke(&tap, travel, params, &limits, next.span)?.duration_ticks()
                    }
                    TapMode::Floating => float_ticks(&tap, travel, params),
                };
                ticks.saturating_mul(tick)
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
