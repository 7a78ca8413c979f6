//! The words of a thread, resolved: G76 and G78 ([G76 sheet], [G78 sheet]).

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::Position;
use crate::alarm::At;
use crate::units::{Lead, LeadChange, Length, Remainder, Rpm, StartAngle};

/// Which thread cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ThreadCycle {
    /// [G76 sheet].
    G76,
    /// [G78 sheet].
    G78,
    /// G92: one pass at D. The height is zero, and the only pass is a finishing pass.
    G92,
    /// G32: one stroke from A to D, where the tool stays; with a run-out, where that ends. All words but D, the lead and
    /// the run-out are zero.
    G32,
    /// G34: as G32, with a lead that changes and without a run-out.
    G34,
}

impl ThreadCycle {
    /// One stroke from A to D, after which the tool stays where it is.
    #[must_use]
    pub const fn is_stroke(self) -> bool {
        matches!(self, Self::G32 | Self::G34)
    }
}

/// Whether a stroke of G32 is a thread of its own, or a part of a chain: of strokes that follow each other without a stop.
/// A chain is one thread, which waits once for its start angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ChainPart {
    /// A thread of its own.
    Whole,
    /// The first stroke of a chain.
    First,
    /// A stroke between two others.
    Middle,
    /// The last stroke of a chain, with the run-out.
    Last,
}

impl ChainPart {
    /// The most strokes of a chain.
    pub const MOST: usize = 64;

    /// Begins where the stroke before ends, without a stop.
    #[must_use]
    pub const fn is_joined(self) -> bool {
        matches!(self, Self::Middle | Self::Last)
    }

    /// The next stroke begins where this one ends, without a stop.
    #[must_use]
    pub const fn goes_on(self) -> bool {
        matches!(self, Self::First | Self::Middle)
    }

    /// The same part, but another stroke follows.
    #[must_use]
    pub const fn with_next(self) -> Self {
        if self.is_joined() {
            Self::Middle
        } else {
            Self::First
        }
    }
}

/// How the tool enters from pass to pass (G78 P(r)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum CutIn {
    /// 0: down the centre, no shift along Z.
    Centre,
    /// 1: down the −Z flank.
    Left,
    /// 2: down the +Z flank.
    Right,
    /// 3: right flank and centre in turn.
    RightCentre,
    /// 4: left and right flank in turn.
    LeftRight,
    /// G76: down the flank that trails the feed, rough and finish by the depth of the pass.
    Trailing,
}

/// How depth grows from pass to pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Infeed {
    /// G78 D0: equal steps Δd.
    Equal,
    /// G76, G78 D1: √n·Δd with the smallest step Δdmin.
    Decreasing,
}

/// Run-out (chamfer) of a thread, before it is clipped at the start level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct RunOut {
    /// Displacement of the short axis (J): positive, away from the work; in a stroke of G32 along the axis, with its sign.
    pub short: At<Length>,
    /// Length on the long axis (K), positive.
    pub long: At<Length>,
    /// The part below a nanometre of a J that was computed from the lead.
    pub short_rest: Remainder,
    /// The part below a nanometre of such a K.
    pub long_rest: Remainder,
}

/// A G76, G78 or G92 cycle, or a stroke of G32 or G34, with every word resolved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct ThreadCall {
    /// Which cycle.
    pub cycle: ThreadCycle,
    /// A: where the tool stands.
    pub start: Position,
    /// D, X word (radius).
    pub end_x: At<Length>,
    /// D, Z word.
    pub end_z: At<Length>,
    /// i: radius at C minus radius at D.
    pub taper: At<Length>,
    /// k: depth on the radius, positive (G92: zero).
    pub height: At<Length>,
    /// Δd, positive (G92: zero).
    pub first_depth: At<Length>,
    /// Δdmin, not negative.
    pub min_step: At<Length>,
    /// d, not negative.
    pub allowance: At<Length>,
    /// m, finishing passes as written (0 still makes one [D3]).
    pub finish_passes: At<u8>,
    /// a, whole degrees 0…99.
    pub angle: At<u8>,
    /// D word or parameter.
    pub infeed: Infeed,
    /// P(r) of G78 or parameter.
    pub cut_in: At<CutIn>,
    /// L: starts, 1…99.
    pub starts: At<u8>,
    /// E: run-in on the radius, zero for none.
    pub run_in: At<Length>,
    /// J, K after all defaults; `None`: the thread runs to D's plane without one.
    pub run_out: Option<RunOut>,
    /// F or I; of G34 at A.
    pub lead: At<Lead>,
    /// K of G34: change of the lead per turn. None in all others.
    pub change: At<LeadChange>,
    /// Angle of the first start after the index (Q of G92, G32 and G34). Of a stroke that is joined to another: the angle
    /// at its start, which follows from the strokes before.
    pub first_angle: StartAngle,
    /// The place of a stroke of G32 in its chain; all others are whole.
    pub part: ChainPart,
    /// Input increment as a length on the radius axis of depths (IS-C metric: 100 nm): depths are rounded to it.
    pub increment: Length,
    /// Commanded spindle speed, signed; zero when it stands (`expand` does not mind).
    pub rpm: Rpm,
}

/// The start angle of start `index` of `starts`: `round(index · 360 000 / starts)` thousandths of a degree after the
/// index, ties away from zero [D8].
#[must_use]
pub const fn start_angle(index: u8, starts: u8) -> StartAngle {
    let starts = if starts == 0 { 1 } else { starts as u32 };
    let twice = (index as u32)
        .wrapping_mul(2 * StartAngle::FULL)
        .wrapping_add(starts);
    match twice.checked_div(starts.wrapping_mul(2)) {
        Some(mdeg) => StartAngle::from_mdeg(mdeg),
        None => StartAngle::INDEX,
    }
}
