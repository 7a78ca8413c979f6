#![deny(unsafe_code)]
//! CAN buses for a program on Linux. One trait, [`Can`], covers the kernel's interfaces, serial-line adapters, and a
//! pair of ends inside one process. The crate also has the log format of `candump`.
//!
//! The crate moves frames and reports errors. It must not know the meaning of a frame: that belongs to
//! `leadscrew_core::bus`.
//!
//! Terms. A *packet* is anything that a bus can deliver: classical frames, remote requests, extended identifiers, FD
//! frames and error frames. CANopen uses data frames with an 11-bit identifier, classical and FD; the crate sends only
//! these. *Dropped* frames reached this machine but were lost, because the receive buffer was full.
//!
//! ```text
//! Address ("can0", "slcan:tcp:HOST:PORT", "sim:NAME", …) ─ open ─► Can: send many, receive many with time stamps
//!                                                                    ├─ SocketCan: one system call for many frames
//!                                                                    ├─ Slcan: serial line, TCP, Unix socket
//!                                                                    └─ End: one end of a pair in this process
//! ```
//!
//! ```
//! use std::time::Duration;
//!
//! use leadscrew_can::{Can as _, pair};
//! use leadscrew_core::bus::{CobId, Frame};
//!
//! let (mut a, mut b) = pair();
//! let sync = Frame::new(CobId::SYNC, &[]).expect("no more than eight bytes");
//! a.send(&[sync])?;
//! let mut received = Vec::new();
//! assert_eq!(b.receive(&mut received, Duration::ZERO)?, 1);
//! assert_eq!(received[0].packet.frame(), Some(&sync));
//! # Ok::<(), leadscrew_can::CanError>(())
//! ```

mod address;
mod chinese;
mod desk;
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
pub use desk::{Desk, MachineName, Port, connect};
pub use error::CanError;
pub use error_frame::{ErrorFrame, Fault};
pub use health::{Health, Suspicion};
pub use log::{Entry, LogReader, LogWriter, WrongLine};
pub use packet::{Data, FdFrame, Filter, Id, Packet, Received, Stamp};
pub use pair::{End, pair};
pub use slcan::{FD_LINE, Slcan, fd_frame, fd_line, fd_rate};
pub use socket::{SocketCan, is_virtual};

/// One end of a bus.
pub trait Can: Send {
    /// The user's name for the bus: the name of the interface or of the adapter.
    fn name(&self) -> &str;

    /// Sends all frames, in order; waits while the send queue is full. This end does not receive its own frames.
    ///
    /// # Errors
    /// The bus is gone or down, or the bus sent nothing for too long: see [`CanError::Stuck`].
    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError>;

    /// Enables FD frames in both directions, with their data at `data_kbit` kbit/s. The administrator sets the rates of
    /// a kernel interface, so this call only checks that such an interface carries FD frames. The call is not needed
    /// where no FD frames are sent.
    ///
    /// # Errors
    /// The interface or the adapter supports only classical frames, or not this rate.
    fn use_fd(&mut self, data_kbit: u32) -> Result<(), CanError>;

    /// Sends FD frames in the same way as [`send`](Self::send), after all earlier frames. Call [`use_fd`](Self::use_fd)
    /// first.
    ///
    /// # Errors
    /// As for [`send`](Self::send), or the bus carries only classical frames.
    fn send_fd(&mut self, frames: &[bus::FdFrame]) -> Result<(), CanError>;

    /// Appends the received packets to `into` and gives their number. If no packet has arrived yet, waits up to
    /// `patience` for the first. A signal to this thread ends the wait early, without a packet.
    ///
    /// # Errors
    /// The bus is gone or down.
    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError>;

    /// From now on receives only packets that pass at least one of the filters. An empty list passes every packet.
    /// Error frames always pass.
    ///
    /// # Errors
    /// The bus refuses the filters.
    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError>;

    /// Number of packets for this end that were lost so far, because the program did not read the buffer in time.
    ///
    /// # Errors
    /// The bus cannot give the number.
    fn dropped(&self) -> Result<u64, CanError>;
}

/// Opens a bus other than `sim`. `bit_rate` is for adapters on a line. The administrator sets the bit rate of a kernel
/// interface.
///
/// # Errors
/// [`CanError`] says what is missing and how to correct it.
pub fn open(address: &Address, bit_rate: BitRate) -> Result<Box<dyn Can>, CanError> {
    match address {
        Address::Sim => Err(CanError::NotABus),
        Address::SocketCan(name) => Ok(Box::new(SocketCan::open(name)?)),
        Address::Serial { .. } | Address::Tcp { .. } | Address::Unix(_) | Address::Machine(_) => {
            Ok(Box::new(Slcan::open(address, bit_rate)?))
        }
    }
}
