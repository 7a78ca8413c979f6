//! The wire of this chip: FDCAN1 and TIM6 for [`leadscrew_parts::Rings`], which has the rules; and the interrupt right
//! below the tick.

#[cfg(feature = "defmt")]
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::interrupt;
use leadscrew_parts::{BackgroundEnd, BusEnd, Chip, Heard, Places, Rings, TickEnd};

use crate::owned::{Once, Owned};
use crate::{beat, can};

/// The second of sixteen priorities; they are in the upper bits.
const BELOW_TICK: u8 = 1 << 4;

static RINGS: Once<Rings> = Once::new(Rings::new());
static INTERRUPT: Owned<BusEnd<'static>> = Owned::empty();
/// Received frames were lost because there was no room.
#[cfg(feature = "defmt")]
static LOST: AtomicBool = AtomicBool::new(false);

/// The registers of the chip.
#[derive(Clone, Copy)]
pub struct Registers;

impl Chip for Registers {
    fn take(&self) -> Option<Heard> {
        can::take()
    }

    fn put(&self, words: &[u32]) -> Option<Places> {
        can::put(words)
    }

    fn pending(&self) -> Places {
        can::pending()
    }

    fn call_back(&self, places: Places) {
        can::call_back(places);
    }

    fn is_off(&self) -> bool {
        can::is_off()
    }

    fn poke(&self) {
        can::poke();
    }

    fn period_us(&self) -> u32 {
        beat::period_us()
    }

    fn since_us(&self) -> u32 {
        beat::since_us()
    }

    fn alone(&self, work: impl FnOnce()) {
        cortex_m::interrupt::free(|_| work());
    }
}

/// Gives the ends of tick and background. From now on the interrupt serves the controller, which runs already, at
/// `kbit` kilobits a second.
///
/// # Panics
/// At the second call.
pub fn start(kbit: u32) -> (TickEnd<'static>, BackgroundEnd<'static>) {
    let (tick, background, bus) = RINGS.take().split(kbit);
    // SAFETY: the interrupt is enabled below.
    unsafe { INTERRUPT.fill(bus) };
    // SAFETY: everything that its handler uses is in place, and nothing else sets priorities.
    unsafe {
        let mut core = cortex_m::Peripherals::steal();
        core.NVIC.set_priority(interrupt::FDCAN1_IT0, BELOW_TICK);
        NVIC::unmask(interrupt::FDCAN1_IT0);
    }
    (tick, background)
}

/// Notes a lost frame, for a log message.
#[cfg_attr(
    not(feature = "defmt"),
    expect(unused_variables, reason = "for messages only")
)]
fn note(lost: bool) {
    #[cfg(feature = "defmt")]
    if lost {
        LOST.store(true, Ordering::Relaxed);
    }
}

/// True where received frames were lost for want of room since the last call.
#[cfg(feature = "defmt")]
pub fn has_lost() -> bool {
    LOST.swap(false, Ordering::Relaxed)
}

#[interrupt]
fn FDCAN1_IT0() {
    let lost = can::acknowledge();
    // SAFETY: this is the value's interrupt.
    unsafe { INTERRUPT.with(|bus| note(lost | !bus.serve(&Registers))) };
}
