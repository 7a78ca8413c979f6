//! Clocks: 170 MHz from the 24 MHz crystal of the board, and those of everything that is used of the chip.
//!
//! The crystal, not the oscillator inside the chip: a CAN bit of 1 Mbit/s allows its ends to differ by less than that
//! oscillator may be off. Without the crystal nothing starts.
//!
//! A start is always behind a reset, which leaves all of this off and every part of the chip as it was made.

use stm32_metapac::flash::vals::Latency;
use stm32_metapac::rcc::vals::{Fdcansel, Hpre, Pllm, Plln, Pllr, Pllsrc, Sw};
use stm32_metapac::{DBGMCU, FLASH, PWR, RCC};

/// The crystal, and the clock of the CAN controller.
pub const CRYSTAL_HZ: u32 = 24_000_000;
/// The processor and all timers.
pub const CORE_MHZ: u32 = 170;

/// Starts the clocks.
pub fn start() {
    RCC.cr().modify(|w| w.set_hseon(true));
    while !RCC.cr().read().hserdy() {}
    // 24 MHz / 6 · 85 / 2.
    RCC.pllcfgr().write(|w| {
        w.set_pllsrc(Pllsrc::HSE);
        w.set_pllm(Pllm::DIV6);
        w.set_plln(Plln::MUL85);
        w.set_pllr(Pllr::DIV2);
        w.set_pllren(true);
    });
    RCC.cr().modify(|w| w.set_pllon(true));
    while !RCC.cr().read().pllrdy() {}

    RCC.apb1enr1().modify(|w| {
        w.set_tim2en(true);
        w.set_tim5en(true);
        w.set_tim6en(true);
        w.set_fdcanen(true);
        w.set_pwren(true);
    });
    RCC.ahb2enr().modify(|w| {
        w.set_gpioaen(true);
        w.set_gpioben(true);
        w.set_gpiocen(true);
    });
    RCC.ccipr().modify(|w| w.set_fdcansel(Fdcansel::HSE));

    // Above 150 MHz with more voltage. On the way there half the speed, for a microsecond.
    RCC.cfgr().modify(|w| w.set_hpre(Hpre::DIV2));
    PWR.cr5().modify(|w| w.set_r1mode(false));
    // Code runs from one bank only, so the prefetcher does not meet its erratum.
    FLASH.acr().modify(|w| {
        w.set_latency(Latency::WS4);
        w.set_prften(true);
    });
    while FLASH.acr().read().latency() != Latency::WS4 {}
    RCC.cfgr().modify(|w| w.set_sw(Sw::PLL1_R));
    while RCC.cfgr().read().sws() != Sw::PLL1_R {}
    cortex_m::asm::delay(CORE_MHZ);
    RCC.cfgr().modify(|w| w.set_hpre(Hpre::DIV1));

    // A debug probe reaches the processor also while it waits for an interrupt, and a program that it has stopped is not
    // bitten by the watchdog.
    DBGMCU.cr().modify(|w| {
        w.set_dbg_sleep(true);
        w.set_dbg_stop(true);
        w.set_dbg_standby(true);
    });
    DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
}
