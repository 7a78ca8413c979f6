//! The machine with a network: whoever else is on the bus with it.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::bus::{FdFrame, Frame, NodeId, Periods};

use super::Sim;
use crate::line::Way;

impl Sim {
    /// The board joins a network as `node`; from now on every tick lets its device go on.
    ///
    /// # Errors
    /// As [`Board::join`](leadscrew_core::board::Board::join).
    pub fn join(&mut self, node: NodeId) -> Result<(), Alarm> {
        self.board.join(node)
    }

    /// Somebody else's frame reaches the board and the drives.
    pub fn receive(&mut self, frame: &Frame) {
        if self.wire.is_quiet() {
            self.hear(frame);
        } else {
            self.receive_on_bad_wire(frame);
        }
    }

    /// Somebody else's frame of CAN FD reaches the board and the drives.
    pub fn receive_fd(&mut self, frame: &FdFrame) {
        let (wire, plant, board) = (&mut self.wire, &mut self.plant, &mut self.board);
        wire.pass_together(Way::In, frame, |frame| {
            plant.tell_together(frame);
            board.receive_fd(frame);
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
            // With the drives' own there is room for a few; a bus that is flooded loses frames too.
            let _ = self.answers.push(*frame);
        }
        self.keep();
    }

    /// The next frame of the board as a node, or of a drive to who asked it, on its way to the others.
    pub fn transmit(&mut self) -> Option<Frame> {
        if !self.wire.is_quiet() || !self.out.is_empty() {
            return self.transmit_on_bad_wire();
        }
        self.next_out()
    }

    pub(super) fn next_out(&mut self) -> Option<Frame> {
        self.to_others.pop_front().or_else(|| self.board.transmit())
    }

    /// Everything the background can do is done, and no time goes by.
    pub fn settle(&mut self) {
        self.serve(Periods::new(0));
    }

    /// True where a tick would come too early in lock-step: the program runs, and its next call has not come.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.board.awaits_program()
    }

    /// True while a transfer is under way: where virtual time is fast, a client
    /// with nothing but real time needs it to wait.
    #[must_use]
    pub const fn is_transferring(&self) -> bool {
        self.board.is_transferring()
    }

    pub(super) fn serve(&mut self, elapsed: Periods) {
        let mut worked = self.board.serve(elapsed, &self.setpoint);
        while worked {
            worked = false;
            while self.board.background() {
                worked = true;
            }
            worked |= self.board.serve(Periods::new(0), &self.setpoint);
        }
    }
}
