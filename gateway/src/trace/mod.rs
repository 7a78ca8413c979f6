//! What is made of a stream of setpoints: the CSV file, the summary with its certificate, the hash. Each looks at one
//! [`Setpoint`] after the other and keeps bounded memory.

mod csv;
mod cuts;
mod hash;
mod peaks;
mod summary;
mod taps;

pub use csv::{Columns, Csv};
pub use cuts::Cuts;
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
    /// Where the tool truly is on X and Z at the instant of the true angle, nanometres, where a drive is not ideal.
    pub actual_nm: Option<[i64; 2]>,
    /// What the tool cuts of a thread there.
    pub cut: Option<Cut>,
}

/// The cut of a thread at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cut {
    /// True angle in 2⁻³² turns.
    pub angle_raw: i64,
    /// The tool on the long axis minus the helix there, nanometres.
    pub error_nm: i64,
    /// The way of the helix in a turn, nanometres.
    pub lead_nm: i64,
}

impl Setpoint {
    /// The spindle that has work, and its true angle in millionths of a turn: one of 2 to 4 while it taps, else spindle 1.
    pub fn turning_spindle(&self) -> (u8, i64) {
        let tapping = (2..)
            .zip(&self.tappers)
            .find(|(_, spindle)| spindle.set_urev.is_some());
        tapping.map_or((1, self.s1_urev), |(number, spindle)| {
            (number, spindle.urev)
        })
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spindle_that_taps_is_the_one_that_turns() {
        let tapper = |urev, set_urev| SpindlePoint { urev, set_urev };
        let mut point = Setpoint {
            s1_urev: 7,
            tappers: [tapper(20, None), tapper(30, None), tapper(40, None)],
            ..Setpoint::default()
        };
        assert_eq!(point.turning_spindle(), (1, 7));
        point.s1_set_urev = Some(7);
        assert_eq!(point.turning_spindle(), (1, 7));
        point.s1_set_urev = None;
        point.tappers[1].set_urev = Some(31);
        assert_eq!(point.turning_spindle(), (3, 30));
    }
}
