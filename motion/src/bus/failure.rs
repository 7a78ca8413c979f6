//! The failures of a drive, and their alarms.

use super::cia402::Statusword;
use super::drive::config::{DriveConfig, Step};
use super::increments::Increments;
use crate::alarm::{Alarm, Arg, Code};
use crate::units::{Angle, Length};

/// A failure of a drive. Latched until [`DriveMaster::reset`](super::DriveMaster::reset).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveFailure {
    /// No status at all after NMT start.
    NoAnswer,
    /// A step took too long; the last statusword shows the state in which the drive remains.
    Step(Step, Statusword),
    /// The drive reports a fault.
    Fault {
        /// The statusword with the fault.
        status: Statusword,
        /// Error code of the drive's last emergency message; 0 where there was none.
        code: u16,
    },
    /// The drive left operation enabled without a command.
    Lost(Statusword),
    /// The drive got ready without a command: it reads another drive's place in the shared setpoint frame.
    Overhears(Statusword),
    /// The drive restarted.
    Restarted,
    /// An enabled drive got demands for the time of a step, and none of them was equal to the position where it is
    /// held.
    Jump {
        /// The position where the drive is held.
        target: Increments,
        /// The last demand.
        demand: Increments,
    },
    /// The enabled drive sent no status for too long.
    Silent,
    /// The drive is too far from its target.
    Following {
        /// Its target.
        target: Increments,
        /// Its actual position.
        actual: Increments,
    },
    /// The drive stays in this mode (6061h; 0: not reported) and is not in position mode.
    Mode(u8),
    /// The drive goes on moving by itself where it should stand.
    Moves {
        /// The position where it is held.
        target: Increments,
        /// Its actual position.
        actual: Increments,
    },
    /// A spindle in position mode stands, although its target is elsewhere.
    Stands {
        /// Its target.
        target: Increments,
        /// Its actual position.
        actual: Increments,
    },
}

impl DriveFailure {
    /// An alarm that names drive, node and figures.
    #[must_use]
    pub fn alarm(self, config: &DriveConfig) -> Alarm {
        let (third, fourth) = match self {
            Self::NoAnswer | Self::Restarted => (Arg::None, Arg::None),
            Self::Silent => (Arg::Int(i64::from(config.silence.get())), Arg::None),
            Self::Step(_, status) | Self::Lost(status) => {
                (Arg::Statusword(status.raw()), Arg::None)
            }
            Self::Overhears(status) => (Arg::Statusword(status.raw()), Arg::None),
            Self::Fault { status, code } => (Arg::Statusword(status.raw()), Arg::Hex(code)),
            Self::Stands { target, actual } => {
                let limit = config.following.map_or(0, |limit| limit.increments);
                let increments = |count: u32| Arg::Int(i64::from(count));
                (increments(actual.turned(target)), increments(limit))
            }
            Self::Mode(told) => (Arg::Int(i64::from(told)), Arg::None),
            Self::Moves { target, actual } => {
                (distance(config, actual.distance(target)), Arg::None)
            }
            Self::Jump { target, demand } => (distance(config, demand.distance(target)), Arg::None),
            Self::Following { target, actual } => {
                let limit = config.following.map_or(0, |limit| limit.increments);
                (
                    distance(config, actual.distance(target)),
                    distance(config, limit),
                )
            }
        };
        let figures = [
            Arg::Letter(config.letter),
            Arg::Int(i64::from(config.node.get())),
            third,
            fourth,
        ];
        Alarm::of(self.code(), &figures)
    }

    const fn code(self) -> Code {
        match self {
            Self::NoAnswer => Code::DriveNoAnswer,
            Self::Step(Step::Contact, _) => Code::DriveNotInitialised,
            Self::Step(Step::Release, _) => Code::DriveNotReleased,
            Self::Step(Step::Shutdown, _) => Code::DriveNotReady,
            Self::Step(Step::SwitchOn, _) => Code::DriveNotSwitchedOn,
            Self::Step(Step::EnableOperation, _) => Code::DriveNotEnabled,
            Self::Step(Step::FaultReset, _) => Code::DriveFaultNotReset,
            Self::Fault { .. } => Code::DriveFault,
            Self::Lost(_) => Code::DriveLost,
            Self::Overhears(_) => Code::DriveOverhears,
            Self::Restarted => Code::DriveRestarted,
            Self::Jump { .. } => Code::DriveJump,
            Self::Mode(_) => Code::DriveNotInMode,
            Self::Moves { .. } => Code::DriveMovesOn,
            Self::Silent => Code::DriveSilent,
            Self::Following { .. } => Code::FollowingError,
            Self::Stands { .. } => Code::SpindleStands,
        }
    }
}

fn distance(config: &DriveConfig, increments: u32) -> Arg {
    let distance = config.scale.length(increments);
    match config.letter {
        b'X' | b'Y' | b'Z' => Arg::Length(Length::from_nm(distance)),
        _ => Arg::Angle(Angle::from_udeg(distance)),
    }
}
