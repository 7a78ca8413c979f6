//! A panic, or a fault of the processor: nothing that is known still holds.
//!
//! All interrupts stop, and with them SYNC and setpoints: the drives stop by their own supervision. Then the processor starts
//! anew.

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};

#[cfg(not(feature = "defmt"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    cortex_m::interrupt::disable();
    SCB::sys_reset()
}
