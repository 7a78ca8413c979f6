//! The ease: a curve that leaves rest and joins a straight line, smooth to the second derivative.
//!
//! `at(h)` is 0 for `h ≤ −H` and `h` for `h ≥ H`. Between them the slope grows from 0 to 1 with a trapezoidal second
//! derivative, so an `h` that runs at constant speed gives a jerk-limited start. The curve is even about the corner
//! that it rounds: `at(h) = max(h, 0) + bulge(|h|)`. So the curve never changes the line outside, and its mirror image
//! serves for braking. Threads use the ease on the long axis (join, brake) and on the short axis (run-in, run-out).

use super::wide::{mul_div_up, root_mul_div_up};
use crate::units::{Length, mul_div};

/// A length in 2⁻¹⁶ nm. The laws of a thread compute in this unit before the single rounding to a setpoint.
pub(crate) type Fine = i64;

/// Rounds to the nearest whole nanometre.
pub(super) const fn whole(fine: Fine) -> Length {
    Length::from_nm(fine.wrapping_add(1 << 15) >> 16)
}

/// Acceleration and jerk in nm/s², nm/s³.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bounds {
    pub acceleration: u64,
    pub jerk: u64,
}

impl Bounds {
    /// The smaller acceleration and the smaller jerk of both.
    pub fn least(&self, other: &Self) -> Self {
        Self {
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }

    /// Time from rest to `speed` (nm/s) in ns, rounded up, and the part of this time in which the acceleration rises.
    pub fn time(&self, speed: u64) -> (u64, u64) {
        let (a, j) = (self.acceleration.max(1), self.jerk.max(1));
        // If a²/j ≤ v, the motion reaches its acceleration limit.
        let rise = mul_div_up(a, NS, j);
        if mul_div(a, a, j) <= speed {
            (mul_div_up(speed, NS, a).saturating_add(rise), rise)
        } else {
            // √(v/j) seconds for the rise and the same time for the fall.
            let rise = root_mul_div_up(speed, NS.wrapping_mul(NS), j);
            (rise.saturating_mul(2), rise)
        }
    }
}

const NS: u64 = 1_000_000_000;

/// A whole number, scaled so that its size fits 32 bits, and its reciprocal. With it the tick multiplies instead of
/// dividing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fraction {
    /// As wide as the other field, so that a plan has no gaps and can be cleared in one go.
    shift: u64,
    inverse: u64,
}

impl Fraction {
    /// Fractions of `whole`.
    #[inline(never)]
    pub fn of(whole: Fine) -> Self {
        let whole = whole.max(1) as u64;
        let shift = u64::BITS
            .wrapping_sub(whole.leading_zeros())
            .saturating_sub(32);
        let scaled = whole.wrapping_shr(shift).max(1);
        Self {
            shift: u64::from(shift),
            inverse: (1_u64 << 63).checked_div(scaled).unwrap_or(0),
        }
    }

    /// `part` / whole in 2⁻³¹, for 0 ≤ part ≤ whole.
    fn get(self, part: Fine) -> u64 {
        let part = part.unsigned_abs().wrapping_shr(self.shift as u32);
        (part.wrapping_mul(self.inverse) >> 32).min(1 << 31)
    }

    /// `part` / `whole` in 2⁻³¹, limited to ±1. `whole` is the number from which this fraction was made.
    pub fn share(self, part: Fine, whole: Fine) -> i64 {
        let size = part.unsigned_abs() as Fine;
        let share = if size >= whole {
            1 << 31
        } else {
            self.get(size) as i64
        };
        if part < 0 {
            share.wrapping_neg()
        } else {
            share
        }
    }

    /// `size` · `fraction` (2⁻³¹), for a size not above the whole.
    fn scale(self, size: Fine, fraction: u64) -> Fine {
        let size = size.unsigned_abs().wrapping_shr(self.shift as u32);
        ((size.wrapping_mul(fraction) >> 31) as i64).wrapping_shl(self.shift as u32)
    }
}

/// The curve of the module's description. The default has no rounding at all: a sharp corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ease {
    half: Fine,
    rise: Fine,
    of_half: Fraction,
    of_rise: Fraction,
    /// Bulge at the end of the rising part.
    rise_gain: Fine,
    /// H²/(2·(2H − R)): the parabola of the flat part.
    flat_gain: Fine,
}

impl Ease {
    /// The ease for a master that runs at `speed` (nm/s) along `h`, while its follower gains `follower` nm/s within
    /// `bounds`.
    #[inline(never)]
    pub fn new(speed: u64, follower: u64, bounds: &Bounds) -> Self {
        if speed == 0 || follower == 0 {
            return Self::default();
        }
        let (time, rise) = bounds.time(follower);
        let half = half_way(speed, time);
        let rise = mul_div(speed, rise, NS).min(half).max(1);
        Self::of(half, rise)
    }

    /// The half length of [`Ease::new`], without computing the rest.
    #[inline(never)]
    pub fn half_for(speed: u64, follower: u64, bounds: &Bounds) -> u64 {
        if speed == 0 || follower == 0 {
            return 0;
        }
        let (time, _) = bounds.time(follower);
        half_way(speed, time) << 16
    }

