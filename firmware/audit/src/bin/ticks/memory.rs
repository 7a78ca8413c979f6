//! The memory of a board: its parts in bytes, and the depth of its stack. The test fills the stack with a pattern
//! beforehand.

use core::hint::black_box;
use core::mem::size_of;
use core::ptr::{read_volatile, write_volatile};

use audit::work::{Counter, Work};
use leadscrew_core::board::{Board, Device, Events, Output, Planner, Segments, Ticker};
use leadscrew_core::motion::{Profile, Segment, ThreadPlan};
use leadscrew_core::params::Params;

use leadscrew_console::print;

/// Bytes of each part, as rows.
pub fn parts() {
    let parts = [
        ("board", size_of::<Board>()),
        ("ticker", size_of::<Ticker>()),
        ("planner", size_of::<Planner>()),
        ("device", size_of::<Device>()),
        ("segments", size_of::<Segments>()),
        ("events", size_of::<Events>()),
        ("params", size_of::<Params>()),
        ("output", size_of::<Output>()),
        ("profile", size_of::<Profile>()),
        ("segment", size_of::<Segment>()),
        ("thread-plan", size_of::<ThreadPlan>()),
    ];
    for (name, bytes) in parts {
        print(format_args!("bytes/{name} {bytes} {bytes}\n"));
    }
}

/// Prints the depth of the stack in the steps of every whole board, and in the work before a step: the background, and
/// the plant's part of a period.
pub struct Depths {
    /// The depth in a tick.
    tick: usize,
    /// The depth before a tick.
    background: usize,
}

impl Depths {
    /// No depth measured yet.
    pub const fn new() -> Self {
        Self {
            tick: 0,
            background: 0,
        }
    }

    /// Prints the rows.
    pub fn print(&self) {
        for (name, depth) in [("tick", self.tick), ("background", self.background)] {
            print(format_args!("stack/{name} {depth} {depth}\n"));
        }
    }
}

impl Counter for Depths {
    fn steps<W: Work>(&mut self, name: &str, work: &W) {
        if name != "board" {
            return;
        }
        let steps = work.steps();
        let mut state = work.begin();
        for number in 0..steps {
            let before = depth(|| work.prepare(black_box(&mut state), number));
            self.background = self.background.max(before);
            let mut out = None;
            let tick = depth(|| out = Some(work.step(black_box(&mut state), number)));
            self.tick = self.tick.max(tick);
            if let Some(out) = out {
                work.finish(&mut state, &out);
            }
        }
    }

    fn once<R>(&mut self, _: &str, _: impl FnMut() -> R) {}
}

/// Words filled with the pattern below the stack pointer: more than any step takes.
const WORDS: usize = 8 * 1024;
/// Stack that the filling itself may use.
const GAP: usize = 64;
const PAINT: u32 = 0x5AA5_C33C;

/// Bytes of stack that `what` takes at its deepest.
#[inline(never)]
fn depth(what: impl FnOnce()) -> usize {
    let here = stack_pointer();
    let top = here.wrapping_sub(GAP);
    let bottom = top.wrapping_sub(WORDS * 4);
    for word in 0..WORDS {
        // SAFETY: below the stack pointer and in RAM; nothing lives there, and no interrupt is enabled.
        unsafe { write_volatile((bottom + word * 4) as *mut u32, PAINT) };
    }
    run(what);
    let untouched = (0..WORDS)
        // SAFETY: as above.
        .take_while(|word| unsafe { read_volatile((bottom + word * 4) as *const u32) } == PAINT)
        .count();
    assert!(untouched > 0, "the stack is deeper than what is painted");
    here - (bottom + untouched * 4)
}

#[inline(never)]
fn run(what: impl FnOnce()) {
    what();
}

#[inline(always)]
fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: reads a register.
    unsafe {
        core::arch::asm!("mov {pointer}, sp", pointer = out(reg) pointer, options(nomem, nostack));
    }
    pointer
}
