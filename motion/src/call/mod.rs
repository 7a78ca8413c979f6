//! What passes between the text and the board: one [`Call`] for each action of the machine.
//!
//! All coordinates are machine coordinates, X as a radius. Word-level mistakes (missing, negative, out of the printed
//! range, twice) have been refused before a call exists; whoever expands a call refuses mistakes of geometry and of
//! physics. These are values only: the module knows neither text nor moves.

mod choice;
mod groove;
mod lengths;
mod surface;
mod tap;
mod tap_notes;
mod tapper;
mod thread;

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::alarm::Span;
use crate::units::{Angle, Feed, FeedPerTurn, Length, Millis, Rpm};

pub use lengths::Sign;

pub use choice::{HandChoice, Selection, SpindleChoice};
pub use groove::GrooveCall;
pub use surface::SurfaceSpeed;
pub use tap::{TapAxis, TapCall, TapCycle, TapForm, TapMode, TapPeck, TapRepeat, TapReturn};
pub use tap_notes::{Extraction, LengthUnit, Plane, TapNotes};
pub use tapper::{Hand, TapSpindle};
pub use thread::{ChainPart, CutIn, Infeed, RunOut, ThreadCall, ThreadCycle, start_angle};

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
    /// How cuts go on from now on, until the program ends. True (G61): each ends in a stop. False (G64, at power-on too):
    /// cuts that follow one another are joined, and pass their corners without a stop.
    ExactStop(bool),
    /// A line that was typed is over, as a text is: no move, and no call follows. But the spindle goes on turning, since
    /// the next line may cut [D284].
    LineOver,
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
    /// It turns at the speed that the tool's distance from the centre asks for; the speed of the command is that of its
    /// beginning, rounded up.
    Surface(SurfaceSpeed),
    /// Spindle 1 is brought to a stand, and turns in position mode to this angle of its turn, the shorter way.
    Orient(Angle),
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

    /// Turning as `law` says, in the sense of `direction` (−1 or +1); the tool is at machine coordinate `x`.
    #[must_use]
    pub fn surface(law: SurfaceSpeed, x: Length, direction: i32) -> Self {
        Self {
            rpm: law.rpm(x, direction),
            mode: SpindleMode::Surface(law),
        }
    }

    /// The surface speed that the spindle follows, if it does.
    #[must_use]
    pub const fn law(&self) -> Option<SurfaceSpeed> {
        match self.mode {
            SpindleMode::Surface(law) => Some(law),
            SpindleMode::Speed | SpindleMode::Rigid(_) | SpindleMode::Orient(_) => None,
        }
    }

    /// True where the spindle turns by itself after this command.
    #[must_use]
    pub const fn turns(&self) -> bool {
        self.rpm.get() != 0 && !matches!(self.mode, SpindleMode::Rigid(_))
    }

    /// Standing at an angle.
    #[must_use]
    pub const fn orient(angle: Angle) -> Self {
        Self {
            rpm: Rpm::STOPPED,
            mode: SpindleMode::Orient(angle),
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