    /// The ease with half length `half` and rising part `rise` ≤ `half`, whole nanometres.
    pub fn of(half: u64, rise: u64) -> Self {
        // Gains in 2⁻¹⁶ nm; H ≤ 2⁴² leaves room for the shifts.
        let whole = half.saturating_mul(2).saturating_sub(rise);
        let rise_gain = mul_div(rise << 16, rise, whole.saturating_mul(6));
        let flat_gain = mul_div(half << 15, half, whole);
        let half = (half << 16) as i64;
        let rise = (rise << 16) as i64;
        Self {
            half,
            rise,
            of_half: Fraction::of(half),
            of_rise: Fraction::of(rise),
            rise_gain: rise_gain as i64,
            flat_gain: flat_gain as i64,
        }
    }

    /// H.
    pub const fn half(&self) -> Fine {
        self.half
    }

    /// `part` / H in 2⁻³¹, limited to ±1.
    pub fn share(&self, part: Fine) -> i64 {
        self.of_half.share(part, self.half)
    }

    /// H in nanometres; exact.
    pub const fn half_nm(&self) -> i64 {
        self.half >> 16
    }

    /// The part of 2·H over which the second derivative rises, in nanometres; exact.
    pub const fn rise_nm(&self) -> i64 {
        self.rise >> 16
    }

    /// The curve at `h`.
    pub fn at(&self, h: Fine) -> Fine {
        let line = h.max(0);
        let inside = self.half.wrapping_sub(h.unsigned_abs() as Fine);
        if inside <= 0 {
            return line;
        }
        line.wrapping_add(self.bulge(inside))
    }

    /// Distance of the curve from its two lines at the point `inside` from the nearer end.
    fn bulge(&self, inside: Fine) -> Fine {
        if inside < self.rise {
            let u = self.of_rise.get(inside);
            let cube = (u.wrapping_mul(u) >> 31).wrapping_mul(u) >> 31;
            self.of_rise.scale(self.rise_gain, cube)
        } else {
            let u = self.of_half.get(inside.wrapping_sub(self.rise >> 1));
            let square = u.wrapping_mul(u) >> 31;
            self.of_half
                .scale(self.flat_gain, square)
                .wrapping_add(self.rise_gain >> 2)
        }
    }
}

/// Half of the way that `h` covers in a time (ns), rounded up to whole nanometres.
fn half_way(speed: u64, time: u64) -> u64 {
    mul_div_up(speed, time, 2 * NS).min(1 << 42)
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::arithmetic_side_effects)]
mod tests {
    extern crate std;

    use super::*;

    const MACHINES: [(u64, u64, u64); 6] = [
        // Speed, acceleration, jerk. The cases: jerk alone, both limits, hardly any jerk limit, slow, fast, a tick's
        // travel and less.
        (34_500_000, 3_000_000_000, 60_000_000_000),
        (200_000_000, 2_000_000_000, 60_000_000_000),
        (50_000_000, 1_000_000_000, 10_000_000_000_000),
        (100_000, 3_000_000_000, 60_000_000_000),
        (400_000_000, 500_000_000, 5_000_000_000),
        (1_000, 3_000_000_000, 60_000_000_000),
    ];

    /// The curve by its definition: the second derivative rises over R, stays constant, then falls over R.
    fn exact(h: f64, half: f64, rise: f64) -> f64 {
        let whole = 2.0 * half;
        let x = (h + half).clamp(0.0, whole);
        let top = 1.0 / (whole - rise);
        let cubes = |x: f64| x.max(0.0).powi(3);
        let inside = top / (6.0 * rise)
            * (cubes(x) - cubes(x - rise) - cubes(x - whole + rise) + cubes(x - whole));
        inside + (h - half).max(0.0)
    }

    #[test]
    fn the_curve_is_the_one_of_its_definition() {
        for (speed, acceleration, jerk) in MACHINES {
            let ease = Ease::new(speed, speed, &Bounds { acceleration, jerk });
            let (half, rise) = (ease.half as f64, ease.rise as f64);
            for n in -1100..=1100_i64 {
                let h = ease.half * n / 1000;
                let error = (ease.at(h) as f64 - exact(h as f64, half, rise)).abs() / 65536.0;
                assert!(
                    error < 0.01 + half / 65536.0 * 3e-9,
                    "{speed}: {error} nm at {n}"
                );
            }
            assert_eq!(ease.at(ease.half), ease.half);
            assert_eq!(ease.at(-ease.half), 0);
        }
    }

    #[test]
    fn half_is_what_the_limits_allow() {
        for (speed, acceleration, jerk) in MACHINES {
            let ease = Ease::new(speed, speed, &Bounds { acceleration, jerk });
            let (v, a, j) = (speed as f64, acceleration as f64, jerk as f64);
            let time = if v >= a * a / j {
                v / a + a / j
            } else {
                2.0 * (v / j).sqrt()
            };
            let half = ease.half_nm() as f64;
            // Never shorter than exact, and longer only by the rounding to nanoseconds and nanometres.
            assert!(half >= v * time / 2.0 - 1e-3 && half <= v * (time + 4e-9) / 2.0 + 1.0);
        }
        assert_eq!(
            Ease::new(
                0,
                1,
                &Bounds {
                    acceleration: 1,
                    jerk: 1
                }
            ),
            Ease::default()
        );
        assert_eq!(Ease::default().at(5), 5);
        assert_eq!(Ease::default().at(-5), 0);
    }
}
