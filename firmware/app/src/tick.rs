//! The tick's context: one SYNC period of the whole board, run in an interrupt.

use leadscrew_core::board::{Inputs, Output, Switching, TickSide};
use leadscrew_core::bus::{Frame, Setpoints};
use leadscrew_core::spindle::EncoderSample;

/// The hardware that a board provides to the tick. All functions are called in the timer interrupt; none may wait.
pub trait TickMachine {
    /// The sample of the spindle's encoder at this SYNC. The first call of a tick.
    fn sample(&mut self) -> EncoderSample;
    /// The state of the input pins.
    fn inputs(&mut self) -> Inputs;
    /// The oldest frame from the bus that is not yet read. All frames of the drives have to come this way. The tick
    /// passes all others to the background.
    fn receive(&mut self) -> Option<Frame>;
    /// Sends the frames of a tick, in this order and before any other frame; behind them, where 9031 asks for it, the
    /// frame of CAN FD with the setpoints of all drives. False where some frames of the previous tick have not left:
    /// these are dropped, and their setpoints are late.
    fn send(&mut self, frames: &[Frame], together: Option<&Setpoints>) -> bool;
    /// Switches a machine function that a program asks for, or takes all of them back after a reset. While the machine
    /// has not followed, [`Inputs::unanswered`] says so, from the next tick on.
    fn switch(&mut self, _switching: Switching) {}
    /// Sets the machine's outputs, bit 0 for output 1; called in every tick.
    fn set_outputs(&mut self, _outputs: u16) {}
    /// Feeds the watchdog: both sides are alive.
    fn feed_watchdog(&mut self);
}

/// Runs one SYNC period. `output` is that of the tick before; it is written anew.
pub fn tick(side: &mut TickSide<'_>, output: &mut Output, machine: &mut impl TickMachine) {
    let sample = machine.sample();
    let inputs = machine.inputs();
    side.begin(&inputs, core::iter::from_fn(|| machine.receive()));
    side.run(sample, output);
    if output.switching != Switching::Nothing {
        machine.switch(output.switching);
    }
    machine.set_outputs(output.outputs);
    let sent = machine.send(&output.frames, output.together.as_ref());
    side.report(output, sent);
    if side.is_heard() {
        machine.feed_watchdog();
    }
}
