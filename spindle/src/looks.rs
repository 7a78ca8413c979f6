//! The gains of an observer that looks at its encoder where the counter moves.
//!
//! An encoder of few counts moves in few ticks. The ticks between tell nothing new, and an observer that takes the same
//! edge again and again believes it too much: it swings. So the observer is corrected in the ticks in which the counter
//! has moved, by the gains of a tracker whose samples are as far apart as the last two looks: all poles lie at
//! `θ = exp(−p·n·T)` for `n` ticks. The bandwidth is at most a twelfth of the looks a second, or a fortieth where only the
//! tick of an edge is known.

use fixed::types::{I16F48, I32F32, U32F32};

/// The shares of the difference between the measured and the predicted angle that an observer adds to angle, speed and
/// acceleration (turns, turns per tick, turns per tick²).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gains {
    /// Of the angle.
    pub alpha: I32F32,
    /// Of the speed.
    pub beta: I32F32,
    /// Of the acceleration: a cube, which for a slow pole has nothing left in 2⁻³².
    pub gamma: I16F48,
}

impl Gains {
    /// The gains of an observer with all poles at `theta`, whose samples are a tick apart.
    #[must_use]
    pub const fn of_theta(theta: U32F32) -> Self {
        // The cube of one would not fit.
        const BELOW_ONE: U32F32 = U32F32::from_bits(0xFFFF_FFFF);
        let rest = U32F32::ONE.wrapping_sub(theta);
        let rest = if rest.to_bits() > BELOW_ONE.to_bits() {
            BELOW_ONE
        } else {
            rest
        };
        let square = rest.wrapping_mul(rest);
        let cube = theta.wrapping_mul(theta).wrapping_mul(theta);
        let beta = square.wrapping_mul(U32F32::ONE.wrapping_add(theta));
        let half = U32F32::from_bits(beta.to_bits() >> 1);
        let gamma = square.to_bits().wrapping_mul(rest.to_bits()) >> 16;
        Self {
            alpha: signed(U32F32::ONE.wrapping_sub(cube)),
            beta: signed(beta.wrapping_add(half)),
            gamma: I16F48::from_bits(gamma as i64),
        }
    }

    /// What a surprise, below half a turn, adds to the acceleration, rounded.
    #[inline(always)]
    #[must_use]
    pub const fn of_acceleration(self, surprise: I32F32) -> I16F48 {
        let (gamma, surprise) = (self.gamma.to_bits(), surprise.to_bits());
        let below = (gamma & 0xFFFF).wrapping_mul(surprise) >> 16;
        let sum = (gamma >> 16).wrapping_mul(surprise).wrapping_add(below);
        I16F48::from_bits(sum.wrapping_add(1 << 15) >> 16)
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
    let gamma = per_tick(per_tick(gamma.to_bits() as u64, part), part);
    Gains {
        alpha,
        beta: I32F32::from_bits(per_tick(beta.to_bits() as u64, part) as i64),
        gamma: I16F48::from_bits(gamma as i64),
    }
}

/// A value times a part (2⁻³²).
#[inline(always)]
const fn per_tick(value: u64, part: u64) -> u64 {
    let below = (value & 0xFFFF_FFFF).wrapping_mul(part) >> 32;
    (value >> 32).wrapping_mul(part).wrapping_add(below)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_are_nothing_where_the_poles_stand_and_all_where_they_are_fastest() {
        let gains = Gains::of_theta(U32F32::ONE);
        let bits = [
            gains.alpha.to_bits(),
            gains.beta.to_bits(),
            gains.gamma.to_bits(),
        ];
        assert_eq!(bits, [0; 3]);
        // The first look of an encoder that has stood.
        assert_eq!(super::gains(0, 5, true), gains);
        let Gains { alpha, beta, gamma } = Gains::of_theta(U32F32::ZERO);
        assert_eq!(alpha, I32F32::ONE);
        assert!((beta.to_num::<f64>() - 1.5).abs() < 1e-8);
        assert!((gamma.to_num::<f64>() - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_gains_of_slow_poles_are_those_of_three_equal_poles() {
        for (pole, ticks) in [
            (0.000_6, 1_u32),
            (0.001, 1),
            (0.001, 7),
            (0.02, 3),
            (0.05, 1),
        ] {
            let pole = (pole * 2_f64.powi(32)) as u32;
            let told = super::gains(pole, ticks, true);
            let (p, n) = (
                f64::from(pole) * f64::from(ticks) / 2_f64.powi(32),
                f64::from(ticks),
            );
            let theta = (-p).exp();
            let is = |told: f64, wanted: f64, within: f64| {
                assert!(
                    (told / wanted - 1.0).abs() < within,
                    "{pole} {ticks}: {told} {wanted}"
                );
            };
            is(told.alpha.to_num(), 1.0 - theta.powi(3), 1e-3);
            is(
                told.beta.to_num(),
                1.5 * (1.0 - theta).powi(2) * (1.0 + theta) / n,
                1e-3,
            );
            is(told.gamma.to_num(), (1.0 - theta).powi(3) / (n * n), 1e-3);
            // A surprise of a thousandth of a turn.
            let surprise = I32F32::from_bits(1 << 22);
            let by = told.of_acceleration(surprise).to_num::<f64>();
            assert!((by - told.gamma.to_num::<f64>() / 1024.0).abs() < 3e-15);
        }
    }
}
