//! The watchdog of the chip, on a clock of its own: it resets a program that stops feeding it.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// The watchdog resets the chip after this time without being fed.
const PATIENCE_MS: u32 = 100;
/// The watchdog's clock, within a tenth over voltage and temperature.
const CLOCK_HZ: u32 = 32_000;
/// The divisor of the clock.
const DIVIDED: u32 = 4;

/// Starts the watchdog. Nothing can stop it afterwards.
pub fn start() {
    const LAST: u32 = PATIENCE_MS * (CLOCK_HZ / DIVIDED) / 1000 - 1;
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY4));
    IWDG.rlr().write(|w| w.set_rl(LAST as u16));
}

/// Feeds the watchdog.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
