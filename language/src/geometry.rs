//! Plane geometry of paths: directions, offsets, and where two lines or circles meet.
//!
//! Points are exact (nanometres in whole numbers). A calculation takes one of them as its origin, so that its
//! floating
//! numbers are small, and its result is rounded to a nanometre once. Z points to the right and X upwards, as
//! the trade draws
//! it; "left" is left of the direction of travel.
//!
//! This module must not know what a path is for: no tool, no dialect, no alarm.

use std::f64::consts::TAU;
use std::ops::{Add, Mul, Neg, Sub};

use leadscrew_core::units::Length;

use crate::plane::{Element, Point, Shape};

/// A place or a direction; nanometres where it is a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct V {
    /// Along the spindle.
    pub z: f64,
    /// Radius.
    pub x: f64,
}

impl V {
    /// Of two components.
    #[must_use]
    pub const fn new(z: f64, x: f64) -> Self {
        Self { z, x }
    }

    /// From `origin` to `point`; exact below 2⁵³ nm.
    #[must_use]
    pub fn between(origin: Point, point: Point) -> Self {
        Self {
            z: (point.z - origin.z).nm() as f64,
            x: (point.x - origin.x).nm() as f64,
        }
    }

    /// The point at this place, seen from `origin`, to the nearest nanometre.
    #[must_use]
    pub fn from(self, origin: Point) -> Point {
        Point {
            x: origin.x + nearest(self.x),
            z: origin.z + nearest(self.z),
        }
    }

    /// Scalar product.
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        self.z * other.z + self.x * other.x
    }

    /// Above zero where `other` points to the left of `self`.
    #[must_use]
    pub fn cross(self, other: Self) -> f64 {
        self.z * other.x - self.x * other.z
    }

    /// Length.
    #[must_use]
    pub fn length(self) -> f64 {
        libm::sqrt(self.dot(self))
    }

    /// Of length 1; zero stays zero.
    #[must_use]
    pub fn unit(self) -> Self {
        let length = self.length();
        if length > 0.0 {
            self * (1.0 / length)
        } else {
            self
        }
    }

    /// Turned by a quarter to the left.
    #[must_use]
    pub fn left(self) -> Self {
        Self::new(-self.x, self.z)
    }

    /// The angle from `self` to `other`, −π to π, positive to the left.
    #[must_use]
    pub fn turn(self, other: Self) -> f64 {
        libm::atan2(self.cross(other), self.dot(other))
    }
}

impl Add for V {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.z + other.z, self.x + other.x)
    }
}

impl Sub for V {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.z - other.z, self.x - other.x)
    }
}

impl Neg for V {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.z, -self.x)
    }
}

impl Mul<f64> for V {
    type Output = Self;
    fn mul(self, by: f64) -> Self {
        Self::new(self.z * by, self.x * by)
    }
}

/// The nearest whole number of nanometres.
#[must_use]
pub fn nearest(nm: f64) -> Length {
    Length::from_nm(libm::round(nm) as i64)
}

/// An element with its start, seen from an origin.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Where it begins.
    pub start: V,
    /// Where it ends.
    pub end: V,
    /// Its circle; `None` for a straight line.
    pub bend: Option<Bend>,
}

/// The circle of an arc.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    /// Its centre.
    pub centre: V,
    /// G02, else G03.
    pub clockwise: bool,
}

impl Piece {
    /// `element`, which begins at `start`, seen from `origin`.
    #[must_use]
    pub fn new(origin: Point, start: Point, element: &Element) -> Self {
        let bend = match element.shape {
            Shape::Rapid | Shape::Line => None,
            Shape::Arc { i, k, clockwise } => Some(Bend {
                centre: V::between(origin, arc_centre(start, i, k)),
                clockwise,
            }),
        };
        Self {
            start: V::between(origin, start),
            end: V::between(origin, element.end),
            bend,
        }
    }

    /// Direction of travel at a place of the path, length 1.
    #[must_use]
    pub fn direction(&self, at: V) -> V {
        match self.bend {
            None => (self.end - self.start).unit(),
            Some(bend) => bend.direction(at),
        }
    }

