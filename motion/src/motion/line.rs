//! Straight paths: three axes move in proportion to one distance.

use super::rate::Travel;
use crate::call::Position;
use crate::units::{Angle, Length, mul_high, narrow_div, plane};

/// A straight path in X, Z and C.
///
/// Its length is the distance in X and Z, and C follows in proportion. If C turns further (1 µ° counts as 1 nm) or
/// moves alone, the length is C's angle. So no axis ever covers more than the length of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    from: Position,
    to: Position,
    length: Length,
    /// The way on which a feed is measured: the root of the squares of all three, a degree of C as a millimetre.
    feed_length: Length,
    /// Share of each axis, 2⁻⁶³.
    x: u64,
    z: u64,
    c: u64,
}

impl Line {
    /// The line from `from` to `to`. Both positions are within [`Length::INPUT_LIMIT`].
    #[must_use]
    pub fn new(from: Position, to: Position) -> Self {
        let dx = magnitude(from.x.nm(), to.x.nm());
        let dz = magnitude(from.z.nm(), to.z.nm());
        let dc = magnitude(from.c.udeg(), to.c.udeg());
        // Rounded up, so that no share is above one.
        let flat = plane::length_up(dx, dz);
        let length = flat.max(dc);
        Self {
            from,
            to,
            length: nm(length),
            // As the controls of this family read F beside a rotary axis [D569].
            feed_length: nm(if dc == 0 {
                flat
            } else {
                plane::length_up(flat, dc)
            }),
            x: share(dx, length),
            z: share(dz, length),
            c: share(dc, length),
        }
    }

    /// Length in nm, or in µ° if C covers more.
    #[must_use]
    pub const fn length(&self) -> Length {
        self.length
    }

    /// The way on which a feed is measured, no shorter than the length: with C beside X or Z, the feed is that of all of
    /// them together.
    #[must_use]
    pub const fn feed_length(&self) -> Length {
        self.feed_length
    }

    /// The distance that each axis covers (X, Z, C), in nm and µ°.
    pub(super) const fn distances(&self) -> [u64; 3] {
        [
            magnitude(self.from.x.nm(), self.to.x.nm()),
            magnitude(self.from.z.nm(), self.to.z.nm()),
            magnitude(self.from.c.udeg(), self.to.c.udeg()),
        ]
    }

    /// Start of the line.
    #[must_use]
    pub const fn start(&self) -> Position {
        self.from
    }

    /// End of the line.
    #[must_use]
    pub const fn end(&self) -> Position {
        self.to
    }

    /// The position at `travel`, rounded to the nearest nm or µ°. From the length on this is the end.
    #[must_use]
    pub fn at(&self, travel: Travel) -> Position {
        if travel >= Travel::of(self.length) {
            return self.to;
        }
        // The travel is below 2⁶⁰ (4.4 km to either side), so it fits in 2⁻²⁰ nm.
        let way = travel.raw() << 4;
        Position {
            x: Length::from_nm(along(self.from.x.nm(), self.to.x.nm(), way, self.x)),
            z: Length::from_nm(along(self.from.z.nm(), self.to.z.nm(), way, self.z)),
            c: Angle::from_udeg(along(self.from.c.udeg(), self.to.c.udeg(), way, self.c)),
        }
    }
}

/// The distance between two coordinates. Both are within [`Length::INPUT_LIMIT`].
const fn magnitude(from: i64, to: i64) -> u64 {
    to.wrapping_sub(from).unsigned_abs()
}

const fn nm(value: u64) -> Length {
    Length::from_nm(value as i64)
}

/// `part / whole` in 2⁻⁶³, rounded to the nearest; `part` is not above `whole`.
const fn share(part: u64, whole: u64) -> u64 {
    if part == 0 {
        return 0;
    }
    let scaled = ((part as u128) << 63).wrapping_add((whole >> 1) as u128);
    narrow_div(scaled, whole)
}

/// `way` is in 2⁻²⁰ nm, so the product's high half is in 2⁻¹⁹ nm.
const fn along(from: i64, to: i64, way: u64, share: u64) -> i64 {
    let distance = (mul_high(way, share).wrapping_add(1 << 18) >> 19) as i64;
    if to < from {
        from.wrapping_sub(distance)
    } else {
        from.wrapping_add(distance)
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;

    fn position(x: i64, z: i64, c: i64) -> Position {
        Position {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
            c: Angle::from_udeg(c),
        }
    }

    #[test]
    fn starts_and_ends_exactly_and_is_nearest_between() {
        leadscrew_seed::volume(5, |seed| {
            let mut random = leadscrew_seed::Random(seed);
            let mut random = move |bits: u32| (random.bits() as i64) >> (64 - bits);
            for round in 0..20_000 {
                let bits = 2 + round % 41;
                let from = position(random(bits), random(bits), random(bits));
                let to = position(random(bits), random(bits), random(bits));
                let line = Line::new(from, to);
                let length = line.length().nm();
                assert_eq!(line.at(Travel::ZERO), from);
                assert_eq!(line.at(Travel::of(line.length())), to);
                if length == 0 {
                    continue;
                }
                let travel = (random(63) as u64) % ((length as u64) << 16);
                let at = line.at(Travel::from_raw(travel));
                for (at, from, to) in [
                    (at.x.nm(), from.x.nm(), to.x.nm()),
                    (at.z.nm(), from.z.nm(), to.z.nm()),
                    (at.c.udeg(), from.c.udeg(), to.c.udeg()),
                ] {
                    // |at − from − (to − from)·travel/length| ≤ ½ + 2⁻¹⁶
                    let scale = i128::from(length) << 16;
                    let exact = i128::from(to - from) * i128::from(travel);
                    let error = i128::from(at - from) * scale - exact;
                    assert!(
                        error.abs() <= scale / 2 + (scale >> 16),
                        "{line:?} {travel}"
                    );
                }
            }
        });
    }

    #[test]
    fn the_end_is_met_without_a_step() {
        // One unit of travel before the end, every axis is already at its end.
        let line = Line::new(position(0, 0, 0), position(1 << 42, -(1 << 42), 3));
        let last = Travel::from_raw(Travel::of(line.length()).raw() - 1);
        assert_eq!(line.at(last), line.end());
    }

    #[test]
    fn length_is_the_way_of_the_tool_unless_c_turns_further() {
        let flat = Line::new(position(0, 0, 0), position(3_000, -4_000, 100));
        assert_eq!(flat.length(), Length::from_nm(5_000));
        assert_eq!(flat.feed_length(), Length::from_nm(5_001));
        let turning = Line::new(position(0, 0, 0), position(3_000, -4_000, -12_000));
        assert_eq!(turning.length(), Length::from_nm(12_000));
        assert_eq!(turning.feed_length(), Length::from_nm(13_000));
        let alone = Line::new(position(0, 0, 0), position(0, 0, 360_000_000));
        assert_eq!(alone.feed_length(), alone.length());
    }
}
