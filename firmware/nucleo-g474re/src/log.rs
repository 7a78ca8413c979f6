//! Messages over RTT, with the feature `defmt`; without it, nothing. Writing one keeps all interrupts out.

#[cfg(feature = "defmt")]
use defmt_rtt as _;

#[cfg(feature = "defmt")]
pub use leadscrew_log::{event, started};

/// Frames may have come for which there was no room.
#[cfg(feature = "defmt")]
pub fn lost_frames() {
    if crate::wire::has_lost() {
        defmt::warn!("frames have come for which there was no room");
    }
}

/// The processor has started.
#[cfg(not(feature = "defmt"))]
pub fn started(_: leadscrew_app::ResetCause) {}

/// Something has happened.
#[cfg(not(feature = "defmt"))]
pub fn event(_: &leadscrew_core::board::Event) {}

/// Frames may have come for which there was no room.
#[cfg(not(feature = "defmt"))]
pub fn lost_frames() {}
