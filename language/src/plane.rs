//! Paths in the plane of the tool: points and elements. X is a radius; lengths are exact nanometres.

use leadscrew_core::alarm::Span;
use leadscrew_core::units::Length;

/// A place of the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Point {
    /// Radius.
    pub x: Length,
    /// Along the spindle.
    pub z: Length,
}

impl Point {
    /// A point from nanometres.
    #[must_use]
    pub const fn from_nm(x: i64, z: i64) -> Self {
        Self {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
        }
    }
}

/// How the tool gets to the end of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A straight line at rapid.
    Rapid,
    /// A straight line that cuts.
    Line,
    /// A circle that cuts.
    Arc {
        /// Centre minus start, on the radius.
        i: Length,
        /// Centre minus start, along Z.
        k: Length,
        /// G02 (clockwise in the trade's X–Z convention), else G03.
        clockwise: bool,
    },
}

/// One piece of a path; it begins where the piece before ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Element {
    /// Where it ends.
    pub end: Point,
    /// How it gets there.
    pub shape: Shape,
    /// The word of the text it comes from.
    pub span: Span,
}