    /// Direction at the start.
    #[must_use]
    pub fn first(&self) -> V {
        self.direction(self.start)
    }

    /// Direction at the end.
    #[must_use]
    pub fn last(&self) -> V {
        self.direction(self.end)
    }

    /// How far the direction turns on the way, in radians, positive to the left. An arc that ends where it
    /// begins is a
    /// full circle.
    #[must_use]
    pub fn turning(&self) -> f64 {
        let Some(bend) = self.bend else { return 0.0 };
        let turn = bend.hand() * (self.start - bend.centre).turn(self.end - bend.centre);
        let is_full = self.start == self.end;
        let turn = if turn < 0.0 || is_full {
            turn + TAU
        } else {
            turn
        };
        bend.hand() * turn
    }

    /// One over the radius at `at`, positive where the path bends to the left.
    #[must_use]
    pub fn curvature(&self, at: V) -> f64 {
        self.bend
            .map_or(0.0, |bend| bend.hand() / (at - bend.centre).length())
    }

    /// The endless line or circle of this piece, `offset` to its left, with the radius that it has at `at`.
    /// `None` where
    /// the offset is larger than the radius.
    #[must_use]
    pub fn carrier(&self, at: V, offset: f64) -> Option<Carrier> {
        match self.bend {
            None => {
                let along = self.first();
                Some(Carrier::Line {
                    at: at + along.left() * offset,
                    along,
                })
            }
            Some(bend) => {
                let radius = (at - bend.centre).length() - bend.hand() * offset;
                (radius >= 0.0).then_some(Carrier::Circle { bend, radius })
            }
        }
    }
}

impl Bend {
    /// 1 for a circle to the left, −1 for one to the right.
    #[must_use]
    pub const fn hand(self) -> f64 {
        if self.clockwise { -1.0 } else { 1.0 }
    }

    /// Direction of travel at a place.
    #[must_use]
    pub fn direction(self, at: V) -> V {
        (at - self.centre).left().unit() * self.hand()
    }
}

/// The centre of an arc.
#[must_use]
pub fn arc_centre(start: Point, i: Length, k: Length) -> Point {
    Point {
        x: start.x + i,
        z: start.z + k,
    }
}

/// An endless line, or a whole circle, with its direction.
#[derive(Clone, Copy, Debug)]
pub enum Carrier {
    /// A line.
    Line {
        /// One of its points.
        at: V,
        /// Its direction, length 1.
        along: V,
    },
    /// A circle.
    Circle {
        /// Centre and hand.
        bend: Bend,
        /// Its radius, nm.
        radius: f64,
    },
}

/// How far two carriers may miss each other, nm, and still touch: the error of the calculation.
const TOUCH: f64 = 0.01;

/// Where a path goes from `a` over to `b`. Two carriers meet in two points at most; a path that turns to the left
/// (`turn` > 0) changes over in one of them, a path that turns to the right in the other. `None` where they do
/// not meet.
#[must_use]
pub fn meet(a: Carrier, b: Carrier, turn: f64) -> Option<V> {
    use Carrier::{Circle, Line};
    match (a, b) {
        (Line { at, along }, Line { at: on, along: to }) => {
            let sine = along.cross(to);
            (sine != 0.0).then(|| at + along * ((on - at).cross(to) / sine))
        }
        // The line crosses the circle twice. Entering a circle to the left, one turns to the right into it.
        (Line { at, along }, Circle { bend, radius }) => {
            let way = chord(at, along, bend, radius)?;
            Some(way.middle + along * (way.half * (turn * bend.hand()).signum()))
        }
        (Circle { bend, radius }, Line { at, along }) => {
            let way = chord(at, along, bend, radius)?;
            Some(way.middle - along * (way.half * (turn * bend.hand()).signum()))
        }
        (Circle { bend: p, radius: r }, Circle { bend: q, radius: s }) => {
            let apart = q.centre - p.centre;
            let distance = apart.length();
            if distance == 0.0 {
                return None;
            }
            let along = apart * (1.0 / distance);
            let to_chord = (distance * distance + (r - s) * (r + s)) / (2.0 * distance);
            let half = half_chord(r, to_chord)?;
            let side = along.left() * half;
            let foot = p.centre + along * to_chord;
            // The directions cross the same way in one of the two points.
            let left = foot + side;
            let sine = p.hand() * q.hand() * (left - p.centre).cross(left - q.centre);
            Some(if sine * turn >= 0.0 {
                left
            } else {
                foot - side
            })
        }
    }
}

