//! The words of a groove, resolved: G75 ([G75 sheet]).

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::{FeedRate, Position};
use crate::alarm::At;
use crate::units::Length;

/// A G75 cycle with every word resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct GrooveCall {
    /// A: where the tool stands.
    pub start: Position,
    /// Bottom, X word (radius).
    pub end_x: At<Length>,
    /// Last column; equal to the start where Z is not written.
    pub end_z: At<Length>,
    /// True where Z or W is written (decides the side of the relief, [G75 sheet], step 4).
    pub z_written: bool,
    /// Δi: peck on the radius (half the P word), positive; `None` where P is missing.
    pub peck: Option<At<Length>>,
    /// Δk: step along Z, positive; `None` where Q is missing.
    pub step: Option<At<Length>>,
    /// Δd: relief at the bottom along Z, not negative.
    pub relief: At<Length>,
    /// e: retract on the radius, not negative.
    pub retract: At<Length>,
    /// Speed of the pecks.
    pub feed: FeedRate,
}
