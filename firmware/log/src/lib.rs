#![no_std]
//! What happens on a board, as messages for a desk. Who carries them to it is the image's.
//!
//! Numbers and short words only: the texts of alarms are where a gateway is.

use leadscrew_app::ResetCause;
use leadscrew_core::board::Event;

/// The processor has started.
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