struct Chord {
    middle: V,
    half: f64,
}

fn chord(at: V, along: V, bend: Bend, radius: f64) -> Option<Chord> {
    let middle = at + along * (bend.centre - at).dot(along);
    let half = half_chord(radius, (middle - bend.centre).length())?;
    Some(Chord { middle, half })
}

/// Half of the chord at `distance` from the centre.
fn half_chord(radius: f64, distance: f64) -> Option<f64> {
    let distance = libm::fabs(distance);
    let inside = radius - distance;
    if inside < -TOUCH {
        return None;
    }
    Some(libm::sqrt((inside * (radius + distance)).max(0.0)))
}

/// Room for the error of the calculation where an angle is compared, radians.
const ANGLE: f64 = 1e-9;

impl Piece {
    /// The distance of a place from this piece, nm.
    #[must_use]
    pub fn distance(&self, to: V) -> f64 {
        let ends = (to - self.start).length().min((to - self.end).length());
        match self.bend {
            None => {
                let along = self.first();
                let way = (to - self.start).dot(along);
                let length = (self.end - self.start).length();
                if length == 0.0 || way < 0.0 || way > length {
                    return ends;
                }
                libm::fabs((to - self.start).cross(along))
            }
            Some(bend) => {
                let radius = (self.start - bend.centre).length();
                if self.sweeps(to) {
                    ends.min(libm::fabs((to - bend.centre).length() - radius))
                } else {
                    ends
                }
            }
        }
    }

    /// The smallest distance between two pieces, nm.
    #[must_use]
    pub fn clearance(&self, other: &Self) -> f64 {
        if self.crosses(other) {
            return 0.0;
        }
        let own = self.near(other).into_iter().flatten();
        let own = own.map(|place| other.distance(place));
        let others = other.near(self).into_iter().flatten();
        let others = others.map(|place| self.distance(place));
        own.chain(others).fold(f64::INFINITY, f64::min)
    }

    /// True where the ray from the centre of this arc to `to` meets the arc.
    fn sweeps(&self, to: V) -> bool {
        self.bend.is_some_and(|bend| {
            let turn = bend.hand() * (self.start - bend.centre).turn(to - bend.centre);
            let turn = if turn < -ANGLE { turn + TAU } else { turn };
            turn <= libm::fabs(self.turning()) + ANGLE
        })
    }

    /// The places of this piece that can be nearest to another which it does not cross.
    fn near(&self, other: &Self) -> [Option<V>; 4] {
        let [one, two] = match (self.bend, other.bend) {
            (None, None) => [None; 2],
            (None, Some(bend)) => {
                let along = self.first();
                let way = (bend.centre - self.start).dot(along);
                let within = way > 0.0 && way < (self.end - self.start).length();
                [within.then(|| self.start + along * way), None]
            }
            (Some(bend), _) => {
                let axis = match other.bend {
                    None => other.first().left(),
                    Some(to) => (to.centre - bend.centre).unit(),
                };
                let radius = axis * (self.start - bend.centre).length();
                [bend.centre + radius, bend.centre - radius]
                    .map(|place| self.sweeps(place).then_some(place))
            }
        };
        [Some(self.start), Some(self.end), one, two]
    }

    fn crosses(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (
            self.carrier(self.start, 0.0),
            other.carrier(other.start, 0.0),
        ) else {
            return false;
        };
        [1.0, -1.0].into_iter().any(|turn| {
            meet(a, b, turn)
                .is_some_and(|at| self.distance(at) <= TOUCH && other.distance(at) <= TOUCH)
        })
    }
}
