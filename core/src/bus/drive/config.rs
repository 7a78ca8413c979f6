//! What there is to know about a drive beforehand, and the names of the steps and phases its master goes through.
//!
//! Plain values, shared by the master and by what is said of its failures; this room knows neither of them, and no frame.

use crate::bus::frame::NodeId;
use crate::bus::increments::Scale;
use crate::bus::periods::Periods;

/// What there is to know about a drive beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveConfig {
    /// Letter of the axis in messages: `b'X'`, `b'Z'`, `b'C'`, `b'S'` for a spindle.
    pub letter: u8,
    /// Its node.
    pub node: NodeId,
    /// Its increments; used here only to put positions into messages.
    pub scale: Scale,
    /// Time for each step of enabling, and for a fault reset.
    pub step: Periods,
    /// Time without a status after which an enabled drive counts as lost.
    pub silence: Periods,
    /// Following error in position mode; `None` for a drive that has no such limit.
    pub following: Option<FollowingLimit>,
    /// How far from where it was last heard a silent drive may still be told to be, in increments. Counts in position mode.
    pub reach: u32,
}

/// How far an enabled drive may be from its target while it follows, and for how long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FollowingLimit {
    /// The largest distance, in increments.
    pub increments: u32,
    /// How long a greater one is tolerated.
    pub time: Periods,
    /// Of a spindle, which may lag by turns: only while it stands, and counted round.
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

/// Where the master is with its drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Not started: nothing is sent.
    Offline,
    /// Started and without torque.
    Standby,
    /// On the way.
    Step(Step),
    /// Operation enabled.
    Enabled,
    /// It is silent, and far from where it was last heard: if it hears anything, it is to stop by itself.
    Halted,
}
