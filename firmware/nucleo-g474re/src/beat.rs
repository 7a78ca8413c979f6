//! The beat of SYNC: TIM6, in steps of a microsecond.

use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::pac::{TIM6, interrupt};

use crate::clock::CORE_MHZ;

/// Prepares the timer for a period in microseconds, 1 to 65 536, and lets its interrupt through, above everything else.
pub fn start(period_us: u32) {
    TIM6.psc().write_value((CORE_MHZ - 1) as u16);
    set(period_us);
    // Setting it up is no beat.
    TIM6.cr1().write(|w| {
        w.set_urs(Urs::COUNTER_ONLY);
        w.set_arpe(true);
    });
    TIM6.egr().write(|w| w.set_ug(true));
    TIM6.dier().write(|w| w.set_uie(true));
    // SAFETY: what its handler uses is in place. Its priority is the highest, as a reset leaves it.
    unsafe { NVIC::unmask(interrupt::TIM6_DAC) };
    TIM6.cr1().modify(|w| w.set_cen(true));
}

/// Another period, from the next beat on.
pub fn set(period_us: u32) {
    let last = period_us.saturating_sub(1).min(u16::MAX.into());
    TIM6.arr().write(|w| w.set_arr(last as u16));
}

/// The handler has begun.
pub fn begun() {
    TIM6.sr().write(|w| w.set_uif(false));
}

/// The period.
pub fn period_us() -> u32 {
    u32::from(TIM6.arr().read().arr()) + 1
}

/// Microseconds since the last beat.
pub fn since_us() -> u32 {
    TIM6.cnt().read().cnt().into()
}
