//! Clocks: 170 MHz from the 24 MHz crystal of the board.
//!
//! The crystal, not the oscillator inside the chip: a CAN bit of 1 Mbit/s allows its ends to differ by less than that
//! oscillator may be off. Without the crystal nothing starts.

use embassy_stm32::pac;
use embassy_stm32::rcc::{
    APBPrescaler, Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals};

/// The crystal, and the clock of the CAN controller.
pub const CRYSTAL_HZ: u32 = 24_000_000;
/// The processor and all timers.
pub const CORE_MHZ: u32 = 170;

/// Starts the clocks.
pub fn start() -> Peripherals {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse {
        freq: Hertz(CRYSTAL_HZ),
        mode: HseMode::Oscillator,
    });
    // 24 MHz / 6 · 85 / 2.
    rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV6,
        mul: PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(PllRDiv::DIV2),
    });
    rcc.sys = Sysclk::PLL1_R;
    rcc.boost = true;
    rcc.apb1_pre = APBPrescaler::DIV1;
    rcc.apb2_pre = APBPrescaler::DIV1;
    rcc.hsi48 = None;
    rcc.mux.fdcansel = mux::Fdcansel::HSE;
    let peripherals = embassy_stm32::init(config);
    // Code runs from one bank only, so the prefetcher does not meet its erratum.
    pac::FLASH.acr().modify(|w| w.set_prften(true));
    // A program that a debugger has stopped is not bitten by the watchdog.
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
    peripherals
}
