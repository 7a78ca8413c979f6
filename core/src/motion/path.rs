//! Where a distance along a path is.

use super::arc::Arc;
use super::line::Line;
use super::rate::Travel;
use crate::program::Position;
use crate::units::Length;

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

    /// The position at `travel`: the start at zero and the end from the length on, exactly; between them rounded to the
    /// nearest nanometre (µ°).
    #[must_use]
    pub fn at(&self, travel: Travel) -> Position {
        match self {
            Self::Line(line) => line.at(travel),
            Self::Arc(arc) => arc.at(travel),
        }
    }

    /// Where it starts.
    #[must_use]
    pub const fn start(&self) -> Position {
        match self {
            Self::Line(line) => line.start(),
            Self::Arc(arc) => arc.start(),
        }
    }

    /// Where it ends.
    #[must_use]
    pub const fn end(&self) -> Position {
        match self {
            Self::Line(line) => line.end(),
            Self::Arc(arc) => arc.end(),
        }
    }
}
