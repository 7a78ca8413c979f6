//! A board on a bus, for owners with one thread: routes frames, runs the device, and carries out the device's requests.
//!
//! ```text
//! each frame ─► receive() ─► true: a drive's, keep it for tick()
//! tick(), then send its frames
//! event() until there is none; serve(); background() until there is no work
//! transmit() as often as the bus has room, after the frames of the tick
//! ```

use super::queue::{Detours, Segments};
use super::reference::Reference;
use super::{Board, Contacts, Snapshot};
use crate::alarm::Alarm;
use crate::bus::FdFrame;
use crate::bus::{Controller, Frame, NodeId, Periods};
use crate::motion::Setpoint;
use crate::params::Params;

impl Board {
    /// Joins a network as `node`: from now on the board hears and sends frames. An NMT master starts it.
    ///
    /// # Errors
    /// [`Code::BusOverload`](crate::alarm::Code::BusOverload) where the cycle leaves no room on the bus;
    /// [`Code::DriveNodeOfBoard`](crate::alarm::Code::DriveNodeOfBoard) where a drive has this number.
    pub fn join(&mut self, node: NodeId) -> Result<(), Alarm> {
        self.background.join(node)
    }

    /// The parameter set in force.
    #[must_use]
    pub const fn params(&self) -> &Params {
        self.background.params()
    }

    /// Takes a frame from the bus. True for a frame of a drive: keep it for the next [`tick`](Self::tick).
    #[must_use]
    pub fn receive(&mut self, frame: &Frame) -> bool {
        let not_taken = self.background.receive(frame);
        self.carry_out();
        not_taken
    }

    /// Takes a frame of CAN FD from the bus.
    pub fn receive_fd(&mut self, frame: &FdFrame) {
        self.background.receive_fd(frame);
        self.carry_out();
    }

    /// Runs the device, `elapsed` periods after the last call, after the tick that gave `setpoint`. True where a call went
    /// to the planner.
    pub fn serve(&mut self, elapsed: Periods, setpoint: &Setpoint) -> bool {
        // Before any call goes to the planner.
        self.heed();
        let snapshot = Snapshot::new(&self.ticker, setpoint, Contacts::default());
        let (ticker, head) = (&self.ticker, self.segments.peek());
        let measured = if elapsed == Periods::new(1) {
            self.reference.error(ticker, head, setpoint)
        } else {
            self.reference.renew(ticker, head, setpoint);
            None
        };
        let worked = self
            .background
            .serve(elapsed, snapshot, measured, &mut self.ticker);
        self.carry_out();
        worked
    }

    /// The next frame of the device to send.
    pub fn transmit(&mut self) -> Option<Frame> {
        self.background.transmit()
    }

    /// True while a transfer is under way.
    #[must_use]
    pub const fn is_transferring(&self) -> bool {
        self.background.is_transferring()
    }

    /// True where the next call of a running program has not come and would have room. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.background.awaits_program()
    }

    /// Sets the number of setpoints that were late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.background.set_late(late);
    }

    /// Sets the state of the CAN controller; see [`Device::set_controller`](super::Device::set_controller).
    pub fn bus_state(&mut self, controller: Controller) {
        self.background.set_controller(controller);
        self.carry_out();
    }

    /// True where a controller that has left the bus may be started again.
    #[must_use]
    pub const fn may_rejoin(&self) -> bool {
        self.background.device().may_rejoin()
    }

    /// The board as a CANopen device.
    #[must_use]
    pub const fn device(&self) -> &super::Device {
        self.background.device()
    }

    pub(super) fn carry_out(&mut self) {
        if self.background.carry_out(&mut self.ticker) {
            self.restart();
        }
    }

    /// Starts the application again with the present parameter set. Nothing moves; the drives are enabled again.
    fn restart(&mut self) {
        let found = self.background.device().found();
        let Some(position) = self.ticker.begin_anew(self.background.params(), found) else {
            // The set was checked before it was staged; otherwise the board stays at rest [D148].
            return;
        };
        self.background.begin_anew(position);
        self.segments = Segments::new();
        self.detours = Detours::new();
        self.reference = Reference::default();
    }
}
