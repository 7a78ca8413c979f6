//! What is known of one tick: a setpoint, and what was true when it took effect.
//!
//! Plain values; this room knows of no board and no plant.

use leadscrew_core::motion::TapLine;
use leadscrew_core::program::{Position, TapSpindle};
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
    /// The word for it in records of setpoints.
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

/// One tick: a setpoint, and what was true when it took effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// From 0.
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
    /// Source line of what executes; 0 for nothing.
    pub line: u32,
    /// Its move; 0 for nothing.
    pub number: u32,
    /// What the machine is doing.
    pub doing: Doing,
    /// While the long axis is held to the helix, or axis and spindle to the tap's master: setpoint minus where the axis
    /// should be at the true angle.
    pub error: Option<Length>,
    /// Where a tap is, while axis and spindle are held to its master.
    pub tap: Option<TapPoint>,
}

impl Row {
    /// A spindle's angles; the true one for a drive with the delay that the row is about.
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

    /// A spindle is in position mode.
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
    /// Its true angle when the setpoint takes effect.
    pub truth: FineTurns,
    /// Its commanded angle, while it is in position mode.
    pub set: Option<Turns>,
}

/// A tap at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapPoint {
    /// Setpoint of the tap axis below R; negative above it.
    pub depth: Length,
    /// Turns of the spindle since R: commanded ones in position mode, else true ones, of the instant the setpoint is for.
    pub turned: Turns,
    /// Setpoint of the tap axis minus where it should be at that angle.
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
