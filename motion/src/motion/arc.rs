//! Circular paths in X–Z, driven by one distance: the direction from the centre turns, and the radius may change a
//! little.

use super::path::Heading;
use super::rate::Travel;
use crate::call::Position;
use crate::units::{Direction, Length, mul_div, mul_high, narrow_div, plane};

/// The largest distance of the end from the circle through the start; see [`Arc::new`].
pub const ARC_TOLERANCE: Length = Length::from_nm(10_000);

/// 2π in 2⁻⁶⁰.
const TAU: u64 = 7_244_019_458_077_122_842;

/// A circular path in X–Z; C stands still.
///
/// I and K are rounded to the input increment, so start and end may be at slightly different distances from the centre.
/// The radius then changes evenly along the path, so that the path meets the end exactly and without a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arc {
    from: Position,
    to: Position,
    centre_x: i64,
    centre_z: i64,
    length: Length,
    /// Radius at the start, and the growth of the radius up to the end, 2⁻²⁰ nm.
    radius: u64,
    growth: i64,
    /// Direction from the centre to the start, counted from +Z towards +X.
    start: Direction,
    /// Angle by which the direction turns, 2⁻⁶² turns, positive from +Z towards +X (G03).
    sweep: i64,
    /// 2¹²⁷ / (length in 2⁻¹⁶ nm · 2^shift).
    inverse: u64,
    shift: u32,
}

/// The curvature figures of a path that the limits need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bend {
    /// Path length per radian, nm; at least 1.
    pub radius: u64,
    /// The factor, in 2⁻³² and at least 1, by which a derivative of the position may exceed that of a circle of this
    /// radius.
    pub stretch: u64,
}

/// The reason why an arc is impossible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcError {
    /// Start or end is the centre.
    NoRadius,
    /// Start and end are not equally far from the centre. The values are the two distances.
    NotOnCircle(Length, Length),
    /// The centre or the circle is out of range.
    TooFar,
    /// Start and end differ in C.
    MovesC,
}

impl Arc {
    /// The arc from `from` to `to` about the centre `from` + (`i`, `k`). Clockwise (G02) is as seen with Z to the right
    /// and X up, the trade's view. If both points lie in the same direction from the centre, the arc is a full turn.
    /// Positions are within [`Length::INPUT_LIMIT`].
    ///
    /// # Errors
    ///
    /// [`ArcError`]. The end may be off the circle by at most [`ARC_TOLERANCE`], and by at most a quarter of the
    /// radius.
    #[inline(never)]
    pub fn new(
        from: Position,
        to: Position,
        i: Length,
        k: Length,
        clockwise: bool,
    ) -> Result<Self, ArcError> {
        if from.c != to.c {
            return Err(ArcError::MovesC);
        }
        let (centre_x, centre_z) = (from.x + i, from.z + k);
        let start = Ray::new(-i, -k).ok_or(ArcError::TooFar)?;
        let end = Ray::new(to.x - centre_x, to.z - centre_z).ok_or(ArcError::TooFar)?;
        let (r0, r1) = (start.radius(), end.radius());
        if r0 == 0 || r1 == 0 {
            return Err(ArcError::NoRadius);
        }
        let off = r0.abs_diff(r1);
        let allowed = ((ARC_TOLERANCE.nm() as u64) << 20).min(r0 >> 2);
        if off > allowed {
            let nm = |r: u64| Length::from_nm((r.saturating_add(1 << 19) >> 20) as i64);
            return Err(ArcError::NotOnCircle(nm(r0), nm(r1)));
        }
        let turn = start.sweep_to(&end);
        let turn = if clockwise && turn < FULL {
            FULL.saturating_sub(turn)
        } else {
            turn
        }
        .max(1);

        // Mean radius times angle, combined with the growth at a right angle to it; rounded up.
        let mean = r0.midpoint(r1);
        // 2⁻²⁰ nm · 2⁻⁶³ turns · 2⁻⁶⁰: 2⁻¹⁵ nm.
        let arc = mul_high(mul_high(mean, turn << 1), TAU);
        let (arc, off) = (arc.div_ceil(1 << 15), off.div_ceil(1 << 20));
        let length = plane::length_up(arc, off).max(1);
        let travel = length << 16;
        let shift = travel.leading_zeros();
        let inverse = narrow_div(u128::MAX >> 1, travel << shift);
        Ok(Self {
            from,
            to,
            centre_x: centre_x.nm(),
            centre_z: centre_z.nm(),
            length: Length::from_nm(length as i64),
            radius: r0,
            growth: (r1 as i64).wrapping_sub(r0 as i64),
            start: start.phase(),
            sweep: if clockwise {
                (turn as i64).wrapping_neg()
            } else {
                turn as i64
            },
            inverse,
            shift,
        })
    }

