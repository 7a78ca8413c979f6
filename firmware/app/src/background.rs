//! The background's context: the services on the bus, the planning and the storage, a small piece of work at a time.

use leadscrew_core::board::{BackgroundSide, Event, Held, Region, StoreError, StoreRequest};
use leadscrew_core::bus::{CobId, Controller, Frame};
use leadscrew_core::params::Params;

/// The hardware that a board provides to the background. No function may wait longer than a few milliseconds: planning
/// stands still meanwhile.
pub trait Machine {
    /// The oldest frame from the bus that is not yet read. Frames of drives need not come this way.
    fn receive(&mut self) -> Option<Frame>;
    /// The identifier of the oldest frame of CAN FD from the bus that is not yet read. Some may be left out: they are
    /// looked at for setpoints of another node alone, which come again.
    fn receive_fd(&mut self) -> Option<CobId>;
    /// True where there is room for a frame. It leaves after the frames of the tick.
    fn has_room(&self) -> bool;
    /// Sends a frame. There is room.
    fn send(&mut self, frame: &Frame);
    /// The detent that the handwheel at the board's own input is in, which wraps; always the same where there is none.
    fn handwheel(&mut self) -> u16;
    /// Begins to store: the board copies the bytes into a buffer of its own. The previous request is done.
    fn store(&mut self, request: &StoreRequest<'_>);
    /// Continues to store. Gives the result once the request is done.
    fn stored(&mut self) -> Option<Result<(), StoreError>>;
    /// How often each page of the storage has been erased, where that request has made it more.
    fn erases(&mut self) -> Option<u32>;
    /// Reads a region of the storage and calls `then` once with its content.
    fn load(&mut self, region: Region, then: &mut dyn FnMut(Held<'_>));
    /// Tells the board an event: for a log, and for the board's switches.
    fn event(&mut self, event: &Event);
    /// The state of the CAN controller.
    fn controller(&mut self) -> Controller;
    /// Takes part in the bus again, after bus-off or where the controller has stopped sending. The machine stands, and
    /// its drives have been let go.
    fn rejoin(&mut self);
    /// The application begins anew with these parameters. They include the time between two SYNCs.
    fn begin_anew(&mut self, params: &Params);
}

// The pieces of `step` are functions of their own, so that each needs stack only while it runs.

/// Does one piece of each kind of work. False where there is nothing to do until the next tick or the next frame.
pub fn step(side: &mut BackgroundSide<'_>, machine: &mut impl Machine) -> bool {
    let heard = side.hear();
    while let Some(event) = side.event() {
        machine.event(&event);
    }
    if let Some(params) = side.begun_anew() {
        machine.begin_anew(params);
    }
    let mut worked = heard;
    worked |= receive(side, machine);
    if heard {
        side.own_wheel(machine.handwheel());
    }
    if heard && side.set_controller(machine.controller()) {
        machine.rejoin();
    }
    worked |= side.serve();
    let (planned, warning) = side.plan();
    if let Some(warning) = warning {
        machine.event(&warning);
    }
    worked |= planned;
    worked |= store(side, machine);
    while machine.has_room()
        && let Some(frame) = side.state_mut().transmit()
    {
        machine.send(&frame);
    }
    worked
}

#[inline(never)]
fn receive(side: &mut BackgroundSide<'_>, machine: &mut impl Machine) -> bool {
    let mut worked = false;
    while let Some(frame) = machine.receive() {
        // What is not for the board as a node is a drive's, and has gone to the tick.
        let _ = side.receive(&frame);
        worked = true;
    }
    while let Some(id) = machine.receive_fd() {
        side.receive_fd(id);
        worked = true;
    }
    worked
}

#[inline(never)]
fn store(side: &mut BackgroundSide<'_>, machine: &mut impl Machine) -> bool {
    if let Some(region) = side.state().storing() {
        if !side.takes_stored() {
            return false;
        }
        let Some(result) = machine.stored() else {
            return false;
        };
        if let Some(erases) = machine.erases() {
            side.state_mut().set_erases(erases);
        }
        side.stored(region, result);
    }
    let state = side.state_mut();
    if let Some(region) = state.load() {
        machine.load(region, &mut |held| state.loaded(held));
    }
    let Some(request) = state.store() else {
        return false;
    };
    machine.store(&request);
    true
}
