//! The whole board, both contexts, and the operator.

use core::mem::ManuallyDrop;

use audit::any::{any, sink};
use leadscrew_core::board::device::dictionary;
use leadscrew_core::board::{Board, DriveNodes, Held, Output, PowerUp, Region, overridden};
use leadscrew_core::bus::Frame;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

/// Calls all entries of this module.
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
}

fn held(bytes: &[u8]) -> Held<'_> {
    if any() {
        Ok(bytes.get(..any()))
    } else {
        Err(any())
    }
}

#[inline(never)]
fn kept(params: &Params) -> PowerUp {
    let bytes: [u8; Region::LONGEST] = any();
    let marked = held(&bytes);
    sink(PowerUp::given(params));
    let mut up = PowerUp::of(|| params.clone(), marked, held(&bytes), held(&bytes));
    up.offsets.take(marked, held(&bytes), held(&bytes));
    up
}

#[inline(never)]
fn nodes(nodes: &DriveNodes) {
    for axis in Axis::ALL {
        sink(nodes.axis(axis));
    }
    sink((nodes.spindle(any()), nodes.letter(any())));
}

#[inline(never)]
fn board() {
    let params: Params = any();
    nodes(&DriveNodes::of(&params));
    let found = kept(&params);
    // No board that runs is ever dropped.
    sink(ManuallyDrop::new(Board::new(&params, any(), any())));
    let Ok(board) = Board::power_up(&found, any(), any()) else {
        return;
    };
    let mut board = ManuallyDrop::new(board);
    let mut output = Output::default();
    sink(board.join(any()));
    while any() {
        sink(board.receive(&any()));
        board.receive_fd(any());
        sink(board.serve());
        sink((board.transmit(), board.awaits_program()));
        sink(board.device().threads().last());
        board.set_late(any());
        sink(board.bus_state(any()));
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
            board.ticker().drive_nodes().letter(any()),
        ));
        if any() {
            board.command(any());
        }
        if let Some(region) = board.load() {
            let bytes: [u8; Region::LONGEST] = any();
            sink(region.key());
            board.loaded(held(&bytes));
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
