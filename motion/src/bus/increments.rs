//! Positions on the bus: drive increments, and their exact conversion from nanometres.
//!
//! A drive counts in increments of its own. [`Scale`] is the ratio between increments and nanometres, as CiA 402
//! defines it (6091h, 6092h). [`Scale`] computes an increment value from the absolute position, or from the previous
//! value and its exact remainder ([`Told`]). Both ways give the same result: no rounding error adds up from tick to
//! tick, and after any path the drive stands within half an increment of the exact position.

use crate::units::{narrow_div, signed_product};
use core::num::NonZeroU32;

/// A position in drive increments, as objects 607Ah and 6064h hold it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Increments(i32);

impl Increments {
    /// `count` increments.
    #[must_use]
    pub const fn new(count: i32) -> Self {
        Self(count)
    }

    /// The number of increments.
    #[must_use]
    pub const fn get(self) -> i32 {
        self.0
    }

    /// The distance between two positions, in increments.
    #[must_use]
    pub const fn distance(self, other: Self) -> u32 {
        self.0.abs_diff(other.0)
    }

    /// The distance for a drive whose count wraps: the shorter way round.
    #[must_use]
    pub(crate) const fn turned(self, other: Self) -> u32 {
        self.0.wrapping_sub(other.0).unsigned_abs()
    }
}

/// The last target of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Told {
    /// In nanometres (µ°).
    position: i64,
    /// In increments; `None` beyond the range of its drive.
    increments: Option<Increments>,
    /// Remainder of the division that gave the increments, with the rounding half included: 0 ≤ rest < denominator.
    rest: u32,
}

/// Increments per nanometre (rotary axes: per millionth of a degree), as an exact ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    numerator: NonZeroU32,
    denominator: NonZeroU32,
    /// ⌊numerator · 2⁵⁹ / denominator⌋, below 2⁶³.
    reciprocal: i64,
}

impl Scale {
    /// The largest ratio: an increment of a sixteenth of a nanometre is finer than any drive's.
    const FINEST: u64 = 16;
    /// Binary places of the reciprocal.
    const PLACES: u32 = 59;

    /// `numerator` increments for every `denominator` nanometres (µ°). `None` if one of them is 0 or there would be 16
    /// or more increments to a nanometre.
    // Three functions call it.
    #[inline(never)]
    #[must_use]
    pub const fn new(numerator: u32, denominator: u32) -> Option<Self> {
        let (Some(n), Some(d)) = (NonZeroU32::new(numerator), NonZeroU32::new(denominator)) else {
            return None;
        };
        if numerator as u64 >= Self::FINEST.wrapping_mul(denominator as u64) {
            return None;
        }
        // numerator · 2⁵⁹ is below 2⁹¹, and the quotient below 16 · 2⁵⁹.
        let reciprocal = narrow_div((numerator as u128) << Self::PLACES, denominator as u64);
        Some(Self {
            numerator: n,
            denominator: d,
            reciprocal: reciprocal as i64,
        })
    }

    /// The increment value nearest to a position in nanometres (µ°), halves upwards; `None` where it is beyond 32 bits, or
    /// the position not within ±2⁴³. Two multiplications of 64 bits, no division.
    #[must_use]
    pub const fn increments(&self, position: i64) -> Option<Increments> {
        self.find(position).increments
    }

    /// The same value, computed from the last target of the axis. This function is for the tick: an axis moves little
    /// in a tick, so two multiplications and a division of 32 bits are enough. A standing axis costs one comparison. A
    /// move that is too large for 32 bits costs as much as [`Scale::increments`]. `last` must come from the same scale
    /// ([`Scale::find`], or this function), because its remainder counts in units of the scale's denominator.
    pub fn follow(&self, last: &mut Told, position: i64) -> Option<Increments> {
        if last.position != position {
            *last = match self.step(last, position) {
                Some(told) => told,
                None => self.find(position),
            };
        }
        last.increments
    }

