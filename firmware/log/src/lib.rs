#![no_std]
//! The events of a board as log messages. The image provides the way to the reader.
//!
//! The messages are numbers and short words only: the gateway has the texts of alarms.

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

/// Logs an event.
pub fn event(event: &Event) {
    match event {
        Event::Ready => defmt::info!("ready"),
        Event::Alarm(alarm) => defmt::error!("alarm {=u16}", alarm.number()),
        Event::Warning(alarm) => defmt::warn!("warning {=u16}", alarm.number()),
        Event::Refused(alarm) => defmt::info!("refused {=u16}", alarm.number()),
        Event::Held => defmt::info!("held"),
        Event::Reset => defmt::info!("reset"),
        Event::Finished => defmt::info!("finished"),
        Event::Started { number, line } => defmt::debug!("move {=u32} line {=u32}", number, line),
        Event::Spindle(_) | Event::Rigid | Event::Aux(_) => {}
    }
}
