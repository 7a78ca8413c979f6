//! Clocks: 170 MHz from the 24 MHz crystal of the board.
//!
//! The crystal, not the oscillator inside the chip: a CAN bit of 1 Mbit/s allows its ends to differ by less than that
//! oscillator may be off. Without the crystal nothing starts: the light flashes, by the
//! oscillator inside the chip, and that is all. Where it stops, the chip
//! goes on by the other one and raises the non-maskable interrupt, which ends the
//! program ([`flash`](crate::flash)): time is not what it was, and the bus is dead.
//!
//! `embassy-stm32` starts crystal and PLL, whatever ran before and left on, and stays on the crystal. The last step is
//! taken here, register by register: above 150 MHz the core needs the voltage of its boost mode, and the crate clears
//! another bit for that than the chip has, and resets what was set before ([`R1MODE`]). Timers and CAN controller are
//! given their clocks here, the ports have theirs from the crate; each has its registers in a file of its own.

use embassy_stm32::Config;
use embassy_stm32::pac;
use embassy_stm32::pac::flash::vals::Latency;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, LsConfig, Pll, PllMul, PllPreDiv, PllRDiv, PllSource,
    Sysclk, mux,
};
use embassy_stm32::time::Hertz;

use crate::pins;

/// The crystal, and the clock of the CAN controller.
pub const CRYSTAL_HZ: u32 = 24_000_000;
/// The processor and all timers.
pub const CORE_MHZ: u32 = 170;
/// The oscillator inside the chip, which the processor has after a reset.
const INSIDE_MHZ: u32 = 16;

/// The crystal takes a few milliseconds to start; so many, at least, are waited for.
const PATIENCE_MS: u32 = 200;
/// The light without a crystal: on and off for so long each.
const FLASH_MS: u32 = 100;

/// PWR_CR5: 0 is the boost mode of voltage range 1, 1 (after a reset) its normal mode, for up to 150 MHz. Bit 8 by RM0440;
/// `stm32-metapac` 21 has bit 0 there (`manual.rs` says when that has changed).
const R1MODE: u32 = 1 << 8;

/// Starts the clocks. Without a crystal it does not come back.
pub fn start() {
    if !has_crystal() {
        show_no_crystal();
    }
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
    rcc.sys = Sysclk::HSE;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = APBPrescaler::DIV1;
    rcc.apb2_pre = APBPrescaler::DIV1;
    rcc.hsi48 = None;
    rcc.ls = LsConfig::off();
    rcc.mux.fdcansel = mux::Fdcansel::HSE;
    // Its tokens of ownership stay behind: `main` starts each part once.
    let _ = embassy_stm32::init(config);
    speed_up();
    pac::RCC.cr().modify(|w| w.set_csson(true));
    pac::RCC.apb1enr1().modify(|w| {
        w.set_tim2en(true);
        w.set_tim5en(true);
        w.set_tim6en(true);
        w.set_fdcanen(true);
    });
    // A program that a debugger has stopped is not bitten by the watchdog.
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
}

/// From the crystal to the PLL, in the order that RM0440 gives for the boost mode (6.1.5): half the clock, the voltage, the
/// wait states, the PLL, a microsecond, the whole clock.
fn speed_up() {
    pac::RCC.cfgr().modify(|w| w.set_hpre(AHBPrescaler::DIV2));
    pac::PWR.cr5().modify(|w| w.0 &= !R1MODE);
    // Code runs from one bank only, so the prefetcher does not meet its erratum.
    pac::FLASH.acr().modify(|w| {
        w.set_latency(Latency::WS4);
        w.set_prften(true);
    });
    while pac::FLASH.acr().read().latency() != Latency::WS4 {}
    pac::RCC.cfgr().modify(|w| w.set_sw(Sysclk::PLL1_R));
    while pac::RCC.cfgr().read().sws() != Sysclk::PLL1_R {}
    cortex_m::asm::delay(CORE_MHZ);
    pac::RCC.cfgr().modify(|w| w.set_hpre(AHBPrescaler::DIV1));
}

/// Starts the crystal; false where it does not come.
fn has_crystal() -> bool {
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    // Ten looks a millisecond.
    for _ in 0..10 * PATIENCE_MS {
        if pac::RCC.cr().read().hserdy() {
            return true;
        }
        cortex_m::asm::delay(INSIDE_MHZ * 100);
    }
    false
}

/// Shows that there is no crystal, until the power goes or the reset button is pressed. Interrupts are off, the watchdog
/// has not been started, and what the board switches is off.
fn show_no_crystal() -> ! {
    pac::RCC.cr().modify(|w| {
        w.set_hseon(false);
        w.set_hsion(true);
    });
    while !pac::RCC.cr().read().hsirdy() {}
    pac::RCC.cfgr().modify(|w| w.set_sw(Sysclk::HSI));
    pac::RCC.ahb2enr().modify(|w| {
        w.set_gpioaen(true);
        w.set_gpioben(true);
        w.set_gpiocen(true);
    });
    // A port takes two clocks to have its own.
    let _ = pac::RCC.ahb2enr().read();
    pins::start_outputs();
    loop {
        pins::light(true);
        cortex_m::asm::delay(INSIDE_MHZ * 1000 * FLASH_MS);
        pins::light(false);
        cortex_m::asm::delay(INSIDE_MHZ * 1000 * FLASH_MS);
    }
}
