#![deny(unsafe_code)]
//! A CAN bus as a program on Linux sees it: the kernel's interfaces, serial-line adapters, a pair of ends inside one
//! process, all behind [`Can`]; and the log format of `candump`.
//!
//! It moves frames and says what became of them. What a frame means is the business of `leadscrew_core::bus`.
//!
//! Terms. A *packet* is whatever a bus can show: classical frames, remote requests, extended identifiers, FD frames and
//! error frames. CANopen is the data frames with an 11-bit identifier, classical and FD; these alone are sent. *Dropped*
//! frames reached this machine and found the receive buffer full.
//!
//! ```text
//! Address ("can0", "slcan:tcp:HOST:PORT", …) ─ open ─► Can: send many, receive many with time stamps
//!                                                        ├─ SocketCan: one system call for many frames
//!                                                        ├─ Slcan: serial line, TCP, Unix socket
//!                                                        └─ End: one end of a pair in this process
//! ```

mod address;
mod chinese;
mod error;
mod error_frame;
mod health;
mod log;
mod packet;
mod pair;
mod slcan;
mod socket;
#[cfg(test)]
mod tests;

use std::time::Duration;

use leadscrew_core::bus::{self, Frame};
pub use leadscrew_slcan::BitRate;

pub use address::{Address, WrongAddress};
pub use error::CanError;
pub use error_frame::{ErrorFrame, Fault};
pub use health::{Health, Suspicion};
pub use log::{Entry, LogReader, LogWriter, WrongLine};
pub use packet::{Data, FdFrame, Filter, Id, Packet, Received, Stamp};
pub use pair::{End, pair};
pub use slcan::Slcan;
pub use socket::{SocketCan, is_virtual};

/// One end of a bus.
pub trait Can: Send {
    /// What the user called it: the name of the interface or of the adapter.
    fn name(&self) -> &str;

    /// Sends all of them, in order; waits where the way out is full. Frames that this end sends are not received by it.
    ///
    /// # Errors
    /// The bus is gone or down, or nothing went out for too long: see [`CanError::Stuck`].
    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError>;

    /// From now on FD frames are sent and understood, with their data at `data_kbit` kbit/s. An interface of the kernel has
    /// its rates from outside and is only asked whether it carries them; where none are sent, it needs not be asked.
    ///
    /// # Errors
    /// The interface or the adapter knows classical frames only, or not this rate.
    fn use_fd(&mut self, data_kbit: u32) -> Result<(), CanError>;

    /// Sends FD frames as [`send`](Self::send) does classical ones, behind what was sent before; [`use_fd`](Self::use_fd)
    /// has said so.
    ///
    /// # Errors
    /// As there, or the bus carries classical frames only.
    fn send_fd(&mut self, frames: &[bus::FdFrame]) -> Result<(), CanError>;

    /// Appends what has arrived to `into` and says how many these are. Where nothing has arrived yet, waits for the first
    /// until `patience` is over; returns earlier, with nothing, where a signal came to this thread.
    ///
    /// # Errors
    /// The bus is gone or down.
    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError>;

    /// Receives from now on only what at least one of the filters lets through; none lets everything through. Error frames
    /// always come.
    ///
    /// # Errors
    /// The bus does not take them.
    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError>;

    /// Packets for this end that were lost so far because nobody took them out of the buffer in time.
    ///
    /// # Errors
    /// The bus cannot tell.
    fn dropped(&self) -> Result<u64, CanError>;
}

/// Opens a bus other than `sim`. `bit_rate` is for adapters on a line; an interface of the kernel has its own, set from
/// outside.
///
/// # Errors
/// [`CanError`] says what is missing and how to get it.
pub fn open(address: &Address, bit_rate: BitRate) -> Result<Box<dyn Can>, CanError> {
    match address {
        Address::Sim => Err(CanError::NotABus),
        Address::SocketCan(name) => Ok(Box::new(SocketCan::open(name)?)),
        Address::Serial { .. } | Address::Tcp { .. } | Address::Unix(_) => {
            Ok(Box::new(Slcan::open(address, bit_rate)?))
        }
    }
}
