#![no_std]
//! The standard output of an emulated image, and its end: both are the emulator's, through semihosting.

use core::fmt::{Arguments, Write};
use core::panic::PanicInfo;

use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio;

/// Prints.
pub fn print(text: Arguments) {
    // Where the host takes no output there is nobody to tell.
    if let Ok(mut out) = hio::hstdout() {
        let _ = out.write_fmt(text);
    }
}

/// The emulator ends, well.
pub fn done() -> ! {
    debug::exit(EXIT_SUCCESS);
    stop()
}

/// For the image's handler of panics: the emulator ends, with an exit code that says so.
pub fn panicked(info: &PanicInfo) -> ! {
    print(format_args!("{info}\n"));
    debug::exit(EXIT_FAILURE);
    stop()
}

/// Nobody has ended the emulator: there is none.
fn stop() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