    /// `None` where the step is too large for 32 bits, or the last position has no increment value.
    fn step(&self, last: &Told, position: i64) -> Option<Told> {
        if is_beyond(position) {
            return None;
        }
        let way = position.wrapping_sub(last.position);
        let moved = way as i32;
        if i64::from(moved) != way {
            return None;
        }
        let numerator = i32::try_from(self.numerator.get()).ok()?;
        let rest = moved
            .checked_mul(numerator)?
            .checked_add(i32::try_from(last.rest).ok()?)?;
        // Rounds down, also below zero.
        let sign = (rest >> 31) as u32;
        let magnitude = rest as u32 ^ sign;
        let whole = magnitude / self.denominator;
        let rest = magnitude.wrapping_sub(whole.wrapping_mul(self.denominator.get()));
        let rest = if sign == 0 {
            rest
        } else {
            self.denominator.get().wrapping_add(!rest)
        };
        let increments = last.increments?.get().checked_add((whole ^ sign) as i32)?;
        Some(Told {
            position,
            increments: Some(Increments(increments)),
            rest,
        })
    }

    /// The target for a position, with its remainder.
    #[must_use]
    pub const fn find(&self, position: i64) -> Told {
        let nowhere = Told {
            position,
            increments: None,
            rest: 0,
        };
        if is_beyond(position) {
            return nowhere;
        }
        // The floor of the reciprocal makes the product too small in magnitude by less than |position| / 2⁵⁹ < 2⁻¹⁶, so
        // the quotient misses the floor of (position · n + d/2) / d by one at most, on either side.
        let estimate = (signed_product(position, self.reciprocal) >> Self::PLACES) as i64;
        let denominator = self.denominator.get() as i64;
        // Both products wrap alike; their difference is small: within ±2 d.
        let rest = position
            .wrapping_mul(self.numerator.get() as i64)
            .wrapping_add(denominator >> 1)
            .wrapping_sub(estimate.wrapping_mul(denominator));
        let (exact, rest) = if rest < 0 {
            (estimate.wrapping_sub(1), rest.wrapping_add(denominator))
        } else if rest >= denominator {
            (estimate.wrapping_add(1), rest.wrapping_sub(denominator))
        } else {
            (estimate, rest)
        };
        if exact as i32 as i64 != exact {
            return nowhere;
        }
        Told {
            position,
            increments: Some(Increments(exact as i32)),
            rest: rest as u32,
        }
    }

    /// The position in nanometres (µ°) nearest to an increment value, halves upwards. Takes one division: for starting
    /// and for messages, not for the tick. Where an increment is a nanometre or more, [`Scale::increments`] of the
    /// result is the same increment value.
    // Three functions call it.
    #[inline(never)]
    #[must_use]
    pub const fn position(&self, increments: Increments) -> i64 {
        let numerator = self.numerator.get() as i64;
        // |i32| · u32 is below 2⁶³.
        match (increments.0 as i64)
            .wrapping_mul(self.denominator.get() as i64)
            .saturating_add(numerator >> 1)
            .checked_div_euclid(numerator)
        {
            Some(position) => position,
            None => 0,
        }
    }

    /// As [`position`](Self::position), to half an increment, of an increment value that is near the last target. For the
    /// tick: a division of 32 bits.
    pub(crate) fn near(&self, last: &Told, increments: Increments) -> i64 {
        let way = || {
            let behind = increments.0.checked_sub(last.increments?.0)?;
            let denominator = i32::try_from(self.denominator.get()).ok()?;
            let numerator = i32::try_from(self.numerator.get()).ok()?;
            behind
                .checked_mul(denominator)?
                .checked_div(numerator)
                .map(|way| last.position.wrapping_add(way.into()))
        };
        way().unwrap_or_else(|| self.position(increments))
    }

