//! The output of the program text: one [`Call`] for each action of the machine.
//!
//! All coordinates are machine coordinates, X as a radius. Word-level mistakes (missing, negative, out of the printed
//! range, twice) have been refused before a call exists. `cycle` refuses mistakes of geometry, `feasible` refuses
//! mistakes of physics.

use core::num::NonZeroU8;

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::choice::{HandChoice, SpindleChoice};
use super::tap_notes::{LengthUnit, TapNotes};
use crate::alarm::{At, Span};
use crate::units::{
    Angle, CentiRpm, Feed, FeedPerTurn, Lead, Length, Millis, Remainder, Rpm, StartAngle,
};

/// A point in machine coordinates; X is a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Position {
    /// Radius.
    pub x: Length,
    /// Along the spindle.
    pub z: Length,
    /// Rotary axis.
    pub c: Angle,
}

impl Position {
    /// The machine's zero.
    pub const ZERO: Self = Self {
        x: Length::ZERO,
        z: Length::ZERO,
        c: Angle::ZERO,
    };
}

/// One action of the machine, and its place in the text.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Call {
    /// The G (or other leading) word; its line is the block's.
    pub span: Span,
    /// Work coordinates = machine coordinates − origin; for printing only.
    pub origin: Position,
    /// The action.
    pub kind: CallKind,
}

/// The action that a call asks for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum CallKind {
    /// Straight rapid to a point (G00, G53).
    Rapid(Position),
    /// Straight cut to a point (G01).
    Line(Position, FeedRate),
    /// Circular cut in X–Z (G02, G03).
    Arc(ArcCall),
    /// Stand still (G04).
    Dwell(Millis),
    /// Spindle to a speed, or stopped (M03, M04, M05, S).
    Spindle(SpindleCall),
    /// Machine function without motion.
    Aux(Aux),
    /// G76, G78.
    Thread(ThreadCall),
    /// G75.
    Groove(GrooveCall),
    /// G84, G88.
    Tap(TapCall),
    /// G30 P99.
    TapReturn(TapReturn),
    /// M30, M02: the program is over. Also an [`Aux`] for the machine; no call follows.
    End(u16),
    /// The text is over without M30 or M02: no move, and no call follows. The program that feeds the board makes this
    /// call, not the interpreter: only the reader of the text knows that nothing more comes.
    Over,
}

/// Cutting speed on the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum FeedRate {
    /// G98.
    PerMinute(Feed),
    /// G99: the speed follows the measured spindle.
    PerTurn(FeedPerTurn, Rpm),
}

impl FeedRate {
    /// The speed at the commanded spindle speed.
    #[must_use]
    pub const fn nominal(self) -> Feed {
        match self {
            Self::PerMinute(feed) => feed,
            Self::PerTurn(feed, rpm) => feed.at(rpm),
        }
    }
}

/// A circle in the X–Z plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct ArcCall {
    /// Where it ends.
    pub end: Position,
    /// Centre minus start, on the radius.
    pub i: Length,
    /// Centre minus start, along Z.
    pub k: Length,
    /// G02 (clockwise as programmed in the trade's X–Z convention), else G03.
    pub clockwise: bool,
    /// Speed on the path.
    pub feed: FeedRate,
}

/// How a spindle uses its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum SpindleMode {
    /// It turns at it.
    #[default]
    Speed,
    /// Rigid tapping: spindle 1 is brought to a stand, and this spindle waits in position mode; it turns with the tap axis
    /// only, at most at this speed. A tap with another one (E) takes that one.
    Rigid(SpindleChoice),
}

/// A spindle command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SpindleCall {
    /// Commanded speed, signed; zero to stop. In rigid mode a minus means a left-hand tap.
    pub rpm: Rpm,
    /// Turning at that speed, or waiting for taps.
    pub mode: SpindleMode,
}

impl SpindleCall {
    /// A spindle that stands, in speed mode.
    pub const STOPPED: Self = Self::speed(Rpm::STOPPED);

    /// Turning at `rpm`.
    #[must_use]
    pub const fn speed(rpm: Rpm) -> Self {
        Self {
            rpm,
            mode: SpindleMode::Speed,
        }
    }

    /// `spindle` waiting for taps at `rpm`.
    #[must_use]
    pub const fn rigid(rpm: Rpm, spindle: SpindleChoice) -> Self {
        Self {
            rpm,
            mode: SpindleMode::Rigid(spindle),
        }
    }
}

/// A machine function that moves no axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Aux {
    /// An M code.
    M(u16),
    /// A tool call as written (`T0101` is 101).
    T(u16),
}

/// Which thread cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum ThreadCycle {
    /// [G76 sheet].
    G76,
    /// [G78 sheet].
    G78,
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
    /// Displacement of the short axis (J), positive.
    pub short: At<Length>,
    /// Length on the long axis (K), positive.
    pub long: At<Length>,
    /// The part below a nanometre of a J that was computed from the lead.
    pub short_rest: Remainder,
    /// The part below a nanometre of such a K.
    pub long_rest: Remainder,
}

