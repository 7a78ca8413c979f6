//! The NMT state of this node, and the services that each state allows.
//!
//! ```text
//!            boot()                 start
//! restarted ────────► pre-operational ◄──► operational      reset node, reset communication,
//!     ▲                     ▲  ▼              ▲  ▼          from any state ──► restarted
//!     └─────────────────────┴ stopped ◄───────┴──┘
//! ```

use super::frame::{Frame, NodeId};
use super::nmt::{NmtCommand, NmtState};

impl NmtState {
    /// Values can be read and written.
    #[must_use]
    pub const fn allows_sdo(self) -> bool {
        matches!(self, Self::PreOperational | Self::Operational)
    }

    /// Process data are sent, and received process data take effect.
    #[must_use]
    pub const fn allows_pdo(self) -> bool {
        matches!(self, Self::Operational)
    }

    /// SYNC is produced, or a received SYNC takes effect.
    #[must_use]
    pub const fn allows_sync(self) -> bool {
        self.allows_sdo()
    }

    /// Emergency messages are sent.
    #[must_use]
    pub const fn allows_emcy(self) -> bool {
        self.allows_sdo()
    }
}

/// The effect of an NMT command on the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NmtEvent {
    /// The node has changed to this state.
    Entered(NmtState),
    /// Restart everything, then [`NmtSlave::boot`].
    ResetNode,
    /// Set the communication objects (1000h–1FFFh) to their power-up values, then [`NmtSlave::boot`].
    ResetCommunication,
}

/// The NMT state of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NmtSlave {
    node: NodeId,
    state: NmtState,
}

impl NmtSlave {
    /// A node that has not booted yet: it sends nothing and ignores all frames.
    #[must_use]
    pub const fn new(node: NodeId) -> Self {
        Self {
            node,
            state: NmtState::BootUp,
        }
    }

    /// The node number.
    #[must_use]
    pub const fn node(&self) -> NodeId {
        self.node
    }

    /// The state; [`NmtState::BootUp`] until the node has booted.
    #[must_use]
    pub const fn state(&self) -> NmtState {
        self.state
    }

    /// Brings the ready node to pre-operational and gives its boot-up message.
    pub const fn boot(&mut self) -> Frame {
        self.state = NmtState::PreOperational;
        NmtState::BootUp.frame(self.node)
    }

    /// Takes a frame; gives the effect of an NMT command to this node or to all nodes. A command for the present state
    /// has no effect.
    pub fn receive(&mut self, frame: &Frame) -> Option<NmtEvent> {
        let (command, node) = NmtCommand::decode(frame)?;
        if self.state == NmtState::BootUp || node.is_some_and(|node| node != self.node) {
            return None;
        }
        match command {
            NmtCommand::Start => self.enter(NmtState::Operational),
            NmtCommand::Stop => self.enter(NmtState::Stopped),
            NmtCommand::PreOperational => self.enter(NmtState::PreOperational),
            NmtCommand::ResetNode => {
                self.state = NmtState::BootUp;
                Some(NmtEvent::ResetNode)
            }
            NmtCommand::ResetCommunication => {
                self.state = NmtState::BootUp;
                Some(NmtEvent::ResetCommunication)
            }
        }
    }

    fn enter(&mut self, state: NmtState) -> Option<NmtEvent> {
        let before = core::mem::replace(&mut self.state, state);
        (before != state).then_some(NmtEvent::Entered(state))
    }

    /// The heartbeat of the present state.
    #[must_use]
    pub const fn heartbeat(&self) -> Frame {
        self.state.frame(self.node)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_in_every_state() {
        use NmtState::{Operational, PreOperational, Stopped};
        let all = [PreOperational, Operational, Stopped];
        for from in all {
            for (command, to) in [
                (NmtCommand::Start, Operational),
                (NmtCommand::Stop, Stopped),
                (NmtCommand::PreOperational, PreOperational),
            ] {
                let mut slave = NmtSlave {
                    node: NodeId::BOARD,
                    state: from,
                };
                let event = slave.receive(&command.frame(Some(NodeId::BOARD)));
                assert_eq!(event, (from != to).then_some(NmtEvent::Entered(to)));
                assert_eq!(slave.state(), to);
                assert_eq!(slave.heartbeat(), to.frame(NodeId::BOARD));
            }
            for (command, event) in [
                (NmtCommand::ResetNode, NmtEvent::ResetNode),
                (NmtCommand::ResetCommunication, NmtEvent::ResetCommunication),
            ] {
                let mut slave = NmtSlave {
                    node: NodeId::BOARD,
                    state: from,
                };
                assert_eq!(slave.receive(&command.frame(None)), Some(event));
                // The node ignores commands until it has booted again.
                assert_eq!(slave.receive(&NmtCommand::Start.frame(None)), None);
                assert_eq!(slave.boot().payload(), [0x00]);
                assert_eq!(slave.state(), PreOperational);
            }
        }
    }

    #[test]
    fn commands_to_others_are_not_for_it() {
        let mut slave = NmtSlave::new(NodeId::BOARD);
        let _ = slave.boot();
        assert_eq!(
            slave.receive(&NmtCommand::Start.frame(Some(NodeId::DRIVE_X))),
            None
        );
        assert_eq!(slave.state(), NmtState::PreOperational);
    }

    #[test]
    fn what_is_allowed_where() {
        let allowed = |state: NmtState| {
            [
                state.allows_sdo(),
                state.allows_pdo(),
                state.allows_sync(),
                state.allows_emcy(),
            ]
        };
        assert_eq!(allowed(NmtState::BootUp), [false; 4]);
        assert_eq!(allowed(NmtState::PreOperational), [true, false, true, true]);
        assert_eq!(allowed(NmtState::Operational), [true; 4]);
        assert_eq!(allowed(NmtState::Stopped), [false; 4]);
    }
}
