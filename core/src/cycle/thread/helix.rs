//! The angle of an exact helix after a distance along the thread.
//!
//! Knows leads and distances, nothing of passes.

use core::num::NonZero;

use crate::units::{Lead, div_wide, mul_wide, narrow_div, product};

/// Millionths of a degree in a turn.
pub(crate) const TURN_UDEG: u32 = 360_000_000;

/// Distance along a lead to helix angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Helix {
    /// Lead: `nm` nanometres per `turns` turns.
    nm: NonZero<u64>,
    turns: u64,
    /// Turns per nanometre with 128 fractional bits, rounded up, without the whole turns: (high, low). `None` where the
    /// lead is so large or so uneven that this figure is not exact enough.
    per_nm: Option<(u64, u64)>,
}

impl Helix {
    /// For one lead.
    pub(crate) fn new(lead: Lead) -> Self {
        // A Lead is positive by construction.
        let (nm, turns) = lead.parts();
        let nm = NonZero::new(nm).unwrap_or(NonZero::<u64>::MIN);
        let per_nm = (nm.get() < 1 << 34).then(|| {
            let part = u128::from(turns % nm) << 64;
            let high = narrow_div(part, nm.get());
            let rest = part.wrapping_sub(product(high, nm.get()));
            // rest < nm < 2³⁴, so one more does not carry.
            let low = narrow_div(rest << 64, nm.get()).wrapping_add(1);
            (high, low)
        });
        Self { nm, turns, per_nm }
    }

    /// The angle turned over `distance` nanometres (below 2⁴⁴), modulo a turn, to the nearest millionth of a degree,
    /// halves up: 0…360 000 000, the full turn where only rounding makes it one.
    #[inline]
    pub(crate) fn angle(&self, distance: u64) -> u32 {
        match self.per_nm {
            // This rounds exactly. The computed part of a turn is too large by no more than 2⁻⁶⁴ + 2⁻⁸⁴ turns, which is
            // less than 2⁻³⁵·⁵ millionths of a degree. A true value below a half is below the half by at least
            // 1/(2·nm) > 2⁻³⁵ of a millionth.
            Some((high, low)) => {
                let carried = product(distance, low) >> 64;
                let part = distance
                    .wrapping_mul(high)
                    .wrapping_add(carried as u64)
                    .wrapping_add(1);
                let scaled = product(part, u64::from(TURN_UDEG));
                (scaled.wrapping_add(1 << 63) >> 64) as u32
            }
            None => self.wide_angle(distance),
        }
    }

    /// The same angle by division.
    #[cold]
    fn wide_angle(&self, distance: u64) -> u32 {
        let nm = self.nm.get();
        let turned = product(distance, self.turns);
        let whole = div_wide(turned, nm);
        let part = turned.wrapping_sub(mul_wide(whole, nm));
        let scaled = mul_wide(part, u64::from(TURN_UDEG));
        narrow_div(scaled.wrapping_add(u128::from(nm >> 1)), nm) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(nm: i64, turns: i64, distance: u64) -> u32 {
        let helix = Helix::new(Lead::new(nm, turns).unwrap());
        // Both computations must agree wherever the fast one is used.
        assert_eq!(helix.angle(distance), helix.wide_angle(distance));
        helix.angle(distance)
    }

    #[test]
    fn whole_turns_are_none() {
        assert_eq!(angle(6_000_000, 1, 72_000_000), 0);
        assert_eq!(angle(1, 1, 12_345), 0);
        assert_eq!(angle(254_000_000, 115, 2 * 254_000_000), 0);
    }

    #[test]
    fn parts_of_a_turn_round_to_the_nearest() {
        assert_eq!(angle(6_000_000, 1, 1_500_000), 90_000_000);
        // A millionth of a degree is 5 nm of this lead: 2 nm round down, 3 up; a half (of 10 nm) up.
        assert_eq!(angle(1_800_000_000, 1, 2), 0);
        assert_eq!(angle(1_800_000_000, 1, 3), 1);
        assert_eq!(angle(3_600_000_000, 1, 5), 1);
        assert_eq!(angle(3_600_000_000, 1, 4), 0);
        // The last half before a turn is the turn.
        assert_eq!(angle(3_600_000_000, 1, 3_600_000_000 - 5), TURN_UDEG);
        assert_eq!(angle(3_600_000_000, 1, 3_600_000_000 - 6), 359_999_999);
    }

    /// Leads at the edge of the fast computation, distances at the edge of the range, and halves everywhere.
    #[test]
    fn both_ways_agree() {
        leadscrew_seed::volume(1, |seed| {
            let mut distance = seed;
            for step in 0..2000u64 {
                distance = distance
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(step);
                for nm in [
                    (1 << 34) - 1,
                    (1 << 34) - 59,
                    7_200_000_000,
                    999,
                    25_400_000,
                    1 << 40,
                ] {
                    for turns in [1, 7, 2_540_000, (1 << 40) + 1] {
                        angle(nm, turns, distance >> 20);
                        // The nearest distance to a half of a millionth of a degree.
                        let odd = u128::from(distance % 720_000_000) | 1;
                        let half = (odd * nm as u128 / 720_000_000) as u64;
                        angle(nm, turns, half);
                        angle(nm, turns, half + 1);
                    }
                }
            }
        });
    }
}