    /// Length in nm.
    #[must_use]
    pub const fn length(&self) -> Length {
        self.length
    }

    /// Start of the arc.
    #[must_use]
    pub const fn start(&self) -> Position {
        self.from
    }

    /// End of the arc.
    #[must_use]
    pub const fn end(&self) -> Position {
        self.to
    }

    /// The curvature figures of this arc.
    #[must_use]
    pub fn bend(&self) -> Bend {
        let length = self.length.nm() as u64;
        // Radians in 2⁻⁵⁹: 2⁻⁶³ turns · 2⁻⁶⁰.
        let angle = mul_high(self.sweep.unsigned_abs() << 1, TAU).max(1);
        let radius = mul_div(length, 1 << 59, angle).max(1);
        // r/radius + 3·growth/length; both in 2⁻²⁰ nm over nm, so 2⁻³² takes another 12 bits. Rounded up.
        let widest = self
            .radius
            .max(self.radius.saturating_add_signed(self.growth));
        let round = mul_div(widest, 1 << 12, radius);
        let growing = mul_div(self.growth.unsigned_abs(), 3 << 12, length);
        let stretch = round.saturating_add(growing).saturating_add(2);
        Bend {
            radius,
            stretch: stretch.max(1 << 32),
        }
    }

    /// The directions at its beginning and its end.
    pub(super) fn headings(&self) -> [Heading; 2] {
        let length = (self.length.nm() as u64).max(1);
        // The growth of the radius, over the length.
        let doubt = mul_div(self.growth.unsigned_abs(), 1 << 10, length);
        [self.from, self.to].map(|place| {
            let x = place.x.nm().wrapping_sub(self.centre_x);
            let z = place.z.nm().wrapping_sub(self.centre_z);
            // At a right angle to the radius, on the side to which the arc turns.
            if self.sweep < 0 {
                Heading::of(z.wrapping_neg(), x, doubt)
            } else {
                Heading::of(z, x.wrapping_neg(), doubt)
            }
        })
    }

    /// The position at `travel`, rounded to the nearest nm. From the length on this is the end.
    #[must_use]
    pub fn at(&self, travel: Travel) -> Position {
        if travel >= Travel::of(self.length) {
            return self.to;
        }
        // Part of the length covered, 2⁻⁶³.
        let share = mul_high(travel.raw() << self.shift, self.inverse);
        let turned = (mul_high(self.sweep.unsigned_abs() << 1, share) << 2) as i64;
        let phase = self.start.turned(if self.sweep < 0 {
            turned.wrapping_neg()
        } else {
            turned
        });
        let grown = (mul_high(self.growth.unsigned_abs() << 1, share)) as i64;
        let radius = self.radius.wrapping_add_signed(if self.growth < 0 {
            grown.wrapping_neg()
        } else {
            grown
        });
        let (sin, cos) = phase.sin_cos();
        Position {
            x: Length::from_nm(self.centre_x.wrapping_add(component(radius, sin))),
            z: Length::from_nm(self.centre_z.wrapping_add(component(radius, cos))),
            c: self.from.c,
        }
    }
}

/// `radius` (2⁻²⁰ nm) times `factor` (2⁻⁶²), rounded to the nearest nm.
#[inline]
const fn component(radius: u64, factor: i64) -> i64 {
    let size = (mul_high(radius, factor.unsigned_abs()).wrapping_add(1 << 17) >> 18) as i64;
    if factor < 0 {
        size.wrapping_neg()
    } else {
        size
    }
}

/// A turn in 2⁻⁶² turns.
const FULL: u64 = 1 << 62;

