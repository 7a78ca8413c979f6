//! The spindle encoder: TIM2 counts, TIM5 keeps the time.
//!
//! | | |
//! |---|---|
//! | TIM2 channels 1, 2 | lines A and B, every edge counted, 32 bits |
//! | TIM2 channel 3 | the index: the hardware keeps the count at its rising edge |
//! | TIM2 → TIM5 | a pulse at every count; TIM5 runs freely at the processor's clock and keeps its value at the pulse |
//!
//! So the time of the last edge needs no wire and no interrupt. The index has a longer filter than the lines. It comes
//! together with an edge; the count after this edge belongs to it, in either direction.

use embassy_stm32::pac::timer::vals::{CcmrInputCcs, FilterValue, Mms, Sms, Ts};
use embassy_stm32::pac::{TIM2, TIM5};
use leadscrew_core::spindle::EncoderSample;
use leadscrew_parts::{EdgeClock, Reading};

use crate::clock::CORE_MHZ;

/// 16 clocks, 94 ns: shorter pulses of A and B count as noise.
const LINES: FilterValue = FilterValue::FDTS_DIV2_N8;
/// 128 clocks, 753 ns: later than any edge that comes with the index, and earlier than the next edge, up to a million
/// counts a second.
const INDEX: FilterValue = FilterValue::FDTS_DIV16_N8;

/// Clocks from a count until TIM5 has captured the time, and a margin.
const CAPTURE_CLOCKS: u32 = 8;

/// The encoder, read by the tick.
pub struct Encoder {
    edges: EdgeClock,
}

impl Encoder {
    /// Starts both timers.
    pub fn start() -> Self {
        TIM2.arr().write_value(u32::MAX);
        TIM2.smcr().write(|w| w.set_sms(Sms::ENCODER_MODE_3));
        TIM2.ccmr_input(0).write(|w| {
            w.set_ccs(0, CcmrInputCcs::TI4);
            w.set_icf(0, LINES);
            w.set_ccs(1, CcmrInputCcs::TI4);
            w.set_icf(1, LINES);
        });
        TIM2.ccmr_input(1).write(|w| {
            w.set_ccs(0, CcmrInputCcs::TI4);
            w.set_icf(0, INDEX);
        });
        TIM2.ccer().write(|w| w.set_cce(2, true));
        TIM2.cr2().write(|w| w.set_mms(Mms::ENCODER_CLOCK_OUTPUT));

        TIM5.arr().write_value(u32::MAX);
        // TIM2 is the second internal trigger of TIM5.
        TIM5.smcr().write(|w| w.set_ts(Ts::ITR1));
        TIM5.ccmr_input(0)
            .write(|w| w.set_ccs(0, CcmrInputCcs::TRC));
        TIM5.ccer().write(|w| w.set_cce(0, true));

        TIM5.cr1().modify(|w| w.set_cen(true));
        TIM2.cr1().modify(|w| w.set_cen(true));
        Self {
            edges: EdgeClock::new(CORE_MHZ, TIM5.cnt().read()),
        }
    }

    /// Takes a sample now. Where an edge comes in between, it reads a second time; another edge cannot come so soon.
    pub fn sample(&mut self) -> EncoderSample {
        let mut reading = read();
        if TIM2.cnt().read() != reading.count {
            let again = read();
            reading = Reading {
                edge: again.edge.or(reading.edge),
                index: again.index.or(reading.index),
                ..again
            };
        }
        self.edges.sample(&reading)
    }
}

fn read() -> Reading {
    let count = TIM2.cnt().read();
    cortex_m::asm::delay(CAPTURE_CLOCKS);
    // Reading the captured value clears its flag.
    let edge = TIM5.sr().read().ccif(0).then(|| TIM5.ccr(0).read());
    let index = TIM2.sr().read().ccif(2).then(|| TIM2.ccr(2).read());
    Reading {
        count,
        now: TIM5.cnt().read(),
        edge,
        index,
    }
}
