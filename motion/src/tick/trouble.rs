//! Troubles of the bus as a whole, and their alarms.

use super::nodes::DriveNodes;
use crate::alarm::{Alarm, Arg, Code};
use crate::bus::Setpoints;
use crate::bus::{
    BusState, CobId, Controller, ErrorCounts, Frame, NmtCommand, NodeId, Service, is_sync,
};
use crate::units::Axis;

/// A trouble of the bus. Each is a controlled stop with an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusTrouble {
    /// The controller is bus-off: no frame reaches the drives.
    Off(ErrorCounts),
    /// The controller cannot read its own memory in time and sends nothing: no frame reaches the drives either.
    Restricted,
    /// The controller is error passive.
    Passive(ErrorCounts),
    /// More setpoints than allowed came late for their SYNC.
    Late {
        /// Late setpoints within a second.
        count: u32,
        /// The most that are allowed.
        limit: u32,
    },
    /// A second master.
    Intruder(Intrusion),
}

/// A frame that only the board may send, sent by another node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intrusion {
    /// SYNC.
    Sync,
    /// A setpoint for one of the board's drives.
    Setpoint(Victim),
    /// An NMT command that stops one of the board's drives from following.
    Network(Victim),
}

/// One of the board's drives that another node sends to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Victim {
    /// Its letter in messages.
    pub letter: u8,
    /// Its node.
    pub node: NodeId,
}

impl Intrusion {
    /// The intrusion in a frame from the bus, where the board's drives have these nodes. The board does not receive its own
    /// frames.
    #[must_use]
    pub fn of(frame: &Frame, drives: &DriveNodes) -> Option<Self> {
        if is_sync(frame) {
            return Some(Self::Sync);
        }
        let managed = frame.id() == CobId::NMT;
        let node = if managed {
            match NmtCommand::decode(frame)? {
                (NmtCommand::Start, _) => return None,
                (_, node) => node?,
            }
        } else {
            match frame.id().service()? {
                (Service::Rpdo1 | Service::Rpdo2, node) => node,
                _ => return None,
            }
        };
        let letter = drives.letter(node)?;
        let victim = Victim { letter, node };
        Some(match managed {
            true => Self::Network(victim),
            false => Self::Setpoint(victim),
        })
    }

    /// Setpoints are known by their identifier, in a classical frame or one of CAN FD: setpoints of one drive, or of all
    /// drives in the one frame of `board`, where the board sends such a frame (9031). For a frame to all drives, the first
    /// drive, X, is named.
    #[must_use]
    pub fn of_setpoints(id: CobId, drives: &DriveNodes, board: Option<NodeId>) -> Option<Self> {
        let node = match id.service()? {
            (Service::Rpdo1 | Service::Rpdo2, node) => node,
            _ if board.is_some_and(|board| id == Setpoints::cob_id(board)) => drives.axis(Axis::X),
            _ => return None,
        };
        let letter = drives.letter(node)?;
        Some(Self::Setpoint(Victim { letter, node }))
    }
}

impl BusTrouble {
    /// The trouble of a controller; `None` for a controller in the normal state.
    #[must_use]
    pub const fn of(controller: Controller) -> Option<Self> {
        match controller.state {
            BusState::Active => None,
            BusState::Passive => Some(Self::Passive(controller.errors)),
            BusState::Off => Some(Self::Off(controller.errors)),
            BusState::Restricted => Some(Self::Restricted),
        }
    }

    /// The alarm, with its figures.
    #[must_use]
    pub fn alarm(self) -> Alarm {
        let number = |count: u32| Arg::Int(i64::from(count));
        let errors = |of: ErrorCounts| [number(of.sending.into()), number(of.receiving.into())];
        let drive = |of: Victim| [Arg::Letter(of.letter), number(of.node.get().into())];
        let (code, [first, second]) = match self {
            Self::Off(counts) => (Code::BusOff, errors(counts)),
            Self::Restricted => (Code::BusRestricted, [Arg::None; 2]),
            Self::Passive(counts) => (Code::BusPassive, errors(counts)),
            Self::Late { count, limit } => (Code::SetpointsLate, [number(count), number(limit)]),
            Self::Intruder(Intrusion::Sync) => (Code::SecondSync, [Arg::None; 2]),
            Self::Intruder(Intrusion::Setpoint(of)) => (Code::SecondSetpoints, drive(of)),
            Self::Intruder(Intrusion::Network(of)) => (Code::SecondManager, drive(of)),
        };
        Alarm::of(code, &[first, second])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::{Controlword, DriveCommand, Increments, SyncProducer};
    use crate::params::{Entry, Params};

    const X: Victim = Victim {
        letter: b'X',
        node: NodeId::DRIVE_X,
    };
    const Z: Victim = Victim {
        letter: b'Z',
        node: NodeId::DRIVE_Z,
    };

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
            (setpoint(Z.node), Some(Intrusion::Setpoint(Z))),
            (
                setpoint(NodeId::SPINDLE_3),
                Some(Intrusion::Setpoint(Victim {
                    letter: b'S',
                    node: NodeId::SPINDLE_3,
                })),
            ),
            // Drives of another board.
            (setpoint(NodeId::new(48).unwrap()), None),
            (
                NmtCommand::Stop.frame(Some(X.node)),
                Some(Intrusion::Network(X)),
            ),
            (NmtCommand::Start.frame(Some(X.node)), None),
            // To all nodes: the board hears this as a node.
            (NmtCommand::ResetNode.frame(None), None),
            (NmtCommand::ResetNode.frame(Some(NodeId::BOARD)), None),
        ];
        let mut params = Params::sheets();
        let drives = DriveNodes::of(&params);
        for (frame, expected) in cases {
            assert_eq!(Intrusion::of(&frame, &drives), expected, "{frame:?}");
        }
        // Where the drives have other nodes, other nodes may be spoken to.
        let entry = Entry::find_text("9015.Z").unwrap();
        params.set(entry, 48).unwrap();
        let drives = DriveNodes::of(&params);
        let of = |frame: &Frame| Intrusion::of(frame, &drives);
        assert_eq!(of(&setpoint(Z.node)), None);
        let node = NodeId::new(48).unwrap();
        let moved = Intrusion::Setpoint(Victim { node, ..Z });
        assert_eq!(of(&setpoint(node)), Some(moved));
    }

    #[test]
    fn the_frame_for_all_drives_is_said_by_their_own_board() {
        let drives = DriveNodes::of(&Params::sheets());
        let (first, second) = (Some(NodeId::BOARD), NodeId::new(2));
        for (id, board, victim) in [
            (0x481, first, Some(X)),
            (0x482, second, Some(X)),
            // A frame of another board, a board whose drives have a frame each, and the fourth PDO of a drive.
            (0x482, first, None),
            (0x481, None, None),
            (0x490, first, None),
            (0x211, first, Some(Z)),
            (0x311, None, Some(Z)),
            (0x411, first, None),
        ] {
            let id = CobId::new(id).unwrap();
            let expected = victim.map(Intrusion::Setpoint);
            assert_eq!(
                Intrusion::of_setpoints(id, &drives, board),
                expected,
                "{id:?}"
            );
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
        let alarm = BusTrouble::Intruder(Intrusion::Setpoint(Z)).alarm();
        assert_eq!(
            (alarm.number(), alarm.args[0], alarm.args[1]),
            (4374, Arg::Letter(b'Z'), Arg::Int(17))
        );
    }
}
