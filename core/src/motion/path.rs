//! The path of a time-driven move: from a distance along the path to a position.

use super::arc::Arc;
use super::line::Line;
use super::rate::Travel;
use crate::call::Position;
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

    /// The position at `travel`. It is exactly the start at zero and exactly the end from the length on; between them
    /// it is rounded to the nearest nanometre (µ°).
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
