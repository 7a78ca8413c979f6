//! One [`Move`]: what the planner gets and `expand` prints.

use crate::alarm::Span;
use crate::call::{
    Aux, ChainPart, FeedRate, Hand, Position, SpindleCall, TapAxis, TapMode, TapSpindle,
};
use crate::units::{CentiRpm, Lead, LeadChange, Length, Millis, Rpm, StartAngle, TurnRatio};

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
    /// Straight along one axis, tied to the spindle: both from one master, or the axis by the spindle's encoder.
    Tap(TapMove),
    /// Standing still.
    Dwell(Millis),
    /// Spindle to a speed, or to a stand in position mode: then with the spindle that taps written out.
    Spindle(SpindleCall),
    /// Machine function.
    Aux(Aux),
}

/// A synchronous move. The one to three of a pass (run-in, stroke, run-out) are one motion: the axis leaves rest at the
/// first one's start and comes to rest at the last one's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadMove {
    /// Long-axis travel per turn; where it changes, at the start of the pass.
    pub lead: Lead,
    /// Change of the lead per turn.
    pub change: LeadChange,
    /// Start angle of the pass: where the exact helix stands at the start of its **first** move.
    pub pass_angle: StartAngle,
    /// Where the exact helix stands at the start of this move, in millionths of a degree after the index,
    /// 0…359 999 999.
    pub angle_udeg: u32,
    /// True where X is the long axis (lead on the radius).
    pub long_x: bool,
    /// The place of a stroke of G32 in its chain. A whole chain is one motion.
    pub part: ChainPart,
    /// True for the last move of the pass (the run-out, or the stroke where there is none), or of the chain.
    pub last: bool,
    /// Commanded spindle speed, signed.
    pub rpm: Rpm,
}

/// A stroke of a tap, from rest to rest: the tap axis travels, the spindle turns with it. Seen from the angle where the
/// spindle stands while the tap is at R, the commanded angle is a pure function of the axis: `±|p − level| / lead` turns,
/// plus for a right-hand tap [G84/G88 sheet].
///
/// The strokes of a hole follow each other with nothing but a dwell between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapMove {
    /// What ties axis and spindle.
    pub mode: TapMode,
    /// The axis that travels.
    pub axis: TapAxis,
    /// The spindle that turns.
    pub spindle: TapSpindle,
    /// Tap-axis travel per turn (X: on the radius).
    pub lead: Lead,
    /// Right hand: plus on the way in.
    pub hand: Hand,
    /// Coordinate of the R plane on the tap axis, where the angles are counted from.
    pub level: Length,
    /// Coordinate of the hole's bottom on the tap axis; nothing goes beyond.
    pub bottom: Length,
    /// Turns of the spindle in this stroke, signed, exact.
    pub turns: TurnRatio,
    /// Speed of the spindle in this stroke, signed, the extraction override in it; zero for an ordinary tap whose spindle
    /// stands.
    pub speed: CentiRpm,
    /// True on the way out (its acceleration may be another, 5201.2).
    pub outward: bool,
    /// True for the first stroke of a hole: it begins at R, and the angle there is the one to count from. False where the
    /// hole goes on after K198.
    pub opens: bool,
    /// True for the last stroke of a hole: it ends at R, and the tap is out. No stroke of a K198 hole has it until the call
    /// that goes on.
    pub closes: bool,
}

/// Place of a move in its cycle; the fields are those of the move list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tag {
    /// The cycle.
    pub cycle: Cycle,
    /// Depth number from 1 (threads), column from 1 (G75), hole of the block from 1 (taps).
    pub pass: u32,
    /// Thread start from 1; 0 where it does not apply.
    pub start: u8,
    /// Feed within the column, infeed within the hole, from 1; 0 where it does not apply.
    pub peck: u32,
    /// What the move is for.
    pub stage: Stage,
    /// Depth of the pass below the crest (threads), radius depth at the end of the move (G75), depth below R at the end of
    /// the move (taps; negative above it).
    pub depth: Length,
}

/// The cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// Pecking along Z.
    G74,
    /// Radial grooving.
    G75,
    /// Multiple threading.
    G76,
    /// Enhanced multiple threading.
    G78,
    /// One pass of a thread.
    G92,
    /// One stroke of a thread.
    G32,
    /// One stroke of a thread whose lead changes.
    G34,
    /// Face tapping.
    G84,
    /// Side tapping.
    G88,
    /// The way out of a hole in which a tap was stopped.
    G30P99,
}

/// What a move in a cycle is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Rapid to B (threads), to the hole (taps).
    Approach,
    /// Synchronous way to the pass's line.
    RunIn,
    /// Rough stroke.
    Rough,
    /// Finishing stroke.
    Finish,
    /// Chamfer at the end of the thread.
    RunOut,
    /// Rapid X out (threads), back by e or to the start level (G75), back by d or to R between pecks (taps).
    Retract,
    /// Rapid back to the start along Z, to the initial level (taps).
    Return,
    /// Cut of a groove.
    Peck,
    /// Δd at the bottom of a groove.
    Relief,
    /// To the next column.
    Shift,
    /// C-axis clamp.
    Clamp,
    /// Rapid to R.
    RPlane,
    /// Infeed of a tap.
    Tap,
    /// Back into the hole between deep pecks.
    Reenter,
    /// Dwell at the bottom.
    Dwell,
    /// Out to R at the end.
    Extract,
    /// C-axis unclamp.
    Unclamp,
}
