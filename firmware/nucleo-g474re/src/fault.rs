//! What has stopped the program the last time: its own record, or the watchdog's.

use leadscrew_app::Failure;
use leadscrew_parts::ResetCause;

/// The failure before this start, if it was one; and a guard below the stack from now on.
pub fn start(cause: ResetCause) -> Option<Failure> {
    if let Some(mut core) = cortex_m::Peripherals::take() {
        leadscrew_fault::guard_stack(&mut core.MPU);
    }
    // Without power the memory has lost its meaning, whatever it looks like.
    let record = leadscrew_fault::take().filter(|_| cause != ResetCause::Power);
    record.or_else(|| (cause == ResetCause::Watchdog).then(Failure::hung))
}

#[cfg(not(feature = "defmt"))]
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    leadscrew_fault::panicked(info)
}
