//! The machine around the board: spindle, drives, door and contacts. It outlives a reset of the board: drives and spindle
//! keep their power and their positions. Where the power of all goes, the axes stay where they are.

use core::mem::MaybeUninit;
use core::ptr::{addr_of, addr_of_mut, read_volatile, write_volatile};
use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::peripheral::SCB;
use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_board_sim::{Around, fit_switches, places};
use leadscrew_core::board::Inputs;
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;

/// The mark before a kept machine; memory at power-up does not look like it.
const MARK: u64 = 0x4C53_504C_414E_5431;

/// SYNC periods that a start takes. The board sends no SYNC meanwhile.
const START: u32 = 100;

/// What a hand does at the machine.
#[derive(Clone, Copy, Debug)]
pub enum Touch {
    /// It opens the door, or closes it.
    Door(bool),
    /// It presses the emergency stop, or releases it.
    Stop(bool),
    /// It presses feed hold, or releases it.
    Hold(bool),
    /// It takes the power of board and drives, and gives it again.
    Power,
}

/// The machine.
#[derive(Clone, Copy)]
pub struct Lathe {
    pub plant: Plant,
    around: Around,
    door_open: bool,
    stop: bool,
    hold: bool,
    /// The levels at the board's inputs, and the outputs to which they belong; `None` where they are to be found anew. To
    /// find them in each tick would take longer than the tick.
    wires: Option<(u16, u16)>,
    /// Where the axes stand since the power has gone.
    off: Option<Position>,
}

impl Lathe {
    /// A machine that has just been switched on: its axes stand here, and a hand has left its contacts so.
    ///
    /// # Panics
    /// Where the parameters describe no machine.
    pub fn switched_on(params: &Params, at: Position, before: Option<&Self>) -> Self {
        let options = PlantOptions {
            at,
            ..PlantOptions::default()
        };
        let mut plant = Plant::new(params, &options).expect("it makes a machine, too");
        fit_switches(&mut plant, params);
        let mut around = Around::default();
        let door_open = before.is_some_and(|lathe| lathe.door_open);
        around.open_door(door_open);
        Self {
            plant,
            around,
            door_open,
            stop: before.is_some_and(|lathe| lathe.stop),
            hold: before.is_some_and(|lathe| lathe.hold),
            wires: None,
            off: None,
        }
    }

    /// Where the axes stand, if the power has gone.
    pub const fn off(&self) -> Option<Position> {
        self.off
    }

    /// A hand does this. The power goes and comes with a start of the board: that call does not return.
    pub fn touch(&mut self, params: &Params, touch: Touch) {
        match touch {
            Touch::Door(open) => {
                self.door_open = open;
                self.around.open_door(open);
                self.wires = None;
            }
            Touch::Stop(pressed) => self.stop = pressed,
            Touch::Hold(pressed) => self.hold = pressed,
            Touch::Power => {
                self.off = places(&self.plant, params);
                self.keep();
                leadscrew_fault::forget();
                SCB::sys_reset()
            }
        }
    }

    /// What the board sees at its pins while these outputs are on.
    pub fn pins(&mut self, params: &Params, outputs: u16) -> Inputs {
        let wires = match self.wires {
            Some((of, wires)) if of == outputs => wires,
            _ => self.around.wires(params, outputs.into()) as u16,
        };
        self.wires = Some((outputs, wires));
        Inputs {
            stop: self.stop,
            hold: self.hold,
            machine: Some(wires),
            ..Inputs::default()
        }
    }

    /// Keeps it over a reset.
    pub fn keep(&self) {
        // A reset in between finds no machine, rather than a mixture of two.
        mark(0);
        let memory = addr_of_mut!(MEMORY).cast::<Memory>();
        // SAFETY: within `MEMORY`, aligned; see `mark`.
        unsafe { (*addr_of_mut!((*memory).lathe)).write(*self) };
        mark(MARK);
    }

    /// The machine that the reset has left in memory; `None` where there is none.
    pub fn kept() -> Option<Self> {
        let memory = addr_of!(MEMORY).cast::<Memory>();
        // SAFETY: as for writing; any bits are a number.
        let found = unsafe { read_volatile(addr_of!((*memory).mark)) };
        if found != MARK {
            return None;
        }
        // SAFETY: the mark is set only where this same image has written a whole machine after it.
        let mut lathe = unsafe { (*addr_of!((*memory).lathe)).assume_init() };
        if lathe.off.is_none() {
            for _ in 0..START {
                lathe.plant.advance();
            }
        }
        Some(lathe)
    }
}

#[repr(C)]
struct Memory {
    mark: u64,
    lathe: MaybeUninit<Lathe>,
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
