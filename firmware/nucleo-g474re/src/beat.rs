//! The period of SYNC: TIM6, in steps of a microsecond.

use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::pac::{TIM6, interrupt};

use crate::clock::CORE_MHZ;

/// Sets the timer up for a period in microseconds, 1 to 65 536, and enables its interrupt with the highest priority.
pub fn start(period_us: u32) {
    TIM6.psc().write_value((CORE_MHZ - 1) as u16);
    set(period_us);
    // The update event of the set-up must not raise the interrupt.
    TIM6.cr1().write(|w| {
        w.set_urs(Urs::COUNTER_ONLY);
        w.set_arpe(true);
    });
    TIM6.egr().write(|w| w.set_ug(true));
    TIM6.dier().write(|w| w.set_uie(true));
    // SAFETY: everything that its handler uses is in place. A reset leaves its priority at the highest.
    unsafe { NVIC::unmask(interrupt::TIM6_DAC) };
    TIM6.cr1().modify(|w| w.set_cen(true));
}

/// Sets another period, from the next period on.
pub fn set(period_us: u32) {
    let last = period_us.saturating_sub(1).min(u16::MAX.into());
    TIM6.arr().write(|w| w.set_arr(last as u16));
}

/// Clears the flag of the interrupt: the handler has begun.
pub fn begun() {
    TIM6.sr().write(|w| w.set_uif(false));
}

/// The length of the period.
pub fn period_us() -> u32 {
    u32::from(TIM6.arr().read().arr()) + 1
}

/// Microseconds since the period began.
pub fn since_us() -> u32 {
    TIM6.cnt().read().cnt().into()
}
