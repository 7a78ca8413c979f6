//! The master of a spindle drive: the master of any drive, and in addition the speed.
//!
//! The master sends mode and speed (RPDO2) on change, and once in [`REPEAT`] periods in case that frame was lost
//! [D125]. A drive keeps the last speed that it received. Therefore the master sends speed 0 before the drive gets
//! torque and as soon as the drive has lost torque: enabling never starts a spindle.
//!
//! For tapping the drive is in position mode. That mode begins at the position of the standing spindle:
//! [`SpindleMaster::engage`] makes the drive's own position its target. Only then does the master send the mode, in the
//! same period as that target.

use super::drive::{DriveConfig, DriveMaster, Phase, Step};
use super::frame::Frame;
use super::increments::Increments;
use super::pdo::{MilliRpm, Mode, SpindleCommand};

/// Periods after which mode and speed are sent again.
const REPEAT: u8 = 16;

/// The demand on a spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpindleDemand {
    /// Turn at a speed.
    Speed(MilliRpm),
    /// Be at this position at the next SYNC, in increments that wrap.
    Position(Increments),
}

impl SpindleDemand {
    /// The content of RPDO2, and the target of RPDO1.
    const fn parts(self) -> (SpindleCommand, Option<Increments>) {
        let (mode, velocity, position) = match self {
            Self::Speed(velocity) => (Mode::Velocity, velocity, None),
            Self::Position(position) => (Mode::Position, MilliRpm::STOPPED, Some(position)),
        };
        (SpindleCommand { mode, velocity }, position)
    }
}

/// The master of a spindle drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpindleMaster {
    drive: DriveMaster,
    /// The last RPDO2 since the drive was started.
    told: Option<SpindleCommand>,
    /// Periods since that RPDO2.
    since: u8,
    /// Turns of the motor for one of the spindle, in 2⁻²⁴.
    ratio: i32,
}

/// The motor turns as its spindle does.
const DIRECT: i32 = 1 << 24;

impl SpindleMaster {
    /// A master that has sent nothing to its drive yet.
    #[must_use]
    pub const fn new(config: DriveConfig) -> Self {
        Self {
            drive: DriveMaster::new(config),
            told: None,
            since: 0,
            ratio: DIRECT,
        }
    }

    /// The master of any drive in it.
    #[must_use]
    pub const fn drive(&self) -> &DriveMaster {
        &self.drive
    }

    /// The same master, to enable, disable, reset and to receive frames.
    pub const fn drive_mut(&mut self) -> &mut DriveMaster {
        &mut self.drive
    }

    /// Another gear is in. The spindle stands.
    pub const fn shift(&mut self, ratio: i32) {
        self.ratio = ratio;
    }

    /// Prepares the standing spindle for position mode. Gives its position, which must be the first demand. `None`
    /// while the drive is not enabled or its last two statuses have different positions.
    pub fn engage(&mut self) -> Option<Increments> {
        if !self.drive.is_enabled() || !self.drive.has_told_the_same(2) {
            return None;
        }
        self.drive.hold_here();
        Some(self.drive.target())
    }

    /// One SYNC period: the frames to send go to `put`, in their order. A drive that is not enabled gets speed 0.
    pub fn tick(&mut self, demand: SpindleDemand, put: &mut impl FnMut(Frame)) {
        let (wish, position) = demand.parts();
        let Some(command) = self.drive.follow_on(position) else {
            self.tick_slowly(wish, position, put);
            return;
        };
        if self.told != Some(wish) {
            put(self.tell(wish));
            put(command);
            return;
        }
        put(command);
        if self.since < REPEAT {
            self.since = self.since.wrapping_add(1);
        } else {
            put(self.tell(wish));
        }
    }

    fn tell(&mut self, command: SpindleCommand) -> Frame {
        if command.mode == Mode::Velocity {
            self.drive.leave_position();
        }
        self.told = Some(command);
        self.since = 0;
        let geared = SpindleCommand {
            mode: command.mode,
            velocity: command.velocity.geared(self.ratio),
        };
        geared.frame(self.drive.config().node)
    }

