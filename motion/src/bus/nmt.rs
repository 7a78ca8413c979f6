//! Network management: starting and stopping nodes, boot-up messages and heartbeats.

use super::frame::{CobId, Frame, NodeId, Service};

/// A command of the NMT master to a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum NmtCommand {
    /// To operational: PDOs are active.
    Start = 0x01,
    /// To stopped: only heartbeats.
    Stop = 0x02,
    /// To pre-operational: only configuration.
    PreOperational = 0x80,
    /// Restart the application.
    ResetNode = 0x81,
    /// Restart the communication.
    ResetCommunication = 0x82,
}

impl NmtCommand {
    /// The frame for one node, or for all with `None`.
    #[must_use]
    pub const fn frame(self, node: Option<NodeId>) -> Frame {
        let number = match node {
            Some(node) => node.get(),
            None => 0,
        };
        Frame::of(CobId::NMT, [self as u8, number])
    }

    /// The command in `frame` and its node (`None`: all nodes); `None` if `frame` is no NMT command.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(Self, Option<NodeId>)> {
        if frame.id() != CobId::NMT {
            return None;
        }
        let [command, number] = frame.exactly()?;
        let command = match command {
            0x01 => Self::Start,
            0x02 => Self::Stop,
            0x80 => Self::PreOperational,
            0x81 => Self::ResetNode,
            0x82 => Self::ResetCommunication,
            _ => return None,
        };
        match number {
            0 => Some((command, None)),
            _ => Some((command, Some(NodeId::new(number)?))),
        }
    }
}

/// The state that a node reports in its heartbeat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum NmtState {
    /// The single message after a restart.
    BootUp = 0x00,
    /// Only heartbeats.
    Stopped = 0x04,
    /// PDOs are active.
    Operational = 0x05,
    /// Only configuration.
    PreOperational = 0x7F,
}

impl NmtState {
    /// The heartbeat (or boot-up message) of `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        Frame::of(CobId::of(Service::Heartbeat, node), [self as u8])
    }

    /// The node and its state, if `frame` is a heartbeat.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Heartbeat, node) = frame.id().service()? else {
            return None;
        };
        let state = match frame.exactly()? {
            [0x00] => Self::BootUp,
            [0x04] => Self::Stopped,
            [0x05] => Self::Operational,
            [0x7F] => Self::PreOperational,
            [_] => return None,
        };
        Some((node, state))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_and_states_have_their_bytes_and_read_back() {
        let n = NodeId::DRIVE_X;
        for (command, byte) in [
            (NmtCommand::Start, 0x01),
            (NmtCommand::Stop, 0x02),
            (NmtCommand::PreOperational, 0x80),
            (NmtCommand::ResetNode, 0x81),
            (NmtCommand::ResetCommunication, 0x82),
        ] {
            assert_eq!(command.frame(Some(n)).payload(), [byte, 0x10]);
            assert_eq!(command.frame(None).payload(), [byte, 0]);
            assert_eq!(
                NmtCommand::decode(&command.frame(Some(n))),
                Some((command, Some(n)))
            );
            assert_eq!(
                NmtCommand::decode(&command.frame(None)),
                Some((command, None))
            );
        }
        for (state, byte) in [
            (NmtState::BootUp, 0x00),
            (NmtState::Stopped, 0x04),
            (NmtState::Operational, 0x05),
            (NmtState::PreOperational, 0x7F),
        ] {
            let frame = state.frame(n);
            assert_eq!((frame.id().get(), frame.payload()), (0x710, &[byte][..]));
            assert_eq!(NmtState::decode(&frame), Some((n, state)));
        }
    }

    #[test]
    fn what_is_no_command_is_none() {
        let nmt = |bytes: &[u8]| NmtCommand::decode(&Frame::new(CobId::NMT, bytes).unwrap());
        assert_eq!(nmt(&[0x01]), None);
        assert_eq!(nmt(&[0x03, 0x10]), None);
        assert_eq!(nmt(&[0x01, 0x80]), None);
        assert_eq!(
            NmtCommand::decode(&Frame::new(CobId::SYNC, &[1, 0]).unwrap()),
            None
        );
        assert_eq!(
            NmtState::decode(&Frame::new(CobId::SYNC, &[5]).unwrap()),
            None
        );
        let odd = Frame::new(CobId::of(Service::Heartbeat, NodeId::DRIVE_X), &[0x42]).unwrap();
        assert_eq!(NmtState::decode(&odd), None);
    }
}
