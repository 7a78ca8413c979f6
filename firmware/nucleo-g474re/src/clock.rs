//! Clocks: 170 MHz from the 24 MHz crystal of the board.
//!
//! The crystal, not the oscillator inside the chip: a CAN bit of 1 Mbit/s allows its ends to differ by less than that
//! oscillator may be off. Without the crystal nothing starts. Where it stops, the chip
//! goes on by the other one and raises the non-maskable interrupt, which ends the
//! program ([`flash`](crate::flash)): time is not what it was, and the bus is dead.
//!
//! The tree of clocks is set up by `embassy-stm32`, whatever ran before and left on: a mistake in it would show on a desk
//! alone. It ends at half the speed; the manual wants a microsecond of that before the whole. Timers and CAN controller are
//! given their clocks here, the ports have theirs from the crate; each has its registers in a file of its own.

use embassy_stm32::Config;
use embassy_stm32::pac;
use embassy_stm32::pac::flash::vals::Latency;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, LsConfig, Pll, PllMul, PllPreDiv, PllRDiv, PllSource,
    Sysclk, mux,
};
use embassy_stm32::time::Hertz;

/// The crystal, and the clock of the CAN controller.
pub const CRYSTAL_HZ: u32 = 24_000_000;
/// The processor and all timers.
pub const CORE_MHZ: u32 = 170;

/// Starts the clocks.
pub fn start() {
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
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV1;
    rcc.apb2_pre = APBPrescaler::DIV1;
    rcc.hsi48 = None;
    rcc.ls = LsConfig::off();
    rcc.mux.fdcansel = mux::Fdcansel::HSE;
    // Its tokens of ownership stay behind: `main` starts each part once.
    let _ = embassy_stm32::init(config);
    // Code runs from one bank only, so the prefetcher does not meet its erratum.
    pac::FLASH.acr().modify(|w| {
        w.set_latency(Latency::WS4);
        w.set_prften(true);
    });
    while pac::FLASH.acr().read().latency() != Latency::WS4 {}
    cortex_m::asm::delay(CORE_MHZ);
    pac::RCC.cfgr().modify(|w| w.set_hpre(AHBPrescaler::DIV1));
    pac::RCC.cr().modify(|w| w.set_csson(true));
    pac::RCC.apb1enr1().modify(|w| {
        w.set_tim2en(true);
        w.set_tim3en(true);
        w.set_tim5en(true);
        w.set_tim6en(true);
        w.set_fdcanen(true);
    });
    // A program that a debugger has stopped is not bitten by the watchdog.
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
}
