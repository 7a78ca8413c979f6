//! The master of a spindle drive: that of any drive, and the speed.
//!
//! Mode and speed go out on change (RPDO2). A drive keeps the last speed it was told, so it is told 0 before it gets
//! torque and as soon as it has lost it: enabling never starts a spindle.

use super::drive::{DriveConfig, DriveMaster, DriveOutput, Phase, Step};
use super::frame::Frame;
use super::pdo::{MilliRpm, Mode, SpindleCommand};

/// The frames a spindle's master wants sent, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpindleOutput {
    /// RPDO2.
    pub speed: Option<Frame>,
    /// Those of every drive.
    pub drive: DriveOutput,
}

/// The master of a spindle drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpindleMaster {
    drive: DriveMaster,
    /// What the drive was last told since it was started.
    told: Option<SpindleCommand>,
}

impl SpindleMaster {
    /// A master that has not spoken to its drive yet.
    #[must_use]
    pub const fn new(config: DriveConfig) -> Self {
        Self {
            drive: DriveMaster::new(config),
            told: None,
        }
    }

    /// What it has in common with every drive.
    #[must_use]
    pub const fn drive(&self) -> &DriveMaster {
        &self.drive
    }

    /// The same, to enable, disable, reset and to receive frames.
    pub const fn drive_mut(&mut self) -> &mut DriveMaster {
        &mut self.drive
    }

    /// One SYNC period: `speed` is what the spindle is to turn at; while its drive is not enabled, it is told 0.
    pub fn tick(&mut self, speed: MilliRpm) -> SpindleOutput {
        let drive = self.drive.tick(None);
        let wanted = match self.drive.phase() {
            // Who is being started knows nothing of what it was told before.
            Phase::Offline | Phase::Step(Step::Contact) => None,
            Phase::Enabled => Some(speed),
            Phase::Standby | Phase::Step(_) => Some(MilliRpm::STOPPED),
        }
        .map(|velocity| SpindleCommand {
            mode: Mode::Velocity,
            velocity,
        });
        let changed = wanted.filter(|_| wanted != self.told);
        self.told = wanted;
        SpindleOutput {
            speed: changed.map(|command| command.frame(self.drive.config().node)),
            drive,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::bus::{DriveStatus, Increments, NmtState, NodeId, Periods, Scale, Statusword};
    use std::vec::Vec;

    fn master() -> SpindleMaster {
        SpindleMaster::new(DriveConfig {
            letter: b'S',
            node: NodeId::SPINDLE_1,
            scale: Scale::new(1, 100).unwrap(),
            step: Periods::new(20),
            silence: Periods::new(8),
            following: None,
        })
    }

    fn answer(master: &mut SpindleMaster, word: u16) {
        let status = DriveStatus {
            status: Statusword::from_raw(word),
            actual: Increments::new(0),
        };
        assert!(master.drive_mut().receive(&status.frame(NodeId::SPINDLE_1)));
    }

    fn told(master: &mut SpindleMaster, rpm: i32) -> Option<(Mode, i32)> {
        let frame = master.tick(MilliRpm::new(rpm.saturating_mul(1000))).speed?;
        let (node, command) = SpindleCommand::decode(&frame)?;
        assert_eq!(node, NodeId::SPINDLE_1);
        Some((command.mode, command.velocity.get() / 1000))
    }

    /// Speeds told while it is enabled with 300 rpm wanted all the time.
    fn start(master: &mut SpindleMaster) -> Vec<Option<(Mode, i32)>> {
        master.drive_mut().enable().unwrap();
        let mut speeds = std::vec![told(master, 300)];
        for word in [0x0250, 0x0231, 0x0233, 0x0237, 0x0237] {
            answer(master, word);
            speeds.push(told(master, 300));
        }
        speeds
    }

    #[test]
    fn it_is_told_0_before_torque_and_the_speed_once_after() {
        let mut m = master();
        assert_eq!(told(&mut m, 300), None);
        let stopped = Some((Mode::Velocity, 0));
        let turning = Some((Mode::Velocity, 300));
        let expected = [None, stopped, None, None, turning, None];
        assert_eq!(start(&mut m), expected);
        assert_eq!(told(&mut m, 299), Some((Mode::Velocity, 299)));
        assert_eq!(told(&mut m, 299), None);

        // A fault takes the speed back, and the next start begins with 0 again.
        answer(&mut m, 0x0218);
        assert_eq!(told(&mut m, 299), stopped);
        assert_eq!(told(&mut m, 299), None);
        m.drive_mut().reset();
        told(&mut m, 300);
        answer(&mut m, 0x0250);
        assert_eq!(start(&mut m), expected);

        // So does a restart.
        m.drive_mut()
            .receive(&NmtState::BootUp.frame(NodeId::SPINDLE_1));
        assert_eq!(told(&mut m, 300), None);
        m.drive_mut().reset();
        assert_eq!(start(&mut m), expected);
    }
}
