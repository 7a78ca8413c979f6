//! The watchdog of the chip, on a clock of its own: it resets a program that stops feeding it.

use embassy_stm32::Peri;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;

/// The watchdog resets the chip after this time without being fed, within a tenth over voltage and temperature.
const PATIENCE_US: u32 = 100_000;

/// The watchdog.
pub type Watchdog = IndependentWatchdog<'static, IWDG>;

/// Starts the watchdog. Nothing can stop it afterwards.
pub fn start(part: Peri<'static, IWDG>) -> Watchdog {
    let mut watchdog = IndependentWatchdog::new(part, PATIENCE_US);
    watchdog.unleash();
    watchdog
}
