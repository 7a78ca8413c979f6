#![no_std]
#![no_main]
//! Counts instructions on the emulated Cortex-M4F and prints a row `name mean worst` for each kind of step, and bytes for
//! each part of a board and for its stack.

use core::panic::PanicInfo;

use audit::work::{self, Counter};
use cortex_m_rt::entry;
// As in the board's image.
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
    leadscrew_console::done()
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    leadscrew_console::panicked(info)
}