    #[inline(never)]
    fn tick_slowly(
        &mut self,
        wish: SpindleCommand,
        position: Option<Increments>,
        put: &mut impl FnMut(Frame),
    ) {
        let drive = self.drive.tick_slowly(position);
        let wanted = match self.drive.phase() {
            // A drive that is being started has forgotten its earlier commands.
            Phase::Offline | Phase::Step(Step::Contact) => None,
            Phase::Enabled | Phase::Homing(_) => Some(wish),
            Phase::Standby | Phase::Halted | Phase::Step(_) => Some(SpindleCommand {
                mode: Mode::Velocity,
                velocity: MilliRpm::STOPPED,
            }),
        };
        if wanted == self.told && self.since < REPEAT {
            self.since = self.since.wrapping_add(1);
        } else if let Some(command) = wanted {
            put(self.tell(command));
        } else {
            (self.told, self.since) = (None, 0);
        }
        drive.each(put);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::alarm::{Arg, Code};
    use crate::bus::{
        DriveCommand, DriveFailure, DriveStatus, FollowingLimit, Increments, NmtState, NodeId,
        Periods, Scale, Statusword,
    };
    use std::vec::Vec;

    fn master() -> SpindleMaster {
        SpindleMaster::new(DriveConfig {
            letter: b'S',
            node: NodeId::SPINDLE_1,
            scale: Scale::new(1, 100).unwrap(),
            step: Periods::new(20),
            silence: Periods::new(8),
            following: None,
            reach: 9_000,
            homes: None,
            mode: Mode::Position,
        })
    }

    fn answer(master: &mut SpindleMaster, word: u16) {
        let status = DriveStatus {
            status: Statusword::from_raw(word),
            actual: Increments::new(0),
        };
        assert!(master.drive_mut().receive(&status.frame(NodeId::SPINDLE_1)));
    }

    /// The frames of a period.
    fn tick(master: &mut SpindleMaster, demand: SpindleDemand) -> Vec<Frame> {
        let mut frames = Vec::new();
        master.tick(demand, &mut |frame| frames.push(frame));
        frames
    }

    fn told(master: &mut SpindleMaster, rpm: i32) -> Option<(Mode, i32)> {
        let speed = SpindleDemand::Speed(MilliRpm::new(rpm.saturating_mul(1000)));
        let (node, command) = tick(master, speed)
            .iter()
            .find_map(SpindleCommand::decode)?;
        assert_eq!(node, NodeId::SPINDLE_1);
        Some((command.mode, command.velocity.get() / 1000))
    }

    /// The speeds sent during enabling, with 300 rpm wanted all the time.
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

    #[test]
    fn a_speed_that_was_lost_comes_again_in_time() {
        let mut m = master();
        start(&mut m);
        let mut told_at = Vec::new();
        for period in 0..60 {
            answer(&mut m, 0x0237);
            if let Some(speed) = told(&mut m, 300) {
                assert_eq!(speed, (Mode::Velocity, 300));
                told_at.push(period);
            }
        }
        assert_eq!(told_at, [15, 32, 49]);
    }

    #[test]
    fn a_status_that_comes_twice_is_no_second_one() {
        let mut m = master();
        start(&mut m);
        told(&mut m, 0);
        // The spindle turns: two different frames, of which the second comes twice.
        answer_at(&mut m, 5_000);
        told(&mut m, 0);
        answer_at(&mut m, 7_000);
        answer_at(&mut m, 7_000);
        assert_eq!(m.engage(), None);
        told(&mut m, 0);
        answer_at(&mut m, 7_000);
        assert_eq!(m.engage(), Some(Increments::new(7_000)));
    }

    fn answer_at(master: &mut SpindleMaster, actual: i32) {
        let status = DriveStatus {
            status: Statusword::from_raw(0x0237),
            actual: Increments::new(actual),
        };
        master.drive_mut().receive(&status.frame(NodeId::SPINDLE_1));
    }

    /// A spindle in position mode: the limit is a quarter of a turn (2 500), tolerated for 5 periods.
    fn positioned(at: i32) -> SpindleMaster {
        let mut m = SpindleMaster::new(DriveConfig {
            following: Some(FollowingLimit {
                increments: 2_500,
                time: Periods::new(5),
                standing: true,
            }),
            ..*master().drive().config()
        });
        start(&mut m);
        for _ in 0..2 {
            answer_at(&mut m, at);
            told(&mut m, 0);
        }
        let base = m.engage().unwrap();
        tick(&mut m, SpindleDemand::Position(base));
        m
    }

    #[test]
    fn a_spindle_that_stands_where_it_is_not_told_to_is_a_failure() {
        let target = Increments::new(9_501);
        let go = SpindleDemand::Position(target);
        let mut m = positioned(7_000);
        // At the limit: no alarm, for any time.
        tick(&mut m, SpindleDemand::Position(Increments::new(9_500)));
        for _ in 0..50 {
            answer_at(&mut m, 7_000);
            tick(&mut m, SpindleDemand::Position(Increments::new(9_500)));
        }
        assert_eq!(m.drive().failure(), None);
        tick(&mut m, go);
        tick(&mut m, go);
        answer_at(&mut m, 7_000);
        for _ in 0..5 {
            tick(&mut m, go);
            assert_eq!(m.drive().failure(), None);
        }
        tick(&mut m, go);
        let actual = Increments::new(7_000);
        assert_eq!(
            m.drive().failure(),
            Some(DriveFailure::Stands { target, actual })
        );
        let alarm = m.drive().alarm().unwrap();
        assert_eq!(
            (alarm.code, &alarm.args[2..]),
            (Code::SpindleStands, &[Arg::Int(2_501), Arg::Int(2_500)][..])
        );
    }

    #[test]
    fn a_spindle_that_lags_turns_round_or_is_not_in_position_mode_is_none() {
        // A lag of three turns, all the time.
        let mut m = positioned(7_000);
        for step in 1..200 {
            let target = Increments::new(7_000 + 300 * step);
            tick(&mut m, SpindleDemand::Position(target));
            answer_at(&mut m, (7_000 + 300 * step - 30_000).max(7_000 + step));
            assert_eq!(m.drive().failure(), None);
        }
        // Past the end of 32 bits.
        let mut m = positioned(i32::MAX - 10);
        for _ in 0..50 {
            answer_at(&mut m, i32::MAX - 10);
            tick(
                &mut m,
                SpindleDemand::Position(Increments::new(i32::MIN + 100)),
            );
        }
        assert_eq!(m.drive().failure(), None);
        // Turned and stopped again in speed mode.
        let mut m = positioned(7_000);
        for _ in 0..50 {
            told(&mut m, 0);
            answer_at(&mut m, 90_000);
        }
        assert_eq!(m.drive().failure(), None);
    }

    #[test]
    fn position_mode_begins_where_it_stands_with_mode_and_target_in_one_period() {
        let mut m = master();
        start(&mut m);
        // The spindle has turned; it counts as standing after two statuses with the same position.
        told(&mut m, 0);
        for actual in [5_000, 7_000] {
            answer_at(&mut m, actual);
            assert_eq!(m.engage(), None);
            told(&mut m, 0);
        }
        answer_at(&mut m, 7_000);
        let base = m.engage().unwrap();
        assert_eq!(base, Increments::new(7_000));
        let frames = tick(&mut m, SpindleDemand::Position(base));
        // The frame with the mode comes before the target.
        let [mode, target] = frames.as_slice() else {
            panic!("a mode and a target, and not {frames:?}");
        };
        let (_, command) = SpindleCommand::decode(mode).unwrap();
        assert_eq!(command.mode, Mode::Position);
        let position = |frame| DriveCommand::decode(frame).map(|(_, told)| told.target.get());
        assert_eq!(position(target), Some(7_000));
        let frames = tick(&mut m, SpindleDemand::Position(Increments::new(7_300)));
        assert_eq!(frames.len(), 1);
        assert_eq!(frames.first().and_then(position), Some(7_300));
        // Back to speed mode: sent on change, and only once.
        assert_eq!(told(&mut m, 0), Some((Mode::Velocity, 0)));
        assert_eq!(told(&mut m, 0), None);
    }
}
