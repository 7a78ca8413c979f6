//! Messages on the emulator's output, with the feature `defmt`; without it, nothing. The text of a panic does not go there
//! then: it would fall between two halves of a message.

#[cfg(feature = "defmt")]
use defmt_semihosting as _;
#[cfg(feature = "defmt")]
pub use leadscrew_log::{event, started};

/// The processor has started.
#[cfg(not(feature = "defmt"))]
pub fn started(_: leadscrew_app::ResetCause) {}

/// Something has happened.
#[cfg(not(feature = "defmt"))]
pub fn event(_: &leadscrew_core::board::Event) {}
