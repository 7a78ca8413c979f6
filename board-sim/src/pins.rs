//! What the board sees of the machine around it at its pins. Must not know who has set them.

use leadscrew_core::board::{Board, Inputs};
use leadscrew_core::units::Axis;

use crate::around::Around;
use crate::plant::Plant;

/// The board sees its pins. Where `pins` has no inputs of the machine, they are those of the devices around it.
pub fn show_pins(board: &mut Board, plant: &mut Plant, around: &mut Around, pins: Inputs) {
    let outputs = board.ticker().machine_outputs();
    // The gearbox has no sensors: what the board takes to be in is in.
    let gear = board.ticker().gear();
    plant.shift(board.params().gear(gear));
    let params = board.params();
    for axis in [Axis::X, Axis::Z] {
        if let Some(place) = plant.place(params, axis) {
            around.stand(params, axis, place);
        }
    }
    let mut wires = || around.wires(board.params(), outputs);
    let machine = pins.machine.or_else(|| Some(wires()));
    board.set_pins(Inputs { machine, ..pins });
}
