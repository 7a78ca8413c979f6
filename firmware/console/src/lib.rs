#![no_std]
//! The standard output of an emulated image, its command line and its exit. The emulator provides all three by semihosting.

use core::fmt::{Arguments, Write};
use core::panic::PanicInfo;

use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::{hio, syscall1};

/// The longest command line.
pub const LONGEST: usize = 256;

#[repr(C)]
struct Line {
    text: *mut u8,
    length: usize,
}

/// The words of the command line after the image's own name.
///
/// # Panics
/// Where the command line is not text.
pub fn words(buffer: &mut [u8; LONGEST]) -> impl Iterator<Item = &str> {
    let mut line = Line {
        text: buffer.as_mut_ptr(),
        length: buffer.len(),
    };
    // SAFETY: the host writes at most `length` bytes to `text`; it reads both from `line`.
    let failed = unsafe { syscall1!(GET_CMDLINE, &raw mut line) };
    let bytes = match failed {
        0 => buffer.split(|byte| *byte == 0).next().unwrap_or_default(),
        _ => &[],
    };
    let text = core::str::from_utf8(bytes).expect("a command line is text");
    text.split_ascii_whitespace().skip(1)
}

/// Prints.
pub fn print(text: Arguments) {
    // A host that takes no output cannot be told so.
    if let Ok(mut out) = hio::hstdout() {
        let _ = out.write_fmt(text);
    }
}

/// Ends the emulator with success.
pub fn done() -> ! {
    debug::exit(EXIT_SUCCESS);
    stop()
}

/// For the image's handler of panics: prints the panic, and ends the emulator with an exit code for failure.
pub fn panicked(info: &PanicInfo) -> ! {
    print(format_args!("{info}\n"));
    debug::exit(EXIT_FAILURE);
    stop()
}

/// Waits for ever: no emulator has ended the run.
fn stop() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
