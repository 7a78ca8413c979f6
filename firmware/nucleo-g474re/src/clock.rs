//! Clocks: 170 MHz from the 24 MHz crystal of the board.
//!
//! The oscillator inside the chip is not accurate enough: its error may be larger than a CAN bit of 1 Mbit/s permits.
//! Without the crystal nothing starts; the light flashes by the inner oscillator. Where the crystal stops later, the
//! chip goes on by the inner oscillator and raises the non-maskable interrupt. This ends the program
//! ([`flash`](crate::flash)), because the time base is wrong and the bus is dead.
//!
//! `embassy-stm32` starts crystal and PLL, whatever clocks ran before, and stays on the crystal. This module takes the
//! last step, register by register: above 150 MHz the core needs the voltage of its boost mode. The crate clears the
//! wrong bit for that, and resets what was set before ([`R1MODE`]). This module also enables the clocks of timers and
//! CAN controller; the crate enables those of the ports. Each part has its registers in a file of its own.

use embassy_stm32::pac;
use embassy_stm32::pac::flash::vals::Latency;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, LsConfig, Pll, PllMul, PllPreDiv, PllQDiv, PllRDiv,
    PllSource, Sysclk, mux,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals};

use crate::pins;

/// The crystal.
pub const CRYSTAL_HZ: u32 = 24_000_000;
/// The clocks that the CAN controller can have: the crystal, and the PLL's output Q, which makes 5 Mbit/s.
pub const CAN_HZ: [u32; 2] = [CRYSTAL_HZ, 85_000_000];
/// The processor and all timers.
pub const CORE_MHZ: u32 = 170;
/// The oscillator inside the chip. The processor runs by it after a reset.
const INSIDE_MHZ: u32 = 16;

/// The longest wait for the crystal, which takes a few milliseconds to start.
const PATIENCE_MS: u32 = 200;
/// Without a crystal: the time for which the light is on, and then off.
const FLASH_MS: u32 = 100;

/// PWR_CR5: 0 is the boost mode of voltage range 1; 1 (after a reset) is its normal mode, for up to 150 MHz. RM0440 has
/// it in bit 8, `stm32-metapac` 21 in bit 0 (`manual.rs` fails to compile once the crate is right).
const R1MODE: u32 = 1 << 8;

/// Starts the clocks, and gives the chip's parts for the drivers of the crate. Without a crystal it does not return.
pub fn start() -> Peripherals {
    if !has_crystal() {
        show_no_crystal();
    }
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse {
        freq: Hertz(CRYSTAL_HZ),
        mode: HseMode::Oscillator,
    });
    // 24 MHz / 6 · 85 / 2; Q: / 4.
    rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV6,
        mul: PllMul::MUL85,
        divp: None,
        divq: Some(PllQDiv::DIV4),
        divr: Some(PllRDiv::DIV2),
    });
    rcc.sys = Sysclk::HSE;
    rcc.ahb_pre = AHBPrescaler::DIV1;
    rcc.apb1_pre = APBPrescaler::DIV1;
    rcc.apb2_pre = APBPrescaler::DIV1;
    rcc.hsi48 = None;
    rcc.ls = LsConfig::off();
    let parts = embassy_stm32::init(config);
    speed_up();
    pac::RCC.cr().modify(|w| w.set_csson(true));
    pac::RCC.apb1enr1().modify(|w| {
        w.set_tim2en(true);
        w.set_tim5en(true);
        w.set_tim6en(true);
    });
    pac::RCC.apb2enr().modify(|w| w.set_tim1en(true));
    // The watchdog stops while a debugger has stopped the program.
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
    parts
}

/// Gives the CAN controller one of [`CAN_HZ`]. Meanwhile it has none.
pub fn start_can(which: usize) {
    let source = match which {
        0 => mux::Fdcansel::HSE,
        _ => mux::Fdcansel::PLL1_Q,
    };
    pac::RCC.apb1enr1().modify(|w| w.set_fdcanen(false));
    pac::RCC.ccipr().modify(|w| w.set_fdcansel(source));
    pac::RCC.apb1enr1().modify(|w| w.set_fdcanen(true));
    // A part gets its clock after two cycles.
    let _ = pac::RCC.apb1enr1().read();
}

/// Goes from the crystal to the PLL, in RM0440's order for the boost mode (6.1.5): half the clock, the voltage, the
/// wait states, the PLL, a microsecond, the whole clock.
fn speed_up() {
    pac::RCC.cfgr().modify(|w| w.set_hpre(AHBPrescaler::DIV2));
    pac::PWR.cr5().modify(|w| w.0 &= !R1MODE);
    // Code runs from one bank only, so the erratum of the prefetcher does not apply.
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

/// Starts the crystal; false where it does not start.
fn has_crystal() -> bool {
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    // Ten checks a millisecond.
    for _ in 0..10 * PATIENCE_MS {
        if pac::RCC.cr().read().hserdy() {
            return true;
        }
        cortex_m::asm::delay(INSIDE_MHZ * 100);
    }
    false
}

/// Shows that there is no crystal, until the power goes or the reset button is pressed. Interrupts are off, the
/// watchdog does not run yet, and all outputs are off.
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
    // A port gets its clock after two cycles.
    let _ = pac::RCC.ahb2enr().read();
    pins::start_outputs();
    loop {
        pins::light(true);
        cortex_m::asm::delay(INSIDE_MHZ * 1000 * FLASH_MS);
        pins::light(false);
        cortex_m::asm::delay(INSIDE_MHZ * 1000 * FLASH_MS);
    }
}
