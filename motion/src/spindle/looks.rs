//! The gains of an observer whose encoder has few counts.
//!
//! Such an encoder moves in few ticks. In the ticks between, its last edge tells the same again, and an observer that is
//! quick believes it too much: it swings, and loses the spindle. So its bandwidth is at most an eighth of the edges a
//! second, or a twentieth where edges are not timed: with these an observer is known to hold [D208]. Where edges come
//! often enough for its own bandwidth, nothing changes.

use fixed::types::U32F32;

use super::observer::Gains;

/// Encoders of fewer counts a turn. With as many, a spindle of 60 rpm moves the counter in each tick of a millisecond.
pub(super) const FEW: u32 = 1000;

/// The greatest angle of the poles from edge to edge, 2⁻³²: 2π/8 where edges are timed, 2π/20 where they are not.
const TIMED: u32 = 3_373_259_426;
const UNTIMED: u32 = 1_349_303_771;

/// The gains of a tick where edges are `apart` (ticks) and the poles turn by at most `pole` (2⁻³²) in a tick.
pub(super) fn gains(pole: u32, apart: u32, is_timed: bool) -> Gains {
    let most = if is_timed { TIMED } else { UNTIMED };
    let most = most.checked_div(apart).unwrap_or(most);
    Gains::of_theta(exp_of_minus(pole.min(most)))
}

/// exp(−x) for x below 0.8 (2⁻³²), within 4·10⁻⁴: its series up to the fifth power. The one for all x divides 64 bits,
/// which the tick does not.
const fn exp_of_minus(x: u32) -> U32F32 {
    const ONE: u64 = 1 << 32;
    let x = x as u64;
    // 1 − x·(1 − x/2·(1 − x/3·(1 − x/4·(1 − x/5)))), quotients by reciprocals in 2⁻³².
    let mut sum = ONE.wrapping_sub(x.wrapping_mul(858_993_459) >> 32);
    sum = ONE.wrapping_sub(x.wrapping_mul(sum) >> 34);
    sum = ONE.wrapping_sub((x.wrapping_mul(sum) >> 32).wrapping_mul(1_431_655_765) >> 32);
    sum = ONE.wrapping_sub(x.wrapping_mul(sum) >> 33);
    U32F32::from_bits(ONE.wrapping_sub(x.wrapping_mul(sum) >> 32))
}
