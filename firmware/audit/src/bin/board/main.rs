#![no_std]
#![no_main]
//! The flash that a board takes: everything of the core that runs on a board, and nothing else. This image is never
//! run. Its size is in the table. Each step is a function of its own, so that its stack can be read from the image.

use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::ptr::addr_of_mut;

use audit::any::{any, sink};
use leadscrew_core::board::{Board, Output, Region};
use leadscrew_core::bus::Frame;
use leadscrew_core::params::Params;

static mut BOARD: MaybeUninit<Board> = MaybeUninit::uninit();
static mut OUTPUT: MaybeUninit<Output> = MaybeUninit::uninit();

/// The entry of the image.
#[unsafe(no_mangle)]
pub extern "C" fn entry() {
    let Some((board, output)) = start() else {
        return;
    };
    while any() {
        tick(board, output);
        hear(board);
        serve(board);
        plan(board);
        say(board);
        store(board);
    }
}

#[inline(never)]
fn start() -> Option<(&'static mut Board, &'static mut Output)> {
    // The built-in set; any other set comes over the bus.
    let board = Board::new(&Params::sheets(), any(), any()).ok()?;
    // SAFETY: done once, and nothing has a reference to the two places yet.
    let (place, output) = unsafe { (&mut *addr_of_mut!(BOARD), &mut *addr_of_mut!(OUTPUT)) };
    Some((place.write(board), output.write(Output::default())))
}

#[inline(never)]
fn tick(board: &mut Board, output: &mut Output) {
    let frames: [Frame; 8] = any();
    board.tick(any(), frames.get(..any()).unwrap_or(&frames), output);
    sink(&*output);
}

#[inline(never)]
fn hear(board: &mut Board) {
    sink(board.join(any()));
    sink(board.receive(&any()));
    if any() {
        board.signals(any());
    }
}

#[inline(never)]
fn serve(board: &mut Board) {
    sink(board.serve());
    board.set_late(any());
}

#[inline(never)]
fn plan(board: &mut Board) {
    sink(board.background());
}

#[inline(never)]
fn say(board: &mut Board) {
    sink((board.event(), board.transmit(), board.awaits_program()));
}

#[inline(never)]
fn store(board: &mut Board) {
    if let Some(request) = board.store() {
        let (region, mut buffer) = (request.region, [0; Region::LONGEST]);
        sink(request.fill(&mut buffer));
        board.stored(region, any());
    }
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    unsafe extern "C" {
        fn a_panic_is_reachable() -> !;
    }
    // SAFETY: never called; an image that could call it does not link.
    unsafe { a_panic_is_reachable() }
}
