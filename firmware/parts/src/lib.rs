#![no_std]
#![forbid(unsafe_code)]
//! What a board's image is made of and needs no hardware: arithmetic and rules around registers, without the registers.
//!
//! | part | is |
//! |---|---|
//! | [`BitTiming`] | segments of a CAN bit from the controller's clock |
//! | [`to_send`], [`received`], [`controller`] | the words of a CAN controller: frames, its state |
//! | [`Rings`], [`Chip`] | frames between tick, background and the interrupt of the CAN controller, whenever one comes in between |
//! | [`Gate`] | which frame may go into the CAN controller next |
//! | [`EdgeClock`] | counter, capture and index of an encoder to a sample |
//! | [`WordFlash`] | flash of words with error correction to the traits of storage |
//! | [`Contacts`], [`Clamp`], [`Switches`] | emergency stop, feed hold, clamp and spindle enable, behind the traits of pins |
//!
//! Knows no chip and no register; constants of a chip are arguments. Nothing here waits or allocates.

mod edges;
mod flash;
mod gate;
mod message;
mod panel;
mod shared;
mod timing;
mod wire;

pub use edges::{EdgeClock, Reading};
pub use flash::{WordDevice, WordError, WordFlash};
pub use gate::{Gate, Turn};
pub use message::{controller, received, to_send};
pub use panel::{Clamp, Contacts, Said, Switches};
pub use timing::BitTiming;
pub use wire::{BackgroundEnd, BusEnd, Chip, Places, Rings, TickEnd};
