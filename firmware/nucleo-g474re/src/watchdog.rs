//! The watchdog of the chip, by a clock of its own: what stops feeding it is started anew.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// It bites behind this time without being fed.
const PATIENCE_MS: u32 = 100;
/// Its clock, within a tenth over voltage and temperature.
const CLOCK_HZ: u32 = 32_000;
/// The clock is divided by so much.
const DIVIDED: u32 = 4;

/// Starts it. Nothing stops it any more.
pub fn start() {
    const LAST: u32 = PATIENCE_MS * (CLOCK_HZ / DIVIDED) / 1000 - 1;
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY4));
    IWDG.rlr().write(|w| w.set_rl(LAST as u16));
}

/// Feeds it.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
