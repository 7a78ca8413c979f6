//! What is made of a stream of setpoints: the CSV file, the summary with its certificate, the hash. Each looks at one
//! [`Setpoint`] after the other and keeps bounded memory.

mod csv;
mod hash;
mod peaks;
mod summary;
mod taps;

pub use csv::Csv;
pub use hash::SetpointHash;
pub use peaks::{Peak, Peaks};
pub use summary::Summary;
pub use taps::Taps;

use leadscrew_board_sim::Doing;

/// One tick as the contract's CSV shows it, and how far a locked axis is from its exact helix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setpoint {
    /// Tick from 0.
    pub tick: u64,
    /// Radius in nanometres, machine coordinates.
    pub x_nm: i64,
    /// Nanometres, machine coordinates.
    pub z_nm: i64,
    /// Millionths of a degree.
    pub c_udeg: i64,
    /// True angle of spindle 1 in millionths of a turn when this setpoint takes effect.
    pub s1_urev: i64,
    /// Commanded angle while the spindle is in position mode.
    pub s1_set_urev: Option<i64>,
    /// Spindles 2 to 4.
    pub tappers: [SpindlePoint; 3],
    /// Source line of what executes; 0 for nothing.
    pub line: u32,
    /// Its move number; 0 for nothing.
    pub step: u64,
    /// What the machine is doing.
    pub state: Doing,
    /// Long-axis distance from the exact helix in nanometres, while locked to it.
    pub error_nm: Option<i64>,
    /// Where a tap is, while axis and spindle are held to its master.
    pub tap: Option<TapPlace>,
}

/// A spindle that only taps, at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpindlePoint {
    /// Its true angle in millionths of a turn.
    pub urev: i64,
    /// Its commanded angle while it is in position mode.
    pub set_urev: Option<i64>,
}

/// A tap at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapPlace {
    /// Tap axis below R in nanometres; negative above it.
    pub depth_nm: i64,
    /// Spindle angle since R in millionths of a turn.
    pub turned_urev: i64,
    /// Tap axis minus where it should be at that angle, nanometres.
    pub skew_nm: i64,
}
