//! The machine with a network: the other nodes on the bus.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::bus::{FdFrame, Frame, NodeId};

use super::{Direction, Sim};
use crate::line::Way;

impl Sim {
    /// The board joins a network as `node`; from now on every tick runs its device.
    ///
    /// # Errors
    /// As [`Board::join`](leadscrew_core::board::Board::join).
    pub fn join(&mut self, node: NodeId) -> Result<(), Alarm> {
        self.board.join(node)
    }

    /// A frame of another node reaches the board and the drives.
    pub fn receive(&mut self, frame: &Frame) {
        if self.wire.is_quiet() {
            self.hear(frame);
        } else {
            self.receive_on_bad_wire(frame);
        }
    }

    /// A CAN FD frame of another node reaches the board and the drives.
    pub fn receive_fd(&mut self, frame: &FdFrame) {
        let (wire, plant, board) = (&mut self.wire, &mut self.plant, &mut self.board);
        wire.pass_together(Way::In, frame, |frame| {
            plant.tell_together(frame);
            board.receive_fd(frame.id());
        });
        self.keep();
    }

    pub(super) fn hear(&mut self, frame: &Frame) {
        let others = &mut self.to_others;
        self.plant.hear(frame, |answer| {
            // A client waits for its answer before it asks again.
            let _ = others.push_back(answer);
        });
        if self.board.receive(frame) {
            // Next to the drives' frames there is room for a few; a flooded bus loses frames too.
            let _ = self.answers.push(*frame);
        }
        self.keep();
    }

    /// The next frame to other nodes: from the board as a node, or from a drive that was asked.
    pub fn transmit(&mut self) -> Option<Frame> {
        if !self.wire.is_quiet() || !self.out.is_empty() {
            return self.transmit_on_bad_wire();
        }
        self.next_out()
    }

    pub(super) fn next_out(&mut self) -> Option<Frame> {
        if let Some(answer) = self.to_others.pop_front() {
            return Some(answer);
        }
        let frame = self.board.transmit()?;
        // Nobody asks a block for anything by these.
        self.plant.hear_board(&frame, |_| ());
        Some(frame)
    }

    /// A SYNC period of the block on the bus.
    pub(super) fn pass_block(&mut self, wire: &mut dyn FnMut(Direction, &Frame)) {
        let board = &mut self.board;
        self.plant.elapse_block(|frame| {
            wire(Direction::ToBoard, &frame);
            let _ = board.receive(&frame);
        });
    }

    /// Does all work of the background, and lets no time pass.
    pub fn settle(&mut self) {
        self.serve();
    }

    /// True where a tick would come too early in lock-step: the program runs, and its next call has not come.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.board.awaits_program()
    }

    /// True while a transfer runs. Where virtual time is fast, time has to wait for a client that knows real time only.
    #[must_use]
    pub const fn is_transferring(&self) -> bool {
        self.board.device().is_transferring()
    }

    pub(super) fn serve(&mut self) {
        let mut worked = self.board.serve();
        while worked {
            worked = false;
            while self.board.background() {
                worked = true;
            }
            worked |= self.board.serve();
        }
    }
}
