//! Why the processor started.

/// The flags of a reset, as the chip keeps them until they are cleared. Several are set at once: every reset pulls the reset
/// pin, and a loss of power sets that of the brown-out detector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ResetFlags {
    /// Brown-out detector: power-up too.
    pub brown_out: bool,
    /// Independent watchdog.
    pub watchdog: bool,
    /// Window watchdog: this image does not use it.
    pub window_watchdog: bool,
    /// Asked for by the program.
    pub software: bool,
    /// The reset pin.
    pub pin: bool,
}

/// What started it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResetCause {
    /// The power came, or had dropped below what the chip needs.
    #[default]
    Power,
    /// The watchdog: tick or background had stopped.
    Watchdog,
    /// The program, on purpose: behind a panic or a fault.
    Software,
    /// The reset button, or a debugger.
    Pin,
}

impl ResetCause {
    /// What the flags mean. A brown-out counts before everything, for it leaves the memory without meaning; the pin last, for
    /// every cause pulls it.
    #[must_use]
    pub const fn of(flags: ResetFlags) -> Self {
        if flags.brown_out {
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
        assert_eq!(ResetCause::of(pin), ResetCause::Pin);
        let software = ResetFlags {
            software: true,
            ..pin
        };
        assert_eq!(ResetCause::of(software), ResetCause::Software);
        let watchdog = ResetFlags {
            watchdog: true,
            ..software
        };
        assert_eq!(ResetCause::of(watchdog), ResetCause::Watchdog);
        let brown_out = ResetFlags {
            brown_out: true,
            ..watchdog
        };
        assert_eq!(ResetCause::of(brown_out), ResetCause::Power);
        assert_eq!(ResetCause::of(ResetFlags::default()), ResetCause::Power);
    }
}
