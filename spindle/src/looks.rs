//! The gains of an observer that looks at its encoder where the counter moves.
//!
//! An encoder of few counts moves in few ticks. The ticks between tell nothing new, and an observer that takes the same
//! edge again and again believes it too much: it swings. So the observer is corrected in the ticks in which the counter
//! has moved, by the gains of a tracker whose samples are as far apart as the last two looks: all poles lie at
//! `θ = exp(−p·n·T)` for `n` ticks. The bandwidth is at most a twelfth of the looks a second, or a fortieth where only the
//! tick of an edge is known.

use fixed::types::{I32F32, U32F32};

/// The shares of the difference between the measured and the predicted angle that an observer adds to angle, speed and
/// acceleration (turns, turns per tick, turns per tick²).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gains {
    /// Of the angle.
    pub alpha: I32F32,
    /// Of the speed.
    pub beta: I32F32,
    /// Of the acceleration.
    pub gamma: I32F32,
}

impl Gains {
    /// The gains of an observer with all poles at `theta`, whose samples are a tick apart.
    #[must_use]
    pub const fn of_theta(theta: U32F32) -> Self {
        let rest = U32F32::ONE.wrapping_sub(theta);
        let square = rest.wrapping_mul(rest);
        let cube = theta.wrapping_mul(theta).wrapping_mul(theta);
        let beta = square.wrapping_mul(U32F32::ONE.wrapping_add(theta));
        let half = U32F32::from_bits(beta.to_bits() >> 1);
        Self {
            alpha: signed(U32F32::ONE.wrapping_sub(cube)),
            beta: signed(beta.wrapping_add(half)),
            gamma: signed(square.wrapping_mul(rest)),
        }
    }
}

/// What is below 2³¹.
const fn signed(value: U32F32) -> I32F32 {
    I32F32::from_bits(value.to_bits() as i64)
}

/// An angle of 2π, 2⁻²⁸.
pub(crate) const TWO_PI: u64 = 1_686_629_713;

/// The greatest angle of the poles between two looks, 2⁻³²: 2π/12 where edges are timed, 2π/40 where they are not.
const TIMED: u32 = 2_248_839_617;
const UNTIMED: u32 = 674_651_885;

/// Ticks between two looks beyond which nothing changes any more.
pub(crate) const LONGEST: u32 = 1 << 14;

/// The gains of a look that comes `ticks` after the one before, where the poles turn by `pole` (2⁻³²) in a tick.
pub(crate) fn gains(pole: u32, ticks: u32, is_timed: bool) -> Gains {
    let most = if is_timed { TIMED } else { UNTIMED };
    let angle = u64::from(pole)
        .wrapping_mul(u64::from(ticks))
        .min(u64::from(most));
    let Gains { alpha, beta, gamma } = Gains::of_theta(exp_of_minus(angle as u32));
    let part = u64::from(u32::MAX.checked_div(ticks).unwrap_or(u32::MAX));
    // No gain is negative.
    let per_tick = |value: I32F32| {
        let bits = (value.to_bits() as u64).wrapping_mul(part) >> 32;
        I32F32::from_bits(bits as i64)
    };
    Gains {
        alpha,
        beta: per_tick(beta),
        gamma: per_tick(per_tick(gamma)),
    }
}

/// The angle by which poles of `bandwidth` (Hz, up to 1000) turn in a tick of `tick_us` (up to 10 000), 2⁻³²; at most 1.
pub(crate) const fn pole(bandwidth: u32, tick_us: u32) -> u32 {
    let cycles = (bandwidth as u64).wrapping_mul(tick_us as u64);
    let angle = (TWO_PI.wrapping_mul(cycles) / 1_000_000) << 4;
    if angle > u32::MAX as u64 {
        u32::MAX
    } else {
        angle as u32
    }
}

/// exp(−x) for x below 0.8 (2⁻³²), within 4·10⁻⁴, and below 0.6 within 7·10⁻⁵: its series up to the fifth power, without a
/// division.
#[must_use]
pub const fn exp_of_minus(x: u32) -> U32F32 {
    const ONE: u64 = 1 << 32;
    let x = x as u64;
    // 1 − x·(1 − x/2·(1 − x/3·(1 − x/4·(1 − x/5)))), each quotient by its reciprocal in 2⁻³².
    let mut sum = ONE.wrapping_sub(x.wrapping_mul(858_993_459) >> 32);
    sum = ONE.wrapping_sub(x.wrapping_mul(sum) >> 34);
    sum = ONE.wrapping_sub((x.wrapping_mul(sum) >> 32).wrapping_mul(1_431_655_765) >> 32);
    sum = ONE.wrapping_sub(x.wrapping_mul(sum) >> 33);
    U32F32::from_bits(ONE.wrapping_sub(x.wrapping_mul(sum) >> 32))
}