/// A G76 or G78 cycle with every word resolved.
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
    /// k: depth on the radius, positive.
    pub height: At<Length>,
    /// Δd, positive.
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
    /// F or I.
    pub lead: At<Lead>,
    /// Input increment as a length on the radius axis of depths (IS-C metric: 100 nm): depths are rounded to it.
    pub increment: Length,
    /// Commanded spindle speed, signed; zero when it stands (`expand` does not mind).
    pub rpm: Rpm,
}

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

/// Which tapping cycle [G84/G88 sheet].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TapCycle {
    /// Face.
    G84,
    /// Side.
    G88,
}

/// The linear axis that carries a tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum TapAxis {
    /// Lead and travel are on the radius.
    X,
    /// Along the spindle.
    Z,
}

impl TapAxis {
    /// The coordinate of this axis.
    #[must_use]
    pub const fn of(self, position: Position) -> Length {
        match self {
            Self::X => position.x,
            Self::Z => position.z,
        }
    }

    /// `position` with this axis at `coordinate`.
    #[must_use]
    pub const fn with(self, mut position: Position, coordinate: Length) -> Position {
        self.set(&mut position, coordinate);
        position
    }

    /// Puts this axis of `position` to `coordinate`.
    pub const fn set(self, position: &mut Position, coordinate: Length) {
        match self {
            Self::X => position.x = coordinate,
            Self::Z => position.z = coordinate,
        }
    }
}

/// How a tap goes down: the three forms of the [G84/G88 sheet].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TapForm {
    /// At once (Q missing or zero).
    Standard,
    /// High-speed peck (5200.5 = 0): back by d after each infeed.
    HighSpeed(TapPeck),
    /// Deep peck (5200.5 = 1): back to R after each infeed, down again to d above the depth reached.
    Deep(TapPeck),
}

/// The lengths of a peck, on the radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TapPeck {
    /// q: depth of an infeed, positive.
    pub infeed: At<Length>,
    /// d: D word or 5213, not negative, at most q.
    pub back: At<Length>,
}

/// How often a tap call taps, and whether it comes back (K word).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TapRepeat {
    /// So many holes, 1…99, each `step` from the one before.
    Holes(NonZeroU8),
    /// K198: one hole, and the tap stays at its bottom, locked.
    Stay,
}

/// How a tap's axis is tied to its spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum TapMode {
    /// Rigid: the spindle is in position mode, and one master moves both.
    #[default]
    Rigid,
    /// Ordinary: the spindle turns in speed mode, the axis follows its encoder through stop and reversal, and a floating
    /// holder takes what is left between them.
    Floating,
}

/// G30 P99: the way out of a hole in which a tap was stopped. Which hole, the tap journal says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TapReturn {
    /// S: speed of the spindle before the extraction override, above zero; `None`: that of the hole.
    pub speed: Option<CentiRpm>,
    /// The highest speed of a tap (5241, 3772).
    pub highest: CentiRpm,
    /// How far beyond R it goes (5382), not negative.
    pub beyond: Length,
    /// G20 or G21 in force: the hole must have been tapped in the same.
    pub unit: LengthUnit,
}

/// A G84 or G88 with every word resolved: one block, one or more holes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TapCall {
    /// Which cycle.
    pub cycle: TapCycle,
    /// Rigid or ordinary.
    pub mode: TapMode,
    /// The tap axis (5209.0, plane).
    pub axis: TapAxis,
    /// Where the tool stands: at the initial level, or in the hole where the call goes on after K198.
    pub start: Position,
    /// The first hole, its tap axis at the initial level.
    pub hole: Position,
    /// From hole to hole: what was written as increments, zero for the rest and for the tap axis.
    pub step: Position,
    /// Coordinate of the R plane on the tap axis.
    pub level: At<Length>,
    /// Coordinate of the bottom on the tap axis.
    pub bottom: At<Length>,
    /// Standard, high-speed peck or deep peck.
    pub form: TapForm,
    /// Dwell at the bottom (P), zero for none.
    pub dwell: Millis,
    /// F/S (G98) or F (G99).
    pub lead: At<Lead>,
    /// By the sign of S, or by signal; in ordinary tapping by M03 or M04.
    pub hand: HandChoice,
    /// Spindle speed of the infeed, above zero (its magnitude). In ordinary tapping zero where the spindle stands: `expand`
    /// does not mind.
    pub speed: CentiRpm,
    /// Spindle speed of retracts and, in deep peck, of the re-entry, above zero: the infeed's with the extraction override.
    pub extract: CentiRpm,
    /// Which spindle turns the tap: by E, by signal, or by M24–M27.
    pub spindle: SpindleChoice,
    /// K.
    pub repeat: TapRepeat,
    /// M: C-axis clamp code before the R plane, its successor after the return.
    pub clamp: Option<u16>,
    /// True where the tap stands in the hole since a K198: it goes on from there.
    pub continues: bool,
    /// For the tap journal.
    pub notes: TapNotes,
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
