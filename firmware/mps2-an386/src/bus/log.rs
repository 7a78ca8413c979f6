//! Messages on the emulator's output, with the feature `defmt`; without it, no messages. With the feature the text of a
//! panic is not printed: it could fall between two halves of a message.

#[cfg(feature = "defmt")]
use defmt_semihosting as _;
#[cfg(feature = "defmt")]
pub use leadscrew_log::{event, started};

/// Does nothing without the feature.
#[cfg(not(feature = "defmt"))]
pub fn started(_: leadscrew_app::ResetCause) {}

/// Does nothing without the feature.
#[cfg(not(feature = "defmt"))]
pub fn event(_: &leadscrew_core::board::Event) {}
