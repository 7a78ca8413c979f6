//! One [`Move`]: what the planner gets and `expand` prints.

use crate::alarm::Span;
use crate::program::{Aux, FeedRate, Position};
use crate::units::{Lead, Length, Millis, Rpm, StartAngle};

/// One move, with where it ends and where it came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// The block (its G word).
    pub span: Span,
    /// End point in machine coordinates (the standing position where nothing moves).
    pub to: Position,
    /// How to get there.
    pub kind: MoveKind,
    /// Its place in a cycle; `None` outside cycles.
    pub tag: Option<Tag>,
}

/// How a move gets to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MoveKind {
    /// Straight, as fast as the axes allow, all arriving together.
    Rapid,
    /// Straight, at a feed.
    Feed(FeedRate),
    /// Circular in X–Z.
    Arc {
        /// Centre minus start on the radius.
        i: Length,
        /// Centre minus start along Z.
        k: Length,
        /// G02.
        clockwise: bool,
        /// Path speed.
        feed: FeedRate,
    },
    /// Straight, locked to the spindle angle.
    Thread(ThreadMove),
    /// Standing still.
    Dwell(Millis),
    /// Spindle to a speed.
    Spindle(Rpm),
    /// Machine function.
    Aux(Aux),
}

/// A synchronous move. The one to three of a pass (run-in, stroke, run-out) are one motion: the axis leaves rest at the
/// first one's start and comes to rest at the last one's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadMove {
    /// Long-axis travel per turn.
    pub lead: Lead,
    /// Start angle of the pass: where the exact helix stands at the start of its **first** move.
    pub pass_angle: StartAngle,
    /// Where the exact helix stands at the start of this move, in millionths of a degree after the index,
    /// 0…359 999 999.
    pub angle_udeg: u32,
    /// True where X is the long axis (lead on the radius).
    pub long_x: bool,
    /// True for the last move of the pass (the run-out, or the stroke where there is none).
    pub last: bool,
    /// Commanded spindle speed, signed.
    pub rpm: Rpm,
}

/// Place of a move in its cycle; the fields are those of the move list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tag {
    /// The cycle.
    pub cycle: Cycle,
    /// Depth number from 1 (threads), column from 1 (G75).
    pub pass: u32,
    /// Thread start from 1; 0 where it does not apply.
    pub start: u8,
    /// Feed within the column from 1; 0 where it does not apply.
    pub peck: u32,
    /// What the move is for.
    pub stage: Stage,
    /// Depth of the pass below the crest (threads), radius depth at the end of the move (G75).
    pub depth: Length,
}

/// The cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// Radial grooving.
    G75,
    /// Multiple threading.
    G76,
    /// Enhanced multiple threading.
    G78,
}

/// What a move in a cycle is for (cli.md, stages).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Rapid to B.
    Approach,
    /// Synchronous way to the pass's line.
    RunIn,
    /// Rough stroke.
    Rough,
    /// Finishing stroke.
    Finish,
    /// Chamfer at the end of the thread.
    RunOut,
    /// Rapid X out (threads), back by e or to the start level (G75).
    Retract,
    /// Rapid back to the start along Z.
    Return,
    /// Cut of a groove.
    Peck,
    /// Δd at the bottom of a groove.
    Relief,
    /// To the next column.
    Shift,
}
