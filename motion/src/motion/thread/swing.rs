//! What a spindle that swings takes of the axes' limits.
//!
//! Where the spindle's angle is learned, the axes go after it by a [`Follower`](crate::spindle::Follower), which may
//! accelerate by `A_h` and jerk by `J_h` along the helix. These are shares of the long axis' limits. On the helix
//! `q(t)` an axis that joins, brakes or rounds a corner with the ease `w(q)`, made for the speed `v` and the
//! acceleration `a`, has `w″·q′² + w′·q″`, at most `a + A_h`, and the jerk `w‴·q′³ + 3·w″·q′·q″ + w′·q‴`, at most `j +
//! 3·a·A_h/v + J_h`. So `a` and `j` are what these leave: half of the rest of the jerk for each of the first two
//! terms.

use super::ramp::{DIAGONAL, Machine, seen};
use super::shape::Shape;
use crate::motion::ease::Bounds;
use crate::params::Params;
use crate::spindle::Limits;
use crate::units::{TurnRate, mul_div, signed};

/// The follower's share of the acceleration: a spindle that swings by 10 % at 5 Hz asks a third of it at 30 mm/s, where the
/// axis has 3 m/s².
const ACCELERATION: u64 = 10;

/// The follower's share of the jerk: a spindle that swings by 5 % at 16 Hz asks all of it at 30 mm/s, where the axis has
/// 60 m/s³.
const JERK: u64 = 3;

/// What is left of the limits beside a follower.
#[inline(never)]
pub(super) fn beside_follower(machine: &mut Machine, shape: &Shape) {
    let acceleration = machine.long.acceleration / ACCELERATION;
    let jerk = machine.long.jerk / JERK;
    let speed = machine.speed;
    machine.long = left(&machine.long, speed, [acceleration, jerk]);
    let steepest = shape.taper.unsigned_abs().saturating_add(DIAGONAL);
    let along = [acceleration, jerk].map(|part| seen(part, steepest));
    machine.short = left(&machine.short, speed, along);
}

/// What is left of `bounds` beside an acceleration and a jerk of a follower, at `speed`.
#[inline(never)]
fn left(bounds: &Bounds, speed: u64, [acceleration, jerk]: [u64; 2]) -> Bounds {
    let rest = bounds.jerk.saturating_sub(jerk);
    let own = bounds.acceleration.saturating_sub(acceleration);
    let shared = mul_div(rest, speed, acceleration.saturating_mul(6).max(1));
    Bounds {
        acceleration: own.min(shared).max(1),
        jerk: (rest >> 1).max(1),
    }
}

/// The limits of a follower on the helix of a pass, where the spindle turns with `limit`: an axis with these bounds moves
/// with `speed` (nm/s) there, and along the helix with `helix`. The error that is allowed (9035) is one along the helix.
#[inline(never)]
pub(super) fn limits(
    params: &Params,
    bounds: &Bounds,
    [speed, helix]: [u64; 2],
    limit: TurnRate,
) -> Limits {
    let Bounds { acceleration, jerk } = *bounds;
    let (acceleration, jerk) = (acceleration / ACCELERATION, jerk / JERK);
    let tick = u64::from(params.tick_us());
    // Turns per tick in 2⁻⁴⁸, from turns per second in 2⁻³².
    let turn = mul_div((limit.raw() as u64) << 16, tick, 1_000_000);
    // The same for what is nanometres per second where `speed` is.
    let each = speed.saturating_mul(1_000_000);
    let acceleration = mul_div(turn, acceleration.saturating_mul(tick), each);
    let jerk = mul_div(
        mul_div(turn, jerk.saturating_mul(tick), each),
        tick,
        1_000_000,
    );
    let beside = params.encoder_error().nm() as u64;
    let beside = mul_div(
        turn,
        beside.saturating_mul(1_000_000),
        helix.saturating_mul(tick),
    );
    // The follower has its whole acceleration up to the speed of the plan.
    let above = mul_div(acceleration, acceleration, jerk.max(1));
    Limits {
        speed: signed(turn.saturating_add(above)),
        acceleration: signed(acceleration),
        jerk: signed(jerk.max(1)),
        beside: signed(beside),
    }
}
