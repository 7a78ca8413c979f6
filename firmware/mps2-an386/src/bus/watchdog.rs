//! The board's watchdog (CMSDK APB watchdog): after a while without food it asks by an interrupt that nothing can mask, and
//! after as long again it starts the processor anew.

use core::ptr::write_volatile;

use cortex_m_rt::exception;

const BASE: usize = 0x4000_8000;
const LOAD: usize = 0x0;
const CONTROL: usize = 0x8;
const CLEAR: usize = 0xC;

/// Counting, with its interrupt.
const COUNTS: u32 = 1 << 0;
/// The second time in a row is a reset.
const RESETS: u32 = 1 << 1;

/// It counts down at this clock.
const PER_SECOND: u32 = 25_000_000;
/// The host may be slow.
const SECONDS: u32 = 5;

fn write(register: usize, value: u32) {
    // SAFETY: a register of the watchdog, mapped at this address on the only board this image is for; none of them touches
    // memory.
    unsafe { write_volatile((BASE + register) as *mut u32, value) }
}

/// From here on it has to be fed.
pub fn start() {
    write(LOAD, SECONDS * PER_SECOND);
    write(CONTROL, COUNTS | RESETS);
}

/// Feeds it.
pub fn feed() {
    write(CLEAR, 1);
}

/// It is not fed any more: whatever hangs does not move anything, and waits for the reset.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
