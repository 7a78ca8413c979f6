//! Why the program started, and what had stopped it: a failure with its own record, the watchdog, or the power.

use leadscrew_app::{Failure, ResetCause, ResetFlags};

/// Gives the cause of this start, and the failure before it, if there was one. Sets the guard below the stack.
pub fn start(flags: ResetFlags) -> (ResetCause, Option<Failure>) {
    if let Some(mut core) = cortex_m::Peripherals::take() {
        leadscrew_fault::guard_stack(&mut core.MPU);
    }
    let left = leadscrew_fault::left();
    let cause = ResetCause::of(flags, left.is_kept());
    let failure = left.failure(cause);
    leadscrew_fault::begin(failure.as_ref());
    (cause, failure)
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    leadscrew_fault::panicked()
}
