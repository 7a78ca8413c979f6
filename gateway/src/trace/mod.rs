//! What is made of a stream of setpoints: the CSV file, the summary with its certificate, the hash. Each looks at one
//! [`Setpoint`] after the other and keeps bounded memory.

mod csv;
mod hash;
mod peaks;
mod summary;

pub use csv::Csv;
pub use hash::SetpointHash;
pub use peaks::{Peak, Peaks};
pub use summary::Summary;

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
    /// Source line of what executes; 0 for nothing.
    pub line: u32,
    /// Its move number; 0 for nothing.
    pub step: u64,
    /// What the machine is doing.
    pub state: Doing,
    /// Long-axis distance from the exact helix in nanometres, while locked to it.
    pub error_nm: Option<i64>,
}
