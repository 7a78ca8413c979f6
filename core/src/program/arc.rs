//! Circles: the centre from I K or from R, exact in integers.
//!
//! Plane as the trade draws it: Z to the right, X upwards, seen so that G02 is clockwise. Knows nothing of words.

use crate::units::Length;

/// How far the end may lie off the circle given by start and centre. Input increments of 1 µm on I, K and the end
/// add up to less than 3 µm; a larger error is a mistake in the program.
pub const ARC_END_TOLERANCE: Length = Length::from_nm(10_000);

/// A way in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Way {
    pub(super) x: Length,
    pub(super) z: Length,
}

impl Way {
    pub(super) const fn is_zero(self) -> bool {
        self.x.nm() == 0 && self.z.nm() == 0
    }

    /// Square of its length, nm².
    fn square(self) -> u128 {
        let x = u128::from(self.x.nm().unsigned_abs());
        let z = u128::from(self.z.nm().unsigned_abs());
        // Inputs are within 2⁴³ nm each: below 2⁸⁷.
        x.wrapping_mul(x).wrapping_add(z.wrapping_mul(z))
    }

    /// A lower bound of its length.
    fn longer_side(self) -> u64 {
        self.x.nm().unsigned_abs().max(self.z.nm().unsigned_abs())
    }
}

/// The distance of the end from the circle: the difference of the radii at start and end, if above the tolerance.
pub(super) fn end_error(way: Way, centre: Way) -> Option<Length> {
    let at_end = Way {
        x: centre.x - way.x,
        z: centre.z - way.z,
    };
    let (first, second) = (centre.square(), at_end.square());
    // |r₁ − r₂| = |r₁² − r₂²| / (r₁ + r₂): the bound by the longer sides avoids the roots for most circles.
    let sum = centre.longer_side().saturating_add(at_end.longer_side());
    let allowed = u128::from(sum).wrapping_mul(u128::from(ARC_END_TOLERANCE.nm().unsigned_abs()));
    if first.abs_diff(second) <= allowed {
        return None;
    }
    let error = root(first).abs_diff(root(second));
    let error = Length::from_nm(i64::try_from(error).unwrap_or(i64::MAX));
    (error > ARC_END_TOLERANCE).then_some(error)
}

/// Where the arc comes nearest to `axis` in X between its ends, if it does. Its start has X `from`; `way` and `centre`
/// count from the start.
pub(super) fn nearest_to(
    axis: Length,
    from: Length,
    way: Way,
    centre: Way,
    clockwise: bool,
) -> Option<Length> {
    let middle = from + centre.x;
    let inward: i64 = if middle > axis { -1 } else { 1 };
    let radius = root(centre.square());
    let radius = Length::from_nm(i64::try_from(radius).unwrap_or(i64::MAX));
    // Start and end seen from the centre, so that the arc goes from the first to the second against the clock.
    let start = Way {
        x: -centre.x,
        z: -centre.z,
    };
    let end = Way {
        x: way.x - centre.x,
        z: way.z - centre.z,
    };
    let (first, last) = if clockwise {
        (end, start)
    } else {
        (start, end)
    };
    let product = |a: Length, b: Length| i128::from(a.nm()).wrapping_mul(i128::from(b.nm()));
    let is_small = product(first.z, last.x) >= product(first.x, last.z);
    let before = first.z.times(inward) >= Length::ZERO;
    let after = last.z.times(inward) <= Length::ZERO;
    let passes = if way.is_zero() {
        true
    } else if is_small {
        before && after
    } else {
        before || after
    };
    let nearest = if (middle - axis).abs() <= radius {
        axis
    } else {
        middle + radius.times(inward)
    };
    passes.then_some(nearest)
}

/// The centre of the circle of radius `radius` over the chord `way`, from its start, to within a nanometre; `large`
/// takes the arc over 180°. Where the radius is shorter than half of the chord by no more than
/// [`ARC_END_TOLERANCE`], the arc is a half circle; beyond that the error is half of the chord.
pub(super) fn centre_by_radius(
    way: Way,
    radius: Length,
    clockwise: bool,
    large: bool,
) -> Result<Way, Length> {
    let chord2 = way.square();
    let diameter = u128::from(radius.nm().unsigned_abs()).wrapping_mul(2);
    let diameter2 = diameter.wrapping_mul(diameter);
    let height2 = match diameter2.checked_sub(chord2) {
        Some(height2) => height2,
        None => {
            let slack = u128::from(ARC_END_TOLERANCE.nm().unsigned_abs()).wrapping_mul(2);
            let reach = diameter.wrapping_add(slack);
            if reach.wrapping_mul(reach) < chord2 {
                let half = root(chord2).wrapping_add(1) >> 1;
                return Err(Length::from_nm(i64::try_from(half).unwrap_or(i64::MAX)));
            }
            0
        }
    };
    // To the right of the way for a small clockwise arc, to the left for each of the two turned round.
    let side = if clockwise == large { -1 } else { 1 };
    let x = half_times_ratio(way.z, height2, chord2).times(side);
    let z = half_times_ratio(way.x, height2, chord2).times(side);
    Ok(Way {
        x: Length::from_nm(way.x.nm() / 2) - x,
        z: Length::from_nm(way.z.nm() / 2) + z,
    })
}

