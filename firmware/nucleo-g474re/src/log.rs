//! Messages over RTT, with the feature `defmt`; without it, nothing.
//!
//! Numbers and short words only: the texts of alarms are where a gateway is. Writing one keeps all interrupts out.

#[cfg(feature = "defmt")]
use {defmt_rtt as _, panic_probe as _};

use leadscrew_app::ResetCause;
use leadscrew_core::board::Event;

/// The processor has started.
#[cfg(feature = "defmt")]
pub fn started(cause: ResetCause) {
    let cause = match cause {
        ResetCause::Power => "power",
        ResetCause::BrownOut => "brown-out",
        ResetCause::Watchdog => "watchdog",
        ResetCause::Software => "program",
        ResetCause::Pin => "pin",
    };
    defmt::info!("started by {=str}", cause);
}

/// Something has happened.
#[cfg(feature = "defmt")]
pub fn event(event: &Event) {
    match event {
        Event::Ready => defmt::info!("ready"),
        Event::Alarm(alarm) => defmt::error!("alarm {=u16}", alarm.number()),
        Event::Warning(alarm) => defmt::warn!("warning {=u16}", alarm.number()),
        Event::Held => defmt::info!("held"),
        Event::Reset => defmt::info!("reset"),
        Event::Finished => defmt::info!("finished"),
        Event::Started { number, line } => defmt::debug!("move {=u32} line {=u32}", number, line),
        Event::Spindle(_) | Event::Rigid | Event::Aux(_) => {}
    }
}

/// Frames may have come for which there was no room.
#[cfg(feature = "defmt")]
pub fn lost_frames() {
    if crate::wire::has_lost() {
        defmt::warn!("frames have come for which there was no room");
    }
}

/// The processor has started.
#[cfg(not(feature = "defmt"))]
pub fn started(_: ResetCause) {}

/// Something has happened.
#[cfg(not(feature = "defmt"))]
pub fn event(_: &Event) {}

/// Frames may have come for which there was no room.
#[cfg(not(feature = "defmt"))]
pub fn lost_frames() {}
