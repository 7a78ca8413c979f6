#![no_std]
//! The serial-line protocol of Lawicel's CAN adapters (SLCAN): classical frames as lines of text.
//!
//! Terms. The *host* sends requests. The *adapter* replies to each request. While the adapter is open, it also sends a
//! line for every frame that it receives. A line ends with CR; an adapter refuses with a single BEL. A *time stamp*
//! counts the milliseconds of a minute.
//!
//! ```text
//! t1232AABB␍          a data frame, identifier 123h, two bytes      T, with eight digits: an extended identifier
//! r1230␍              a remote request                              R, likewise
//! S8␍ O␍ L␍ C␍        bit rate, open, listen only, close
//! V␍ N␍ F␍ Z1␍        version, serial number, status flags, time stamps on
//! M…␍ m…␍             acceptance code and mask, eight digits each
//! ```
//!
//! [`Lines`] cuts bytes into lines. [`Request`] and [`Reply`] are the meaning of the lines in the two directions.
//! [`Adapter`] is the behaviour of the adapter's side, for a board that is reached over a serial line. Sans-IO: this
//! crate must not know the connection that carries the bytes.
//!
//! ```
//! use leadscrew_slcan::{BitRate, Lines, Request};
//!
//! let line = Request::Rate(BitRate::K500).line();
//! assert_eq!(line.bytes(), b"S6\r");
//!
//! let mut lines: Lines = Lines::default();
//! let heard = line.bytes().iter().find_map(|&byte| Request::of(lines.push(byte)?));
//! assert_eq!(heard, Some(Request::Rate(BitRate::K500)));
//! ```

#[cfg(test)]
extern crate std;

mod acceptance;
mod adapter;
mod frame;
mod line;
mod reply;
mod request;
#[cfg(test)]
mod tests;

pub use adapter::{Adapter, Handled};
pub use frame::{ExtendedFrame, ExtendedId, SlcanFrame};
pub use line::{Heard, Line, Lines};
pub use reply::{Flags, Reply, Stamp};
pub use request::{BitRate, Request};
