//! The serial lines of the board (CMSDK APB UART). Each holds one received byte and one byte to be sent.

use core::ptr::{read_volatile, write_volatile};

/// The interrupt for a byte received on [`Uart::BUS`].
pub const INTERRUPT: u16 = 0;

const DATA: usize = 0x0;
const STATE: usize = 0x4;
const CONTROL: usize = 0x8;
const CLEAR: usize = 0xC;
const DIVIDER: usize = 0x10;

const SEND_FULL: u32 = 1 << 0;
const RECEIVE_FULL: u32 = 1 << 1;
const RECEIVE_INTERRUPT: u32 = 1 << 1;
/// Sending and receiving.
const ON: u32 = 1 << 0 | 1 << 1;
/// The interrupt for a received byte.
const TELLS: u32 = 1 << 3;

/// One of the two lines, at its address.
#[derive(Clone, Copy)]
pub struct Uart(usize);

impl Uart {
    /// UART0: the bus, as lines of SLCAN.
    pub const BUS: Self = Self(0x4000_4000);
    /// UART1: the hand at the machine. Nobody is interrupted by it.
    pub const HAND: Self = Self(0x4000_5000);

    fn read(self, register: usize) -> u32 {
        // SAFETY: a register of one of the two UARTs, mapped at this address on the only board for which this image is
        // made.
        unsafe { read_volatile((self.0 + register) as *const u32) }
    }

    fn write(self, register: usize, value: u32) {
        // SAFETY: as for reading; none of the registers touches memory.
        unsafe { write_volatile((self.0 + register) as *mut u32, value) }
    }

    /// Switches it on. An emulated UART has no bit rate, but the divider must be a valid one.
    pub fn start(self) {
        self.write(DIVIDER, 16);
        self.write(CONTROL, ON);
    }

    /// The same, and each byte that it receives is an interrupt.
    pub fn start_with_interrupt(self) {
        self.write(DIVIDER, 16);
        self.write(CONTROL, ON | TELLS);
    }

    /// The received byte.
    pub fn receive(self) -> Option<u8> {
        self.write(CLEAR, RECEIVE_INTERRUPT);
        (self.read(STATE) & RECEIVE_FULL != 0).then(|| self.read(DATA) as u8)
    }

    /// True where a byte can be sent.
    pub fn has_room(self) -> bool {
        self.read(STATE) & SEND_FULL == 0
    }

    /// Sends a byte. There is room.
    pub fn send(self, byte: u8) {
        self.write(DATA, u32::from(byte));
    }
}