/// A vector from the centre to a point.
struct Ray {
    x: i64,
    z: i64,
}

impl Ray {
    fn new(x: Length, z: Length) -> Option<Self> {
        (x.is_in_range() && z.is_in_range()).then_some(Self {
            x: x.nm(),
            z: z.nm(),
        })
    }

    /// The length of the vector in 2⁻²⁰ nm: below 2⁶³.
    fn radius(&self) -> u64 {
        plane::length(self.x.unsigned_abs() << 20, self.z.unsigned_abs() << 20)
    }

    fn phase(&self) -> Direction {
        Direction::of_vector(self.z, self.x)
    }

    /// The turn from this vector to `other`, from +Z to +X, in 2⁻⁶² turns; a full turn if both have the same direction.
    /// The sign of the cross product is exact, so it decides between almost no turn and almost a full turn.
    fn sweep_to(&self, other: &Self) -> u64 {
        let between = other.phase().raw().wrapping_sub(self.phase().raw());
        let (from, to) = ((self.z, self.x), (other.z, other.x));
        let between = match (plane::side(from, to), plane::ahead(from, to) > 0) {
            (0, true) => return FULL,
            (0, false) => 1 << 63,
            (1, true) => (between as i64).max(1) as u64,
            (_, true) => (between as i64).min(-1) as u64,
            (_, false) => between,
        };
        between >> 2
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests {
    extern crate std;
    use super::*;
    use crate::units::Angle;
    use std::f64::consts::TAU;

    fn position(x: i64, z: i64) -> Position {
        Position {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
            c: Angle::from_udeg(77),
        }
    }

    fn arc(
        from: (i64, i64),
        to: (i64, i64),
        ik: (i64, i64),
        clockwise: bool,
    ) -> Result<Arc, ArcError> {
        Arc::new(
            position(from.0, from.1),
            position(to.0, to.1),
            Length::from_nm(ik.0),
            Length::from_nm(ik.1),
            clockwise,
        )
    }

    fn at_share(arc: &Arc, part: u64, of: u64) -> (i64, i64) {
        let at = arc.at(Travel::from_raw(Travel::of(arc.length()).raw() / of * part));
        (at.x.nm(), at.z.nm())
    }

    #[test]
    fn a_ball_nose_is_g03() {
        // From the tip of a ball of 10 mm radius to its equator: X0 Z0 to X10 (radius) Z-10.
        let nose = arc((0, 0), (10_000_000, -10_000_000), (0, -10_000_000), false).unwrap();
        assert_eq!(nose.length(), Length::from_nm(15_707_964));
        assert_eq!(at_share(&nose, 1, 2), (7_071_068, -2_928_932));
        // The other way round the arc is three quarters of a turn, through the back.
        let back = arc((0, 0), (10_000_000, -10_000_000), (0, -10_000_000), true).unwrap();
        assert_eq!(back.length(), Length::from_nm(47_123_890));
        assert_eq!(at_share(&back, 1, 3), (-10_000_000, -10_000_000));
    }

    #[test]
    fn the_same_point_again_is_a_full_turn() {
        for clockwise in [false, true] {
            let turn = arc((5_000, 0), (5_000, 0), (-5_000, 0), clockwise).unwrap();
            assert_eq!(turn.length(), Length::from_nm(31_416));
            let side = if clockwise { 5_000 } else { -5_000 };
            assert_eq!(at_share(&turn, 1, 4), (0, side));
            assert_eq!(at_share(&turn, 2, 4), (-5_000, 0));
        }
    }

    #[test]
    fn half_turns_are_told_apart() {
        let under = arc((0, 1_000_000), (0, -1_000_000), (0, -1_000_000), true).unwrap();
        assert_eq!(at_share(&under, 1, 2), (-1_000_000, 0));
        let over = arc((0, 1_000_000), (0, -1_000_000), (0, -1_000_000), false).unwrap();
        assert_eq!(at_share(&over, 1, 2), (1_000_000, 0));
    }

    #[test]
    fn a_nanometre_is_not_a_turn() {
        let metre = 1_000_000_000;
        let short = arc((0, metre), (1, metre), (0, -metre), false).unwrap();
        assert_eq!(short.length(), Length::from_nm(1));
        let long = arc((0, metre), (1, metre), (0, -metre), true).unwrap();
        assert_eq!(long.length(), Length::from_nm(6_283_185_307));
    }

    #[test]
    fn what_is_no_arc_is_refused() {
        let nm = Length::from_nm;
        assert_eq!(arc((0, 0), (5, 5), (0, 0), true), Err(ArcError::NoRadius));
        assert_eq!(
            arc((0, 0), (0, 900), (0, 900), true),
            Err(ArcError::NoRadius)
        );
        assert_eq!(
            arc((0, 1_000_000), (0, -1_020_000), (0, -1_000_000), true),
            Err(ArcError::NotOnCircle(nm(1_000_000), nm(1_020_000)))
        );
        assert!(arc((0, 1_000_000), (0, -1_010_000), (0, -1_000_000), true).is_ok());
        assert_eq!(
            arc((0, 0), (0, 10), (0, 1 << 43), true),
            Err(ArcError::TooFar)
        );
        let mut to = position(0, -1_000);
        to.c = Angle::ZERO;
        assert_eq!(
            Arc::new(position(0, 1_000), to, nm(0), nm(-1_000), true),
            Err(ArcError::MovesC)
        );
    }

    /// Random arcs up to 1 m of radius, with ends off the circle within the tolerance.
    #[test]
    fn meets_both_ends_and_the_circle_between() {
        leadscrew_seed::volume(3, |seed| {
            let mut random = leadscrew_seed::Random(seed);
            let mut random = move |range: i64| random.below(range as u64) as i64;
            let mut worst = 0.0_f64;
            for round in 0..20_000 {
                let size = 10_i64.pow(3 + round % 7);
                let radius = 40 + random(size - 40);
                let (from_angle, to_angle) = (random(1 << 30), random(1 << 30));
                let off = random((radius / 8).min(9_000) + 1) as f64;
                let point = |angle: i64, radius: f64| {
                    let (sin, cos) = (angle as f64 / (1 << 30) as f64 * TAU).sin_cos();
                    ((radius * sin).round() as i64, (radius * cos).round() as i64)
                };
                let (centre_x, centre_z) =
                    (random(1 << 30) - (1 << 29), random(1 << 30) - (1 << 29));
                let (a, b) = (
                    point(from_angle, radius as f64),
                    point(to_angle, radius as f64 + off),
                );
                let clockwise = random(2) == 0;
                let arc = arc(
                    (centre_x + a.0, centre_z + a.1),
                    (centre_x + b.0, centre_z + b.1),
                    (-a.0, -a.1),
                    clockwise,
                )
                .unwrap();
                assert_eq!(arc.at(Travel::ZERO), arc.from);
                let full = Travel::of(arc.length());
                assert_eq!(arc.at(full), arc.to);
                assert_eq!(arc.at(Travel::from_raw(full.raw() - 1)), arc.to);

                // The exact circle in floats: at 10⁹ nm their resolution is 10⁻⁷ nm.
                let hypot = |p: (i64, i64)| (p.0 as f64).hypot(p.1 as f64);
                let start = (a.0 as f64).atan2(a.1 as f64);
                let turn = ((b.0 as f64).atan2(b.1 as f64) - start).rem_euclid(TAU);
                let turn = if clockwise { turn - TAU } else { turn };
                for _ in 0..8 {
                    let travel = full.raw() / 1_000 * random(1_000) as u64;
                    let share = travel as f64 / full.raw() as f64;
                    let at = arc.at(Travel::from_raw(travel));
                    let r = hypot(a) + (hypot(b) - hypot(a)) * share;
                    let (sin, cos) = (start + turn * share).sin_cos();
                    if a == b || turn.abs() < 1e-9 || TAU - turn.abs() < 1e-9 {
                        continue;
                    }
                    worst = worst
                        .max((at.x.nm() as f64 - centre_x as f64 - r * sin).abs())
                        .max((at.z.nm() as f64 - centre_z as f64 - r * cos).abs());
                }
            }
            assert!(worst < 0.500_01, "{worst}");
        });
    }
}
