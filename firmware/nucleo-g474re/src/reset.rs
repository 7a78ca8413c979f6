//! Why the processor started.

use embassy_stm32::pac::RCC;
use leadscrew_app::ResetFlags;

/// Reads the flags of the last reset, and clears them, so that the next reset can be told from it.
pub fn flags() -> ResetFlags {
    let flags = RCC.csr().read();
    RCC.csr().modify(|w| w.set_rmvf(true));
    ResetFlags {
        brown_out: flags.borrstf(),
        watchdog: flags.iwdgrstf(),
        window_watchdog: flags.wwdgrstf(),
        software: flags.sftrstf(),
        pin: flags.pinrstf(),
    }
}
