#![no_std]
#![no_main]
//! The link test. The panic handler calls a function that exists nowhere: this image links only if no panic can be
//! reached from the entries below, whatever their inputs are.

use core::panic::PanicInfo;

mod entries;

/// Where the image begins.
///
/// It is never run.
#[unsafe(no_mangle)]
pub extern "C" fn entry() {
    entries::all();
    #[cfg(feature = "self-test")]
    audit::any::sink(reachable_panic());
}

/// Fails for one input in 2³².
#[cfg(feature = "self-test")]
#[inline(never)]
fn reachable_panic() -> u32 {
    1_u32 / audit::any::any::<u32>()
}

#[cfg(not(feature = "diagnose"))]
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    unsafe extern "C" {
        fn a_panic_is_reachable() -> !;
    }
    // SAFETY: never called; an image that could call it does not link.
    unsafe { a_panic_is_reachable() }
}

#[cfg(feature = "diagnose")]
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
