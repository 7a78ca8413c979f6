//! The machine around the board. It outlives a reset of the board: drives and spindle keep their power and their positions.

use core::mem::MaybeUninit;
use core::ptr::{addr_of, addr_of_mut, read_volatile, write_volatile};
use core::sync::atomic::{Ordering, compiler_fence};

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_core::params::Params;

/// The mark before a kept plant; memory at power-up does not look like it.
const MARK: u64 = 0x4C53_504C_414E_5431;

/// SYNC periods that a start takes. The board sends no SYNC meanwhile.
const START: u32 = 100;

#[repr(C)]
struct Memory {
    mark: u64,
    plant: MaybeUninit<Plant>,
}

// The start code neither loads nor clears this section.
#[unsafe(link_section = ".uninit.plant")]
static mut MEMORY: MaybeUninit<Memory> = MaybeUninit::uninit();

fn mark(value: u64) {
    let memory = addr_of_mut!(MEMORY).cast::<Memory>();
    compiler_fence(Ordering::SeqCst);
    // SAFETY: within `MEMORY`, aligned. One context at a time uses it: the thread before the tick's interrupt is
    // enabled, that interrupt afterwards.
    unsafe { write_volatile(addr_of_mut!((*memory).mark), value) }
    compiler_fence(Ordering::SeqCst);
}

/// The plant that the reset has left in memory; `None` at power-up.
pub fn kept() -> Option<Plant> {
    let memory = addr_of!(MEMORY).cast::<Memory>();
    // SAFETY: as for writing; any bits are a number.
    let found = unsafe { read_volatile(addr_of!((*memory).mark)) };
    if found != MARK {
        return None;
    }
    // SAFETY: the mark is set only where this same image has written a whole plant after it.
    let mut plant = unsafe { (*addr_of!((*memory).plant)).assume_init() };
    for _ in 0..START {
        plant.advance();
    }
    Some(plant)
}

/// A plant that has just been switched on.
///
/// # Panics
/// Where the parameters describe no machine.
pub fn new(params: &Params, options: &PlantOptions) -> Plant {
    Plant::new(params, options).expect("it makes a machine, too")
}

/// Keeps the plant over a reset.
pub fn keep(plant: &Plant) {
    // A reset in between finds no plant, rather than a mixture of two.
    mark(0);
    let memory = addr_of_mut!(MEMORY).cast::<Memory>();
    // SAFETY: as above.
    unsafe { (*addr_of_mut!((*memory).plant)).write(*plant) };
    mark(MARK);
}
