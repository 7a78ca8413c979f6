//! The data of one tick: a setpoint, and the truth when it took effect.
//!
//! Plain values; this module knows no board and no plant.

use leadscrew_core::call::{Position, TapSpindle};
use leadscrew_core::motion::TapLine;
use leadscrew_core::units::{Length, Turns};

use crate::plant::FineTurns;

/// What the machine is doing in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Doing {
    /// Nothing.
    #[default]
    Idle,
    /// Moving, or changing from one move to the next.
    Run,
    /// In feed hold or single block.
    Hold,
    /// In a dwell.
    Dwell,
    /// Waiting for the spindle, or for the next segment.
    Wait,
    /// Stopping or stopped on an alarm.
    Alarm,
}

impl Doing {
    /// The name in records of setpoints.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Run => "run",
            Self::Hold => "hold",
            Self::Dwell => "dwell",
            Self::Wait => "wait",
            Self::Alarm => "alarm",
        }
    }
}

/// The data of one tick: a setpoint, and the truth when it took effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// The number of the tick, from 0.
    pub tick: u64,
    /// Virtual time of the tick in microseconds.
    pub t_us: u64,
    /// The setpoint, in machine coordinates.
    pub position: Position,
    /// The spindle's true angle when the setpoint takes effect: at the next SYNC plus the drive's latency.
    pub spindle: FineTurns,
    /// The spindle's commanded angle, while it is in position mode.
    pub spindle_set: Option<Turns>,
    /// Spindles 2 to 4.
    pub tappers: [SpindleAngle; 3],
    /// The source line that is executed; 0 for none.
    pub line: u32,
    /// The move of that line; 0 for none.
    pub number: u32,
    /// What the machine is doing.
    pub doing: Doing,
    /// The setpoint minus the place where the axis should be at the true angle. Known while the long axis follows the
    /// helix, or axis and spindle follow the tap's master.
    pub error: Option<Length>,
    /// The state of a tap, while axis and spindle follow its master.
    pub tap: Option<TapPoint>,
    /// Where the tool truly is on X and Z at the instant of the true angle; `None` where both drives are ideal ones. An
    /// ideal drive beside another is at its setpoint.
    pub actual: Option<[Length; 2]>,
    /// What the tool cuts, where `actual` and `error` are known in a thread.
    pub cut: Option<CutPoint>,
}

impl Row {
    /// A spindle's angles; the true angle is for a drive with this row's delay.
    #[must_use]
    pub const fn angle(&self, spindle: TapSpindle) -> SpindleAngle {
        let [second, third, fourth] = self.tappers;
        match spindle {
            TapSpindle::First => SpindleAngle {
                truth: self.spindle,
                set: self.spindle_set,
            },
            TapSpindle::Second => second,
            TapSpindle::Third => third,
            TapSpindle::Fourth => fourth,
        }
    }

    /// True where a spindle is in position mode.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        TapSpindle::ALL
            .iter()
            .any(|spindle| self.angle(*spindle).set.is_some())
    }

    pub(super) fn set_angle(&mut self, spindle: TapSpindle, set: Option<Turns>) {
        let [second, third, fourth] = &mut self.tappers;
        let place = match spindle {
            TapSpindle::First => &mut self.spindle_set,
            TapSpindle::Second => &mut second.set,
            TapSpindle::Third => &mut third.set,
            TapSpindle::Fourth => &mut fourth.set,
        };
        *place = set;
    }
}

/// A spindle at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpindleAngle {
    /// The true angle when the setpoint takes effect.
    pub truth: FineTurns,
    /// The commanded angle, while the spindle is in position mode.
    pub set: Option<Turns>,
}

/// A thread at an instant, as it is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutPoint {
    /// The true angle, in the turns that the board counts.
    pub angle: Turns,
    /// The tool on the long axis minus the helix at this angle.
    pub error: Length,
    /// The way of the helix in the turn from here.
    pub lead: Length,
}

/// A tap at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapPoint {
    /// Setpoint of the tap axis below R; negative above it.
    pub depth: Length,
    /// Turns of the spindle since R: commanded turns in position mode, otherwise true turns at the instant of the setpoint.
    pub turned: Turns,
    /// Setpoint of the tap axis minus the place where it should be at that angle.
    pub skew: Length,
}

impl TapPoint {
    pub(super) fn new(line: &TapLine, position: Position, angle: Turns) -> Self {
        Self {
            depth: line.gear.depth(position),
            turned: angle - line.origin,
            skew: line.error(position, angle),
        }
    }
}
