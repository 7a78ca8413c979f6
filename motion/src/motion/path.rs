//! The path of a time-driven move: from a distance along the path to a position.

use super::arc::Arc;
use super::line::Line;
use super::rate::Travel;
use crate::call::Position;
use crate::units::{Length, mul_div, plane, root};

/// The direction of a path at one of its ends: X and Z of a vector of length 1, in 2⁻³⁰.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heading {
    x: i64,
    z: i64,
    /// The most by which the true direction differs.
    doubt: u64,
}

impl Heading {
    /// No direction.
    pub const NONE: Self = Self {
        x: 0,
        z: 0,
        doubt: 0,
    };

    /// The direction of the vector (`x`, `z`), in nm.
    pub(super) fn of(x: i64, z: i64, doubt: u64) -> Self {
        let length = plane::length_up(x.unsigned_abs(), z.unsigned_abs()).max(1);
        let part = |way: i64| {
            let part = mul_div(way.unsigned_abs(), 1 << 30, length) as i64;
            if way < 0 { part.wrapping_neg() } else { part }
        };
        Self {
            x: part(x),
            z: part(z),
            // A short vector has a rough length.
            doubt: doubt.saturating_add(mul_div(2, 1 << 30, length)),
        }
    }

    /// The length of the difference between both directions, in 2⁻³⁰, rounded up.
    #[must_use]
    pub fn turn_from(&self, before: &Self) -> u64 {
        let (x, z) = (self.x.abs_diff(before.x), self.z.abs_diff(before.z));
        // Both are at most 2³¹.
        let square = x.wrapping_mul(x).wrapping_add(z.wrapping_mul(z));
        root(square)
            .saturating_add(2)
            .saturating_add(self.doubt)
            .saturating_add(before.doubt)
    }
}

/// A path in space, driven by the distance covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// Straight.
    Line(Line),
    /// Circular in X–Z.
    Arc(Arc),
}

impl Path {
    /// Length of the path.
    #[must_use]
    pub const fn length(&self) -> Length {
        match self {
            Self::Line(line) => line.length(),
            Self::Arc(arc) => arc.length(),
        }
    }

    /// The directions of X and Z at its beginning and its end.
    #[must_use]
    pub fn headings(&self) -> [Heading; 2] {
        match self {
            Self::Line(line) => {
                let (from, to) = (line.start(), line.end());
                let heading = Heading::of((to.x - from.x).nm(), (to.z - from.z).nm(), 0);
                [heading, heading]
            }
            Self::Arc(arc) => arc.headings(),
        }
    }

    /// The position at `travel`. It is exactly the start at zero and exactly the end from the length on; between them
    /// it is rounded to the nearest nanometre (µ°).
    #[inline]
    #[must_use]
    pub fn at(&self, travel: Travel) -> Position {
        match self {
            Self::Line(line) => line.at(travel),
            Self::Arc(arc) => arc.at(travel),
        }
    }

    /// Start of the path.
    #[must_use]
    pub const fn start(&self) -> Position {
        match self {
            Self::Line(line) => line.start(),
            Self::Arc(arc) => arc.start(),
        }
    }

    /// End of the path.
    #[must_use]
    pub const fn end(&self) -> Position {
        match self {
            Self::Line(line) => line.end(),
            Self::Arc(arc) => arc.end(),
        }
    }
}
