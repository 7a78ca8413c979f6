//! The words of a groove, resolved: G75 ([G75 sheet]), and G74, its twin along Z.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::{FeedRate, Position, TapAxis};
use crate::alarm::At;
use crate::units::Length;

/// A G75 or G74 cycle with every word resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct GrooveCall {
    /// The axis of the pecks: X in G75, Z in G74. The columns lie side by side along the other.
    pub axis: TapAxis,
    /// A: where the tool stands.
    pub start: Position,
    /// End point, X word (radius): bottom in G75, last column in G74. Equal to the start where X is not written.
    pub end_x: At<Length>,
    /// End point, Z word: last column in G75, bottom in G74. Equal to the start where Z is not written.
    pub end_z: At<Length>,
    /// True where the last column is written (decides the side of the relief, [G75 sheet], step 4).
    pub last_written: bool,
    /// The peck (P of G75, Q of G74), on the radius, positive; `None` where it is missing.
    pub peck: Option<At<Length>>,
    /// The step to the next column (Q of G75, P of G74), on the radius, positive; `None` where it is missing.
    pub step: Option<At<Length>>,
    /// Δd: relief at the bottom across the pecks, not negative.
    pub relief: At<Length>,
    /// e: retract between pecks, not negative.
    pub retract: At<Length>,
    /// Speed of the pecks.
    pub feed: FeedRate,
}

impl GrooveCall {
    /// The bottom of the pecks, on their axis.
    #[must_use]
    pub const fn bottom(&self) -> &At<Length> {
        match self.axis {
            TapAxis::X => &self.end_x,
            TapAxis::Z => &self.end_z,
        }
    }

    /// The last column, on the other axis.
    #[must_use]
    pub const fn last(&self) -> &At<Length> {
        match self.axis {
            TapAxis::X => &self.end_z,
            TapAxis::Z => &self.end_x,
        }
    }

    /// Where the pecks begin, on their axis.
    #[must_use]
    pub const fn level(&self) -> Length {
        self.axis.of(self.start)
    }

    /// The first column, on the other axis.
    #[must_use]
    pub const fn first(&self) -> Length {
        self.axis.other().of(self.start)
    }

    /// The letters of bottom, peck and step where the pecks go along `axis`.
    #[must_use]
    pub const fn letters(axis: TapAxis) -> [u8; 3] {
        match axis {
            TapAxis::X => *b"XPQ",
            TapAxis::Z => *b"ZQP",
        }
    }

    /// The place at `depth` on the axis of the pecks and `column` on the other.
    #[must_use]
    pub const fn place(&self, depth: Length, column: Length) -> Position {
        let place = self.axis.with(self.start, depth);
        self.axis.other().with(place, column)
    }
}
