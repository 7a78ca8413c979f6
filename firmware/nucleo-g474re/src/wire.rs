//! The wire of this chip: FDCAN1 and TIM6 for [`leadscrew_parts::Rings`], which has the rules, and the interrupt that runs
//! right below the tick.

#[cfg(feature = "defmt")]
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::interrupt;
use leadscrew_core::bus::Frame;
use leadscrew_parts::{BackgroundEnd, BusEnd, Chip, Places, Rings, TickEnd};

use crate::owned::{Once, Owned};
use crate::{beat, can};

/// The second of sixteen priorities, which are the upper bits.
const BELOW_TICK: u8 = 1 << 4;

static RINGS: Once<Rings> = Once::new(Rings::new());
static INTERRUPT: Owned<BusEnd<'static>> = Owned::empty();
/// Frames have come for which there was no room.
#[cfg(feature = "defmt")]
static LOST: AtomicBool = AtomicBool::new(false);

/// The registers.
#[derive(Clone, Copy)]
pub struct Registers;

impl Chip for Registers {
    fn take(&self) -> Option<Frame> {
        can::take()
    }

    fn put(&self, words: &[u32; 4]) -> Option<Places> {
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

/// The ends of tick and background; the controller, which runs already, is served from now on at so many kilobits a second.
///
/// # Panics
/// The second time.
pub fn start(kbit: u32) -> (TickEnd<'static>, BackgroundEnd<'static>) {
    let (tick, background, bus) = RINGS.take().split(kbit);
    // SAFETY: the interrupt is enabled below.
    unsafe { INTERRUPT.fill(bus) };
    // SAFETY: what its handler uses is in place, and nobody else sets priorities.
    unsafe {
        let mut core = cortex_m::Peripherals::steal();
        core.NVIC.set_priority(interrupt::FDCAN1_IT0, BELOW_TICK);
        NVIC::unmask(interrupt::FDCAN1_IT0);
    }
    (tick, background)
}

/// A frame that is lost is told on a desk.
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

/// True where frames have come for which there was no room, since this was asked last.
#[cfg(feature = "defmt")]
pub fn has_lost() -> bool {
    LOST.swap(false, Ordering::Relaxed)
}

#[interrupt]
fn FDCAN1_IT0() {
    let lost = can::acknowledge();
    // SAFETY: this is its interrupt.
    unsafe { INTERRUPT.with(|bus| note(lost | !bus.serve(&Registers))) };
}
