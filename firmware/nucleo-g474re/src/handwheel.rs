//! The handwheel: TIM1 counts the edges of its two lines, sixteen bits.

use embassy_stm32::pac::TIM1;
use embassy_stm32::pac::timer::vals::{CcmrInputCcs, FilterValue, Sms};
use leadscrew_parts::Detents;

/// 256 clocks, 1.5 µs: a hand makes no edge so short.
const FILTER: FilterValue = FilterValue::FDTS_DIV32_N8;

/// The handwheel, read by the background.
pub struct Handwheel(Detents);

impl Handwheel {
    /// Starts the timer.
    pub fn start() -> Self {
        TIM1.arr().write(|w| w.set_arr(u16::MAX));
        TIM1.smcr().write(|w| w.set_sms(Sms::ENCODER_MODE_3));
        TIM1.ccmr_input(0).write(|w| {
            w.set_ccs(0, CcmrInputCcs::TI4);
            w.set_icf(0, FILTER);
            w.set_ccs(1, CcmrInputCcs::TI4);
            w.set_icf(1, FILTER);
        });
        TIM1.cr1().modify(|w| w.set_cen(true));
        Self(Detents::default())
    }

    /// The detent it is in; it wraps.
    pub fn detent(&mut self) -> u16 {
        self.0.of(TIM1.cnt().read().cnt())
    }
}
