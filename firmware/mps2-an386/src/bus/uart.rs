//! UART0 of the board (CMSDK APB UART). It holds one received byte and one byte to be sent.

use core::ptr::{read_volatile, write_volatile};

/// The interrupt for a received byte.
pub const INTERRUPT: u16 = 0;

const BASE: usize = 0x4000_4000;
const DATA: *mut u32 = BASE as *mut u32;
const STATE: *mut u32 = (BASE + 0x4) as *mut u32;
const CONTROL: *mut u32 = (BASE + 0x8) as *mut u32;
const CLEAR: *mut u32 = (BASE + 0xC) as *mut u32;
const DIVIDER: *mut u32 = (BASE + 0x10) as *mut u32;

const SEND_FULL: u32 = 1 << 0;
const RECEIVE_FULL: u32 = 1 << 1;
const RECEIVE_INTERRUPT: u32 = 1 << 1;
/// Sending, receiving, and the interrupt for a received byte.
const ON: u32 = 1 << 0 | 1 << 1 | 1 << 3;

fn read(register: *mut u32) -> u32 {
    // SAFETY: a register of this UART, mapped at this address on the only board for which this image is made.
    unsafe { read_volatile(register) }
}

fn write(register: *mut u32, value: u32) {
    // SAFETY: as for reading; none of the registers touches memory.
    unsafe { write_volatile(register, value) }
}

/// Switches the UART on. The emulated UART has no bit rate, but the divider must be a valid one.
pub fn start() {
    write(DIVIDER, 16);
    write(CONTROL, ON);
}

/// The received byte; called in the interrupt.
pub fn receive() -> Option<u8> {
    write(CLEAR, RECEIVE_INTERRUPT);
    (read(STATE) & RECEIVE_FULL != 0).then(|| read(DATA) as u8)
}

/// True where a byte can be sent.
pub fn has_room() -> bool {
    read(STATE) & SEND_FULL == 0
}

/// Sends a byte. There is room.
pub fn send(byte: u8) {
    write(DATA, u32::from(byte));
}
