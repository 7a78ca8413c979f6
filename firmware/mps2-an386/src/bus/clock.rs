//! The board's timers: one that runs freely, for real time, and one that wakes the thread every millisecond.

use core::ptr::{read_volatile, write_volatile};

/// The interrupt of the timer that wakes the thread.
pub const INTERRUPT: u16 = 9;

/// Both timers count down at this clock.
const PER_MS: u32 = 25_000;
const PER_US: u32 = PER_MS / 1000;

const TIMER_0: usize = 0x4000_0000;
const TIMER_1: usize = 0x4000_1000;
const CONTROL: usize = 0x0;
const VALUE: usize = 0x4;
const RELOAD: usize = 0x8;
const CLEAR: usize = 0xC;

const ENABLE: u32 = 1 << 0;
const INTERRUPT_ENABLE: u32 = 1 << 3;

fn write(timer: usize, register: usize, value: u32) {
    // SAFETY: a register of one of the two timers, mapped at this address on the only board for which this image is
    // made; none of them touches memory.
    unsafe { write_volatile((timer + register) as *mut u32, value) }
}

/// Starts both timers.
pub fn start() {
    write(TIMER_0, RELOAD, u32::MAX);
    write(TIMER_0, VALUE, u32::MAX);
    write(TIMER_0, CONTROL, ENABLE);
    write(TIMER_1, RELOAD, PER_MS - 1);
    write(TIMER_1, VALUE, PER_MS - 1);
    write(TIMER_1, CONTROL, ENABLE | INTERRUPT_ENABLE);
}

/// Acknowledges the interrupt of the timer that wakes the thread.
pub fn woken() {
    write(TIMER_1, CLEAR, 1);
}

/// Real time in microseconds since the start of this clock. It has to be read at least once a minute.
#[derive(Debug)]
pub struct Clock {
    last: u32,
    /// Counts that do not make a whole microsecond yet.
    rest: u32,
    us: u64,
}

impl Clock {
    pub fn new() -> Self {
        Self {
            last: count(),
            rest: 0,
            us: 0,
        }
    }

    /// Microseconds since the start.
    pub fn us(&mut self) -> u64 {
        let now = count();
        // The timer counts down.
        let passed = u64::from(self.last.wrapping_sub(now)) + u64::from(self.rest);
        self.last = now;
        self.rest = (passed % u64::from(PER_US)) as u32;
        self.us += passed / u64::from(PER_US);
        self.us
    }
}

fn count() -> u32 {
    // SAFETY: as for writing.
    unsafe { read_volatile((TIMER_0 + VALUE) as *const u32) }
}
