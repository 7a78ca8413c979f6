//! Messages over RTT, with the feature `defmt`; without it, no messages. A message keeps all interrupts out while it is
//! written.

#[cfg(feature = "defmt")]
use defmt_rtt as _;

#[cfg(feature = "defmt")]
pub use leadscrew_log::{event, started};

/// Warns where received frames were lost because there was no room.
#[cfg(feature = "defmt")]
pub fn lost_frames() {
    if crate::wire::has_lost() {
        defmt::warn!("frames have come for which there was no room");
    }
}

/// Does nothing without the feature.
#[cfg(not(feature = "defmt"))]
pub fn started(_: leadscrew_app::ResetCause) {}

/// Does nothing without the feature.
#[cfg(not(feature = "defmt"))]
pub fn event(_: &leadscrew_core::board::Event) {}

/// Does nothing without the feature.
#[cfg(not(feature = "defmt"))]
pub fn lost_frames() {}
