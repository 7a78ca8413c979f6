//! The machine around the board, over a reset: drives and spindle keep their power, and are where they were.

use core::mem::MaybeUninit;
use core::ptr::{addr_of, addr_of_mut, read_volatile, write_volatile};
use core::sync::atomic::{Ordering, compiler_fence};

use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_core::params::Params;

/// What stands in front of a plant that has been kept; memory at power-up does not look like it.
const MARK: u64 = 0x4C53_504C_414E_5431;

/// Periods that a start takes: nobody gives the beat meanwhile.
const START: u32 = 100;

#[repr(C)]
struct Memory {
    mark: u64,
    plant: MaybeUninit<Plant>,
}

// Neither loaded nor cleared at start.
#[unsafe(link_section = ".uninit.plant")]
static mut MEMORY: MaybeUninit<Memory> = MaybeUninit::uninit();

fn mark(value: u64) {
    let memory = addr_of_mut!(MEMORY).cast::<Memory>();
    compiler_fence(Ordering::SeqCst);
    // SAFETY: within `MEMORY`, aligned; one context at a time uses it: the thread
    // before the tick's interrupt is enabled, that interrupt from then on.
    unsafe { write_volatile(addr_of_mut!((*memory).mark), value) }
    compiler_fence(Ordering::SeqCst);
}

/// The plant as the reset has left it; at power-up none.
pub fn kept() -> Option<Plant> {
    let memory = addr_of!(MEMORY).cast::<Memory>();
    // SAFETY: as for writing; any bits are a number.
    let found = unsafe { read_volatile(addr_of!((*memory).mark)) };
    if found != MARK {
        return None;
    }
    // SAFETY: the mark stands only where this same image has written a whole plant behind it.
    let mut plant = unsafe { (*addr_of!((*memory).plant)).assume_init() };
    for _ in 0..START {
        plant.advance();
    }
    Some(plant)
}

/// One that has just been switched on.
///
/// # Panics
/// Where the parameters are those of no machine.
pub fn new(params: &Params, options: &PlantOptions) -> Plant {
    Plant::new(params, options).expect("it makes a machine, too")
}

/// Keeps it.
pub fn keep(plant: &Plant) {
    // A reset in between finds nothing rather than half of each.
    mark(0);
    let memory = addr_of_mut!(MEMORY).cast::<Memory>();
    // SAFETY: as above.
    unsafe { (*addr_of_mut!((*memory).plant)).write(*plant) };
    mark(MARK);
}
