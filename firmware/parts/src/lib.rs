#![no_std]
#![forbid(unsafe_code)]
//! The parts of a board's image that need no hardware: arithmetic and rules for registers, without the registers.
//!
//! | part | purpose |
//! |---|---|
//! | [`BitTiming`], [`Rates`] | segments of a CAN bit from the controller's clock, and which clock |
//! | [`to_send`], [`fd_to_send`], [`received`], [`controller`] | the words of a CAN controller: frames, its state |
//! | [`Rings`], [`Chip`] | frames between tick, background and the interrupt of the CAN controller, in any order |
//! | [`Gate`] | which frame may go into the CAN controller next |
//! | [`EdgeClock`] | a sample from counter, capture and index of an encoder |
//! | [`Detents`] | detents from the counter of a handwheel |
//! | [`WordFlash`] | the traits of storage on a flash of words with error correction |
//! | [`Contacts`], [`Clamp`], [`Switches`] | emergency stop, feed hold, clamp, spindle enable, through the traits of pins |
//!
//! This crate knows no chip and no register; constants of a chip are arguments. It does not wait and does not allocate.

mod detents;
mod edges;
mod flash;
mod gate;
mod message;
mod panel;
mod shared;
mod timing;
mod wire;

pub use detents::Detents;
pub use edges::{EdgeClock, Reading};
pub use flash::{WordDevice, WordError, WordFlash};
pub use gate::{Gate, Turn};
pub use message::{ELEMENT, Heard, Words, controller, fd_to_send, received, to_send};
pub use panel::{Clamp, Contacts, MachineInputs, Said, Switches};
pub use timing::{BitTiming, Rates};
pub use wire::{BackgroundEnd, BusEnd, Chip, Places, Rings, TickEnd};
