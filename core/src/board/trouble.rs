//! What can be wrong with the bus as a whole, and how it is told.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::bus::{
    BusState, CobId, Controller, ErrorCounts, Frame, NmtCommand, NodeId, Service, is_sync,
};

/// What is wrong with the bus. Each is a controlled stop with an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusTrouble {
    /// The controller has left the bus: nothing reaches the drives.
    Off(ErrorCounts),
    /// The controller is error passive.
    Passive(ErrorCounts),
    /// More setpoints than allowed came late for their SYNC.
    Late {
        /// How many within a second.
        count: u32,
        /// How many may.
        limit: u32,
    },
    /// A second master.
    Intruder(Intrusion),
}

/// What only the board may say, said by somebody else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intrusion {
    /// SYNC.
    Sync,
    /// A setpoint for one of the board's drives.
    Setpoint(NodeId),
    /// An NMT command by which one of the board's drives ceases to follow.
    Network(NodeId),
}

impl Intrusion {
    /// What a frame from the bus is of these. What the board sends itself does not come back to it.
    #[must_use]
    pub fn of(frame: &Frame) -> Option<Self> {
        if is_sync(frame) {
            return Some(Self::Sync);
        }
        if frame.id() == CobId::NMT {
            let (command, node) = NmtCommand::decode(frame)?;
            let node = node.filter(|node| letter(*node).is_some())?;
            return (command != NmtCommand::Start).then_some(Self::Network(node));
        }
        match frame.id().service()? {
            (Service::Rpdo1 | Service::Rpdo2, node) if letter(node).is_some() => {
                Some(Self::Setpoint(node))
            }
            _ => None,
        }
    }
}

/// The letter of a drive in messages; `None` for a node that is none of the board's drives.
const fn letter(node: NodeId) -> Option<u8> {
    match node {
        NodeId::DRIVE_X => Some(b'X'),
        NodeId::DRIVE_Z => Some(b'Z'),
        NodeId::DRIVE_C => Some(b'C'),
        NodeId::SPINDLE_1 | NodeId::SPINDLE_2 | NodeId::SPINDLE_3 | NodeId::SPINDLE_4 => Some(b'S'),
        _ => None,
    }
}

impl BusTrouble {
    /// That of a controller; `None` for one that is well.
    #[must_use]
    pub const fn of(controller: Controller) -> Option<Self> {
        match controller.state {
            BusState::Active => None,
            BusState::Passive => Some(Self::Passive(controller.errors)),
            BusState::Off => Some(Self::Off(controller.errors)),
        }
    }

    /// The alarm, with its figures.
    #[must_use]
    pub fn alarm(self) -> Alarm {
        let number = |count: u32| Arg::Int(i64::from(count));
        let errors = |of: ErrorCounts| [number(of.sending.into()), number(of.receiving.into())];
        let drive = |node: NodeId| {
            [
                Arg::Letter(letter(node).unwrap_or(b'?')),
                number(node.get().into()),
            ]
        };
        let (code, [first, second]) = match self {
            Self::Off(counts) => (Code::BusOff, errors(counts)),
            Self::Passive(counts) => (Code::BusPassive, errors(counts)),
            Self::Late { count, limit } => (Code::SetpointsLate, [number(count), number(limit)]),
            Self::Intruder(Intrusion::Sync) => (Code::SecondSync, [Arg::None; 2]),
            Self::Intruder(Intrusion::Setpoint(node)) => (Code::SecondSetpoints, drive(node)),
            Self::Intruder(Intrusion::Network(node)) => (Code::SecondManager, drive(node)),
        };
        Alarm::new(code, Span::default()).with([first, second])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::{Controlword, DriveCommand, Increments, SyncProducer};

    #[test]
    fn what_only_the_board_may_say() {
        let setpoint = |node| {
            DriveCommand {
                control: Controlword::ENABLE_OPERATION,
                target: Increments::new(5),
            }
            .frame(node)
        };
        let cases = [
            (SyncProducer::new().next(), Some(Intrusion::Sync)),
            (
                setpoint(NodeId::DRIVE_Z),
                Some(Intrusion::Setpoint(NodeId::DRIVE_Z)),
            ),
            (
                setpoint(NodeId::SPINDLE_3),
                Some(Intrusion::Setpoint(NodeId::SPINDLE_3)),
            ),
            // Drives of another board.
            (setpoint(NodeId::new(48).unwrap()), None),
            (
                NmtCommand::Stop.frame(Some(NodeId::DRIVE_X)),
                Some(Intrusion::Network(NodeId::DRIVE_X)),
            ),
            (NmtCommand::Start.frame(Some(NodeId::DRIVE_X)), None),
            // To all: the board hears that as a node.
            (NmtCommand::ResetNode.frame(None), None),
            (NmtCommand::ResetNode.frame(Some(NodeId::BOARD)), None),
        ];
        for (frame, expected) in cases {
            assert_eq!(Intrusion::of(&frame), expected, "{frame:?}");
        }
    }

    #[test]
    fn alarms_have_their_figures() {
        let errors = ErrorCounts {
            sending: 136,
            receiving: 7,
        };
        let passive = Controller {
            state: BusState::Passive,
            errors,
        };
        let alarm = BusTrouble::of(passive).unwrap().alarm();
        assert_eq!(
            (alarm.number(), alarm.args[0], alarm.args[1]),
            (4371, Arg::Int(136), Arg::Int(7))
        );
        assert_eq!(BusTrouble::of(Controller::default()), None);
        let alarm = BusTrouble::Intruder(Intrusion::Setpoint(NodeId::DRIVE_Z)).alarm();
        assert_eq!(
            (alarm.number(), alarm.args[0], alarm.args[1]),
            (4374, Arg::Letter(b'Z'), Arg::Int(17))
        );
    }
}
