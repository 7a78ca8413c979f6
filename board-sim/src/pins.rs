//! What the board sees of the machine around it at its pins. Must not know who has set them.

use leadscrew_core::board::{BlockInputs, Board, Command, Inputs};
use leadscrew_core::units::Axis;

use crate::around::Around;
use crate::plant::Plant;

/// The board sees its pins. Where `pins` has no inputs of the machine, they are those of the devices around it.
pub fn show_pins(board: &mut Board, plant: &mut Plant, around: &mut Around, pins: Inputs) {
    let outputs = board.ticker().machine_outputs();
    // What a block does with its outputs is what it was told last, or what it does by itself.
    let outputs = match plant.block() {
        Some(block) => outputs & 0xFFFF | u32::from(block.outputs()) << 16,
        None => outputs,
    };
    // The gearbox has no sensors: what the board takes to be in is in.
    let gear = board.ticker().gear();
    plant.shift(board.params().gear(gear));
    let params = board.params();
    for axis in [Axis::X, Axis::Z] {
        if let Some(place) = plant.place(params, axis) {
            around.stand(params, axis, place);
        }
    }
    let wires = around.wires(board.params(), outputs);
    show_block(board, plant, (wires >> 16) as u16);
    let machine = pins.machine.or(Some(wires as u16));
    board.set_pins(Inputs { machine, ..pins });
}

/// The block sees its inputs. A board that has joined no network is told them at once: it has no bus for a block.
fn show_block(board: &mut Board, plant: &mut Plant, levels: u16) {
    if let Some(block) = plant.block() {
        block.set_inputs(levels);
    }
    let ticker = board.ticker();
    let on = levels ^ (board.params().inputs_inverted() >> 16) as u16;
    let differs =
        ticker.machine_known() >> 16 != 0xFFFF || ticker.machine_inputs() >> 16 != u32::from(on);
    if board.params().block_node() != 0 && !board.device().has_joined() && differs {
        board.command(Command::Block(BlockInputs {
            levels,
            known: 0xFFFF,
        }));
    }
}
