//! Why the processor started.

use embassy_stm32::pac::RCC;
use leadscrew_parts::{ResetCause, ResetFlags};

/// The cause of the last reset; the flags are cleared, so that the next one is told from it.
pub fn cause() -> ResetCause {
    let flags = RCC.csr().read();
    RCC.csr().modify(|w| w.set_rmvf(true));
    ResetCause::of(ResetFlags {
        brown_out: flags.borrstf(),
        watchdog: flags.iwdgrstf(),
        window_watchdog: flags.wwdgrstf(),
        software: flags.sftrstf(),
        pin: flags.pinrstf(),
    })
}
