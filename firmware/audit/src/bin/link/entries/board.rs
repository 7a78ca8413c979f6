//! The whole board, both contexts, and the operator.

use audit::any::{any, sink};
use leadscrew_core::board::station::dictionary;
use leadscrew_core::board::{Board, Held, Output, PowerUp, Region, overridden};
use leadscrew_core::bus::{Frame, Object};
use leadscrew_core::params::Params;

/// All of this room.
pub fn all() {
    board();
    sink(overridden(any(), any()));
    objects();
}

#[inline(never)]
fn objects() {
    for item in dictionary::items() {
        sink((item.object, item.kind.code(), item.access));
    }
    sink(dictionary::find(Object::new(any(), any())));
}

#[inline(never)]
fn board() {
    let params: Params = any();
    let Ok(mut board) = Board::new(&params, any(), any()) else {
        return;
    };
    let mut output = Output::default();
    sink(board.join(any()));
    while any() {
        sink(board.receive(&any()));
        sink(board.serve(any(), &output.setpoint));
        sink((board.transmit(), board.awaits_program()));
        board.set_late(any());
        board.bus_state(any());
        sink(board.may_rejoin());
        sink(board.offer(&any()));
        sink(board.background());
        let frames: [Frame; 8] = any();
        board.tick(any(), frames.get(..any()).unwrap_or(&frames), &mut output);
        sink(&output);
        sink((
            board.event(),
            board.is_busy(),
            board.ticker().in_program(),
            board.ticker().spindle_command(),
        ));
        if any() {
            board.command(any());
        }
        if let Some(request) = board.store() {
            let (region, mut buffer) = (request.region, [0; Region::LONGEST]);
            sink(request.fill(&mut buffer));
            board.stored(region, any());
        }
        sink(board.tap_record());
        if any() {
            sink(board.discard_tap());
        }
    }
}
