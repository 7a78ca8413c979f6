//! The words of G71 and G72, as lengths.

use leadscrew_core::alarm::{At, Span};
use leadscrew_core::units::{Diameter, Length};

use crate::plane::Point;

/// What stays on the contour for the finishing cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allowance {
    /// Δu: a signed diameter.
    pub x: Diameter,
    /// Δw: signed.
    pub z: Length,
}

impl Allowance {
    /// Nothing.
    pub const NONE: Self = Self {
        x: Diameter::from_nm(0),
        z: Length::ZERO,
    };

    /// That along the strokes.
    pub(super) const fn along(&self, strokes: Along) -> Length {
        match strokes {
            Along::Z => self.z,
            Along::X => self.x.radius(),
        }
    }

    /// Both of them.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            x: Diameter::from_nm(self.x.nm().saturating_add(other.x.nm())),
            z: self.z + other.z,
        }
    }

    /// `point` on the contour, moved by the allowance.
    pub(super) fn shift(&self, point: Point) -> Point {
        Point {
            x: point.x + self.x.radius(),
            z: point.z + self.z,
        }
    }
}

/// Where the strokes of a roughing cycle go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// G71: along Z; X feeds in.
    Z,
    /// G72: along X; Z feeds in.
    X,
}

impl Along {
    /// The coordinates of `point`, nm: that of the infeed first, then that of the strokes.
    pub(super) const fn split(self, point: Point) -> (i64, i64) {
        match self {
            Self::Z => (point.x.nm(), point.z.nm()),
            Self::X => (point.z.nm(), point.x.nm()),
        }
    }

    /// The letter of the axis of the infeed, or of the strokes.
    pub(super) const fn letter(self, infeed: bool) -> u8 {
        match (self, infeed) {
            (Self::Z, true) | (Self::X, false) => b'X',
            (Self::Z, false) | (Self::X, true) => b'Z',
        }
    }
}

/// The words of G71 or G72.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Roughing {
    /// Δd: the depth of a stroke; a radius in G71.
    pub depth: At<Length>,
    /// e: how far a stroke retracts at 45°; a radius.
    pub retract: At<Length>,
    /// True where the retract is at feed, else it is at rapid.
    pub retract_feeds: bool,
    /// Δu, Δw.
    pub allowance: Allowance,
    /// I, K: what the strokes leave besides, for the last pass along the contour.
    pub left: Allowance,
    /// True where the contour is cut with its allowance after the strokes.
    pub semi_finish: bool,
    /// How far the contour may turn back and still counts as monotonic.
    pub tolerance: Length,
    /// The word that the strokes come from.
    pub span: Span,
}