/// `length · √(height2 / chord2) / 2`, to the nearest nanometre; `|length| ≤ √chord2`, `chord2 > 0`.
fn half_times_ratio(length: Length, height2: u128, chord2: u128) -> Length {
    if height2 == 0 {
        return Length::ZERO;
    }
    // Both roots with 63 bits, whatever the size of the figures.
    let (height, height_shift) = wide_root(height2);
    let (chord, chord_shift) = wide_root(chord2);
    let mut above = u128::from(length.nm().unsigned_abs()).wrapping_mul(height);
    let mut below = chord.wrapping_mul(2);
    // root(v) = wide · 2^−shift. Both products stay below 2¹²⁰: |length| · 2^shift(chord) ≤ 2⁶⁴.
    match chord_shift.checked_sub(height_shift) {
        Some(more) => above = above.wrapping_shl(more),
        None => below = below.wrapping_shl(height_shift.wrapping_sub(chord_shift)),
    }
    let half = below >> 1;
    let rounded = above.wrapping_add(half).checked_div(below).unwrap_or(0);
    let nm = i64::try_from(rounded).unwrap_or(i64::MAX);
    Length::from_nm(nm).times(length.signum())
}

/// `(r, s)` with `√value = r · 2^−s` and r of 63 or 64 bits.
fn wide_root(value: u128) -> (u128, u32) {
    let shift = value.leading_zeros().saturating_sub(1) & !1;
    (root(value.wrapping_shl(shift)), shift >> 1)
}

/// The square root, rounded down.
fn root(value: u128) -> u128 {
    let mut rest = value;
    let mut root = 0_u128;
    // The highest power of four that is not above the value.
    let mut bit = match 127_u32.checked_sub(value.leading_zeros()) {
        Some(top) => 1_u128.wrapping_shl(top & !1),
        None => 0,
    };
    while bit != 0 {
        let next = root.wrapping_add(bit);
        root >>= 1;
        if let Some(less) = rest.checked_sub(next) {
            rest = less;
            root = root.wrapping_add(bit);
        }
        bit >>= 2;
    }
    root
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;

    fn way(x: i64, z: i64) -> Way {
        Way {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
        }
    }

    #[test]
    fn roots_are_rounded_down() {
        for value in (0..2_000_u128).chain([(1 << 126) - 1, 1 << 126, u128::MAX >> 1]) {
            let r = root(value);
            assert!(r * r <= value && (r + 1) * (r + 1) > value, "{value}");
        }
    }

    #[test]
    fn quarter_circles_in_all_four_senses() {
        let r = Length::from_nm(10_000_000);
        let to = way(10_000_000, -10_000_000);
        let near = way(0, -10_000_000);
        let far = way(10_000_000, 0);
        assert_eq!(centre_by_radius(to, r, false, false), Ok(near));
        assert_eq!(centre_by_radius(to, r, true, false), Ok(far));
        assert_eq!(centre_by_radius(to, r, false, true), Ok(far));
        assert_eq!(centre_by_radius(to, r, true, true), Ok(near));
    }

    #[test]
    fn centres_lie_on_both_radii() {
        leadscrew_seed::volume(7, |seed| {
            let mut state = seed;
            let mut next = |bits: u32| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> (64 - bits)) as i64 - (1 << (bits - 1))
            };
            for round in 0..20_000 {
                let bits = 8 + round % 34;
                let to = way(next(bits as u32), next(bits as u32));
                if to.is_zero() {
                    continue;
                }
                let r = root(to.square()) as i64 / 2 + 1 + next(bits as u32 + 1).abs();
                let centre =
                    centre_by_radius(to, Length::from_nm(r), round % 2 == 0, round % 3 == 0)
                        .expect("long enough");
                let start = root(centre.square()) as i64;
                let end =
                    root(way(centre.x.nm() - to.x.nm(), centre.z.nm() - to.z.nm()).square()) as i64;
                assert!(
                    (start - r).abs() <= 2 && (end - r).abs() <= 2,
                    "{to:?} {r} {start} {end}"
                );
            }
        });
    }

    #[test]
    fn a_radius_a_hair_short_is_a_half_circle() {
        let to = way(0, -20_000_000);
        let centre = centre_by_radius(to, Length::from_nm(9_995_000), true, false);
        assert_eq!(centre, Ok(way(0, -10_000_000)));
        let short = centre_by_radius(to, Length::from_nm(9_980_000), true, false);
        assert_eq!(short, Err(Length::from_nm(10_000_000)));
    }

    #[test]
    fn the_end_is_checked_by_the_difference_of_the_radii() {
        let centre = way(0, -10_000_000);
        assert_eq!(end_error(way(10_000_000, -10_000_000), centre), None);
        assert_eq!(end_error(way(10_009_000, -10_000_000), centre), None);
        assert_eq!(
            end_error(way(10_011_000, -10_000_000), centre),
            Some(Length::from_nm(11_000))
        );
    }
}
