//! The board's watchdog (CMSDK APB watchdog). After a time without being fed it raises an interrupt that cannot be
//! masked. After the same time again it resets the processor.

use core::ptr::write_volatile;

use cortex_m_rt::exception;

const BASE: usize = 0x4000_8000;
const LOAD: usize = 0x0;
const CONTROL: usize = 0x8;
const CLEAR: usize = 0xC;

/// Counting, with its interrupt.
const COUNTS: u32 = 1 << 0;
/// The second time-out in a row resets the processor.
const RESETS: u32 = 1 << 1;

/// The watchdog counts down at this clock.
const PER_SECOND: u32 = 25_000_000;
/// A long time, because the host may be slow.
const SECONDS: u32 = 5;

fn write(register: usize, value: u32) {
    // SAFETY: a register of the watchdog, mapped at this address on the only board for which this image is made; none
    // of them touches memory.
    unsafe { write_volatile((BASE + register) as *mut u32, value) }
}

/// Starts the watchdog: it has to be fed afterwards.
pub fn start() {
    write(LOAD, SECONDS * PER_SECOND);
    write(CONTROL, COUNTS | RESETS);
}

/// Feeds the watchdog.
pub fn feed() {
    write(CLEAR, 1);
}

/// The watchdog was not fed: the program that hangs stops here, moves nothing, and waits for the reset.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
