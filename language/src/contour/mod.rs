//! The contour cycles: G71 and G72 (roughing), G73 (pattern repeat) and G70 (finishing).
//!
//! The interpreter turns the blocks `ns`..`nf` into a [`Contour`]. A cycle is a lazy iterator of [`Cut`]s over it. Its
//! memory is bounded by the contour, not by the number of strokes.
//!
//! Terms. `A` is where the tool stands before the cycle, `B` is the end of the first block. `C'` is the contour moved by
//! the allowances, and `A'`, `B'` are `A`, `B` moved with it. A level is a line parallel to the strokes. A pocket is a
//! part of a level that a wall of `C'` separates from the first block.
//!
//! All checks are done when a cycle is made, so an alarm comes before the first move. This module must not know words,
//! dialects or modal state.

mod finish;
mod frame;
mod make;
mod pattern;
mod profile;
mod rough;
mod tree;
mod way_back;
mod words;

#[cfg(test)]
mod tests;

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

pub use finish::Finish;
pub use pattern::{Pattern, Repeats};
pub use rough::Rough;
pub use way_back::without_way_back;
pub use words::{Allowance, Along, Roughing};

use crate::plane::{Element, Point, Shape};

/// The axes that the first block of a contour has words of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// X or U.
    pub x: bool,
    /// Z or W.
    pub z: bool,
}

/// One move of a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// The move, with the word it comes from: that of the cycle for a stroke, that of the contour for a piece of it.
    pub element: Element,
    /// The element of the contour that the move lies on, from 0.
    pub of: Option<usize>,
}

/// The blocks `ns`..`nf`, and where the tool stands before the cycle.
#[derive(Clone, Debug)]
pub struct Contour {
    start: Point,
    axes: Axes,
    elements: Vec<Element>,
}

impl Contour {
    /// The most elements a contour may have.
    pub const MAX: usize = 1000;

    /// The contour of `elements` from `start`. The first element is that of block `ns`, also where it moves nothing;
    /// `axes` are those that `ns` has words of. Each coordinate is within
    /// [`INPUT_LIMIT`](leadscrew_core::units::Length::INPUT_LIMIT), and the ends of an arc are on its circle, but for
    /// rounding to nanometres.
    ///
    /// # Errors
    /// [`Code::ContourLong`] for more than [`Contour::MAX`] elements; [`Code::ContourFirst`] where there is none, or
    /// the first is an arc or has no axis word.
    pub fn new(start: Point, axes: Axes, elements: Vec<Element>) -> Result<Self, Alarm> {
        if let Some(beyond) = elements.get(Self::MAX) {
            return Err(Alarm::new(Code::ContourLong, beyond.span)
                .with([Arg::Int(Self::MAX.cast_signed() as i64)]));
        }
        let span = elements.first().map_or(Span::default(), |ns| ns.span);
        let straight = elements
            .first()
            .is_some_and(|ns| !matches!(ns.shape, Shape::Arc { .. }));
        if !straight || !(axes.x || axes.z) {
            return Err(Alarm::new(Code::ContourFirst, span));
        }
        Ok(Self {
            start,
            axes,
            elements,
        })
    }

    /// Where the tool stands before the cycle: `A`.
    #[must_use]
    pub const fn start(&self) -> Point {
        self.start
    }

    /// The elements, in their order.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// G71 (`Along::Z`) or G72 (`Along::X`).
    ///
    /// # Errors
    /// [`Code::ContourDepth`], [`Code::ContourFirst`], [`Code::ContourTurnsBack`], [`Code::ContourPockets`],
    /// [`Code::ContourAboveStart`].
    pub fn rough(&self, along: Along, words: &Roughing) -> Result<Rough<'_>, Alarm> {
        Rough::new(self, along, words)
    }

    /// G73.
    ///
    /// # Errors
    /// [`Code::ContourDepth`] for fewer than one pass.
    pub fn pattern(&self, words: &Repeats) -> Result<Pattern<'_>, Alarm> {
        Pattern::new(self, words)
    }

    /// G70; `span` is the word that the return to `A` comes from.
    #[must_use]
    pub const fn finish(&self, span: Span) -> Finish<'_> {
        Finish::new(self, span)
    }
}
