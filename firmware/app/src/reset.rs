//! Why the processor started.

use leadscrew_core::alarm::{Alarm, Code, Span};

/// The flags of a reset, as the chip keeps them until they are cleared. Several are set at once: every reset pulls the
/// reset pin, and a loss of power also sets the flag of the brown-out detector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ResetFlags {
    /// Brown-out detector: set at power-up too.
    pub brown_out: bool,
    /// Independent watchdog.
    pub watchdog: bool,
    /// Window watchdog: this image does not use it.
    pub window_watchdog: bool,
    /// A reset by the program, or by a debugger through the processor.
    pub software: bool,
    /// The reset pin.
    pub pin: bool,
}

/// Why the processor started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResetCause {
    /// The power came on, and the memory was lost.
    #[default]
    Power,
    /// The power dropped below the chip's limit, but came back before the memory was lost.
    BrownOut,
    /// The watchdog: tick or background had stopped.
    Watchdog,
    /// The program, on purpose, after a panic or a fault. Or a debugger.
    Software,
    /// The reset button, or a debugger.
    Pin,
}

impl ResetCause {
    /// Reads the flags. `kept`: the memory is still that of the last run, as its checksum says. The brown-out detector
    /// counts first, because a drop of power causes the other flags. The pin counts last, because every reset pulls it.
    ///
    /// The detector does not say how long the power was away; the memory does. A short switching off and on again looks
    /// like a drop, and a drop of a second or more may look like switching on.
    #[must_use]
    pub const fn of(flags: ResetFlags, kept: bool) -> Self {
        if flags.brown_out && kept {
            Self::BrownOut
        } else if flags.brown_out {
            Self::Power
        } else if flags.watchdog || flags.window_watchdog {
            Self::Watchdog
        } else if flags.software {
            Self::Software
        } else if flags.pin {
            Self::Pin
        } else {
            Self::Power
        }
    }

    /// The warning for a start that follows no failure: somebody has reset the processor, whatever the machine was doing.
    #[must_use]
    pub fn warning(self) -> Option<Alarm> {
        match self {
            Self::Software | Self::Pin => Some(Alarm::new(Code::ResetFromOutside, Span::default())),
            Self::Power | Self::BrownOut | Self::Watchdog => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strongest_cause_counts_and_the_pin_is_always_there() {
        let pin = ResetFlags {
            pin: true,
            ..ResetFlags::default()
        };
        let software = ResetFlags {
            software: true,
            ..pin
        };
        let watchdog = ResetFlags {
            watchdog: true,
            ..software
        };
        let brown_out = ResetFlags {
            brown_out: true,
            ..watchdog
        };
        for kept in [true, false] {
            assert_eq!(ResetCause::of(pin, kept), ResetCause::Pin);
            assert_eq!(ResetCause::of(software, kept), ResetCause::Software);
            assert_eq!(ResetCause::of(watchdog, kept), ResetCause::Watchdog);
            let none = ResetFlags::default();
            assert_eq!(ResetCause::of(none, kept), ResetCause::Power);
        }
        assert_eq!(ResetCause::of(brown_out, true), ResetCause::BrownOut);
        assert_eq!(ResetCause::of(brown_out, false), ResetCause::Power);
    }
}