    /// A distance in increments as nanometres (µ°), rounded to the nearest.
    #[must_use]
    pub const fn length(&self, increments: u32) -> i64 {
        let numerator = self.numerator.get() as u64;
        // u32 · u32 + u32 is below 2⁶⁴.
        match (increments as u64)
            .wrapping_mul(self.denominator.get() as u64)
            .wrapping_add(numerator >> 1)
            .checked_div(numerator)
        {
            Some(length) if length <= i64::MAX as u64 => length as i64,
            _ => i64::MAX,
        }
    }

    /// A distance in nanometres (µ°) as whole increments, rounded down; saturates at both ends.
    #[inline(never)]
    #[must_use]
    pub const fn limit(&self, distance: i64) -> u32 {
        if distance <= 0 {
            return 0;
        }
        let scaled = (distance as u128).wrapping_mul(self.numerator.get() as u128);
        let increments = narrow_div(scaled, self.denominator.get() as u64);
        if increments <= u32::MAX as u64 {
            increments as u32
        } else {
            u32::MAX
        }
    }
}

/// True for a position not within ±2⁴³. The upper 32 bits are enough to see that.
const fn is_beyond(position: i64) -> bool {
    ((position >> 32) as i32).wrapping_add(1 << 11) as u32 >= 1 << 12
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;

    /// A fixed stream of 64-bit numbers (SplitMix64).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^ (z >> 31)
        }

        fn within(&mut self, magnitude: i64) -> i64 {
            (self.next() % (2 * magnitude as u64 + 1)) as i64 - magnitude
        }
    }

    /// ⌊position · n / d + ½⌋ in numbers wide enough for anything.
    fn exact(position: i64, n: u32, d: u32) -> i128 {
        (2 * i128::from(position) * i128::from(n) + i128::from(d)).div_euclid(2 * i128::from(d))
    }

    #[test]
    fn the_built_in_drives_count_100_nm() {
        let scale = Scale::new(1, 100).unwrap();
        for (nm, inc) in [
            (0, 0),
            (49, 0),
            (50, 1),
            (-50, 0),
            (-51, -1),
            (300_000_000, 3_000_000),
            (-1_000_000_000, -10_000_000),
        ] {
            assert_eq!(scale.increments(nm), Some(Increments(inc)), "{nm} nm");
        }
        assert_eq!(scale.position(Increments(-7)), -700);
        assert_eq!(scale.limit(1_000_000), 10_000);
        assert_eq!(scale.limit(99), 0);
        assert_eq!(scale.length(10_000), 1_000_000);
    }

    #[test]
    fn an_impossible_ratio_is_none() {
        assert_eq!(Scale::new(0, 1), None);
        assert_eq!(Scale::new(1, 0), None);
        assert_eq!(Scale::new(16, 1), None);
        assert!(Scale::new(u32::MAX, u32::MAX / 16 + 1).is_some());
        assert!(Scale::new(1, u32::MAX).is_some());
    }

    #[test]
    fn any_position_in_any_scale_is_the_nearest_increment() {
        leadscrew_seed::volume(1, |seed| {
            let mut random = Random(seed);
            let mut refused = 0;
            for _ in 0..200_000 {
                let bits = 1 + random.next() % 32;
                let d = (random.next() >> (64 - bits)).max(1) as u32;
                let bits = 1 + random.next() % 32;
                let n = (random.next() >> (64 - bits)).max(1) as u32;
                let Some(scale) = Scale::new(n, d) else {
                    assert!(u64::from(n) >= 16 * u64::from(d));
                    continue;
                };
                let bits = random.next() % 44;
                let position = random.within(1 << bits);
                let wanted = exact(position, n, d);
                match scale.increments(position) {
                    Some(Increments(inc)) => {
                        assert_eq!(i128::from(inc), wanted, "{position} · {n}/{d}");
                    }
                    None => {
                        assert!(i32::try_from(wanted).is_err(), "{position} · {n}/{d}");
                        refused += 1;
                    }
                }
            }
            assert!(refused > 100);
        });
    }

    #[test]
    fn a_step_from_anywhere_gives_what_the_position_gives() {
        leadscrew_seed::volume(4, |seed| {
            let mut random = Random(seed);
            let mut steps = 0;
            for _ in 0..2_000 {
                let bits = 1 + random.next() % 32;
                let d = (random.next() >> (64 - bits)).max(1) as u32;
                let bits = 1 + random.next() % 32;
                let n = (random.next() >> (64 - bits)).max(1) as u32;
                let Some(scale) = Scale::new(n, d) else {
                    continue;
                };
                let bits = random.next() % 45;
                let mut position = random.within(1 << bits);
                let mut told = scale.find(position);
                for _ in 0..200 {
                    let bits = random.next() % 36;
                    position += random.within(1 << bits);
                    steps += u32::from(scale.step(&told, position).is_some());
                    let followed = scale.follow(&mut told, position);
                    assert_eq!(told, scale.find(position), "{position} · {n}/{d}");
                    assert_eq!(followed, scale.increments(position));
                }
            }
            assert!(steps > 50_000, "{steps}");
        });
    }

    #[test]
    fn a_step_beyond_the_range_is_none_and_the_way_back_is_not() {
        let scale = Scale::new(1, 2048).unwrap();
        let last = i64::from(i32::MAX) * 2048;
        let mut told = scale.find(last);
        assert_eq!(scale.follow(&mut told, last + 1024), None);
        assert_eq!(
            scale.follow(&mut told, last + 1023),
            Some(Increments(i32::MAX))
        );
        let scale = Scale::new(1, u32::MAX).unwrap();
        let mut told = scale.find((1 << 43) - 1);
        assert!(told.increments.is_some());
        assert_eq!(scale.follow(&mut told, 1 << 43), None);
    }

    #[test]
    fn halves_and_both_ends_of_the_range() {
        let scale = Scale::new(1, 2048).unwrap();
        let last = i64::from(i32::MAX) * 2048;
        assert_eq!(scale.increments(last), Some(Increments(i32::MAX)));
        assert_eq!(scale.increments(last + 1023), Some(Increments(i32::MAX)));
        assert_eq!(scale.increments(last + 1024), None);
        let first = i64::from(i32::MIN) * 2048;
        assert_eq!(scale.increments(first), Some(Increments(i32::MIN)));
        assert_eq!(scale.increments(first - 1024), Some(Increments(i32::MIN)));
        assert_eq!(scale.increments(first - 1025), None);
        assert_eq!(scale.increments(i64::MAX), None);
        assert_eq!(scale.increments(i64::MIN), None);
    }

    #[test]
    fn a_random_walk_never_drifts() {
        leadscrew_seed::volume(2, |seed| {
            let mut random = Random(seed);
            for (n, d) in [(1, 100), (7, 1000), (65_536, 5_000_000), (10, 1), (3, 7)] {
                let scale = Scale::new(n, d).unwrap();
                let mut position = 0i64;
                for _ in 0..100_000 {
                    position += random.within(300_000);
                    let Increments(inc) = scale.increments(position).unwrap();
                    // |inc · d − position · n| ≤ d/2: half an increment.
                    let miss =
                        i128::from(inc) * i128::from(d) - i128::from(position) * i128::from(n);
                    assert!(2 * miss.abs() <= i128::from(d), "{position} · {n}/{d}");
                }
            }
        });
    }

    #[test]
    fn an_increment_value_survives_the_way_to_nanometres_and_back() {
        leadscrew_seed::volume(3, |seed| {
            let mut random = Random(seed);
            for (n, d) in [
                (1, 100),
                (7, 1000),
                (65_536, 5_000_000),
                (1, 1),
                (999, 1000),
            ] {
                let scale = Scale::new(n, d).unwrap();
                for _ in 0..20_000 {
                    let start = Increments(random.next() as i32);
                    assert_eq!(scale.increments(scale.position(start)), Some(start));
                }
            }
        });
    }
}
