//! The configuration of a drive, and the names of the steps and phases of its master.
//!
//! Plain values for the master and for the failures. This module must not know either of them, nor any frame.

use super::home::{HomeLimits, HomeStep};
use crate::bus::cia402::Controlword;
use crate::bus::frame::NodeId;
use crate::bus::increments::Scale;
use crate::bus::pdo::Mode;
use crate::bus::periods::Periods;

/// The configuration of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveConfig {
    /// Letter of the axis in messages: `b'X'`, `b'Z'`, `b'C'`, `b'S'` for a spindle.
    pub letter: u8,
    /// Node of the drive.
    pub node: NodeId,
    /// Increments of the drive; the master uses them only for positions in messages.
    pub scale: Scale,
    /// Time for each step of enabling, and for a fault reset.
    pub step: Periods,
    /// Time without a status after which an enabled drive counts as lost.
    pub silence: Periods,
    /// Limit of the following error in position mode; `None`: no limit.
    pub following: Option<FollowingLimit>,
    /// Largest distance of a silent drive's target from its last known position, in increments. Counts in position
    /// mode.
    pub reach: u32,
    /// What the drive is allowed in homing; `None` where it does not home by itself, and its mode is not ordered.
    pub homes: Option<HomeLimits>,
    /// The mode in which it gets its setpoints: cyclic synchronous or interpolated position.
    pub mode: Mode,
}

impl DriveConfig {
    /// The controlword of an enabled drive that follows its setpoints.
    pub(super) const fn streaming(&self) -> Controlword {
        match self.mode {
            Mode::Interpolated => Controlword::INTERPOLATE,
            _ => Controlword::ENABLE_OPERATION,
        }
    }
}

/// How far an enabled drive may be from its target while it follows, and for how long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FollowingLimit {
    /// The largest distance, in increments.
    pub increments: u32,
    /// How long a larger distance is tolerated.
    pub time: Periods,
    /// For a spindle, which may lag by turns: the limit counts only while the spindle stands, and the distance wraps
    /// around.
    pub standing: bool,
}

/// A step on the way to operation enabled, or out of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// NMT start; waits for a status that shows the drive initialised.
    Contact,
    /// 0000h out of quick stop; waits for switch on disabled.
    Release,
    /// 0006h; waits for ready to switch on.
    Shutdown,
    /// 0007h; waits for switched on.
    SwitchOn,
    /// 000Fh; waits for operation enabled.
    EnableOperation,
    /// 0080h; waits for the fault to be gone.
    FaultReset,
}

/// The phase of a drive's master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Not started: nothing is sent.
    Offline,
    /// Started and without torque.
    Standby,
    /// In a step to operation enabled, or out of a fault.
    Step(Step),
    /// Operation enabled.
    Enabled,
    /// Operation enabled, homing by itself.
    Homing(HomeStep),
    /// The drive gets quick stop: it is silent, and its demand is too far from its last known position, or it homes; or
    /// it moves by itself where it should stand.
    Halted,
}
