//! Slopes of a tapered thread, and how its points are rounded.
//!
//! Knows one depth at a time and nothing of passes.

use super::slope::{FINE_BITS, FINE_HALF, Fine, HalfAngle, after};
use crate::units::{Length, Remainder, div_wide, narrow_div, product};

/// The figures that a taper adds to a thread.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taper {
    /// Sign of s·i: +1 where the thread gets nearer to A towards its start.
    pub(crate) sign: i64,
    /// |i|.
    pub(crate) size: u64,
    /// |i|·tan(a/2)/|W|: radius lost per nanometre of u.
    pub(crate) per_depth: Fine,
    /// |i|/|W|, used by run-ins only.
    pub(crate) per_travel: Fine,
    /// |i|·(tan(a/2) ± |i|·tan(a/2)/|W|)/|W|, used by clipped run-ins only.
    pub(crate) per_clipped: Fine,
}

impl Taper {
    /// The slopes of a taper that leans `lean` (s·i) towards A over `travel`; `None` for a straight thread.
    #[inline(never)]
    pub(crate) fn new(lean: i64, travel: u64, tangent: HalfAngle) -> Option<Self> {
        if lean == 0 {
            return None;
        }
        let size = lean.unsigned_abs();
        let per_depth = div_wide(after(size, tangent.fine()), travel);
        let both = if lean > 0 {
            tangent.fine().wrapping_add(per_depth)
        } else {
            tangent.fine().wrapping_sub(per_depth)
        };
        Some(Self {
            sign: lean.signum(),
            size,
            per_depth,
            per_travel: div_wide(Fine::from(size) << FINE_BITS, travel),
            per_clipped: div_wide(after(size, both), travel),
        })
    }

    /// The rest of s·i after its magnitude has lost `lost`, in nanometres, rounded once. The slopes are rounded down, so an
    /// exact half in `lost` never looks like more than a half. Rounding this half down leaves the larger rest, so halves
    /// go away from zero.
    #[inline]
    pub(crate) fn left_after(&self, lost: Fine) -> i64 {
        let lost = lost.wrapping_add(FINE_HALF.wrapping_sub(1)) >> FINE_BITS;
        flip(self.size.wrapping_sub(lost as u64) as i64, self.sign)
    }
}

/// `value` with the sign of `sign` (±1).
pub(crate) const fn flip(value: i64, sign: i64) -> i64 {
    value.wrapping_mul(sign)
}

/// `a·b/c` to the nearest nanometre, halves up.
pub(crate) fn scaled(a: u64, b: u64, c: u64) -> Length {
    let wide = product(a, b).wrapping_mul(2);
    let rounded = narrow_div(wide.wrapping_add(u128::from(c)), c) >> 1;
    Length::from_nm(rounded as i64)
}

/// `above/below` to the nearest nanometre, halves away from zero; `above` counts 2⁻¹⁵ nm.
pub(crate) fn quotient(above: i128, below: u64) -> i64 {
    // Two lengths of 2⁴³ nm and a remainder's bits: far below 2¹²⁷.
    let size = narrow_div(above.unsigned_abs(), below);
    let half = 1_u64 << (Remainder::BITS - 1);
    let nm = (size.wrapping_add(half) >> Remainder::BITS) as i64;
    if above < 0 { nm.wrapping_neg() } else { nm }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taper(i: i64, travel: u64, degrees: u8) -> Taper {
        Taper::new(i, travel, HalfAngle::of(degrees).unwrap()).unwrap()
    }

    /// At 90° the shift is the depth, so a point can lie exactly between two nanometres: halves go away from zero, in
    /// both directions alike.
    #[test]
    fn halves_go_away_from_zero() {
        for sign in [1, -1] {
            // 7 nm over 16: each nanometre of depth takes 0.4375 away.
            let taper = taper(7 * sign, 16, 90);
            let left = |u: u128| taper.left_after(u * taper.per_depth) * sign;
            // 7, 6.5625, 6.125, 5.6875, 5.25, 4.8125, 4.375, 3.9375, 3.5
            let want = [7, 7, 6, 6, 5, 5, 4, 4, 4];
            for (u, want) in want.into_iter().enumerate() {
                assert_eq!(left(u as u128), want, "{u}");
            }
        }
    }

    /// An odd divisor has no exact slope in binary; exact halves must still be seen as such.
    #[test]
    fn halves_survive_an_inexact_slope() {
        // 5/6 nm a nanometre: after 3 · n, n odd, 2.5 · n are gone.
        let taper = taper(5_000_000_005, 6_000_000_006, 90);
        for n in (1..2_000_000_001u128).step_by(100_000_000) {
            let gone = 5 * n / 2;
            let left = taper.left_after(3 * n * taper.per_depth);
            assert_eq!(left, 5_000_000_005 - gone as i64, "{n}");
        }
    }

    #[test]
    fn ratios_round_once() {
        let scaled = |a, b, c| scaled(a, b, c).nm();
        assert_eq!(scaled(1, 1, 2), 1);
        assert_eq!(scaled(1, 1, 3), 0);
        assert_eq!(scaled(2, 1, 3), 1);
        assert_eq!(scaled(500_000, 1_500_000, 35_000_000), 21_429);
        assert_eq!(scaled(1 << 42, 1 << 42, 1 << 43), 1 << 41);
    }
}
