#![no_std]
#![no_main]
//! Counts instructions on the emulated Cortex-M4F and prints a row `name mean worst` for each kind of step, and bytes for
//! each part of a board and for its stack.

use core::fmt::{Arguments, Write};
use core::panic::PanicInfo;

use audit::work::{self, Counter};
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio;
// As the board's image has it.
use leadscrew_memory as _;

mod count;
mod memory;

#[entry]
fn main() -> ! {
    count::start();
    count::Printer.once("known-loop-2000", || count::spin(1000));
    work::all(&mut count::Printer);
    memory::parts();
    let mut depths = memory::Depths::new();
    work::all(&mut depths);
    depths.print();
    debug::exit(EXIT_SUCCESS);
    stop()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    print(format_args!("{info}\n"));
    debug::exit(EXIT_FAILURE);
    stop()
}

/// Prints on the emulator's standard output.
fn print(text: Arguments) {
    // Where the host takes no output there is nobody to tell.
    if let Ok(mut out) = hio::hstdout() {
        let _ = out.write_fmt(text);
    }
}

fn stop() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
