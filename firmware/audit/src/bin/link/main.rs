#![no_std]
#![no_main]
//! The link test. The panic handler calls a function that does not exist: so this image links only if no panic can be
//! reached from the entries, whatever their inputs are.

use core::panic::PanicInfo;

mod entries;

/// The entry of the image, which is never run.
#[unsafe(no_mangle)]
pub extern "C" fn entry() {
    entries::all();
    #[cfg(feature = "self-test")]
    audit::any::sink(reachable_panic());
}

/// Panics for one input in 2³².
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
