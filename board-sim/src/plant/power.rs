//! The power state machine of CiA 402 as a drive runs it.
//!
//! This is written from the standard's transition table, on purpose not from the master's code (`bus::cia402`): the two
//! check each other.

/// State of a drive's power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Power {
    /// Initialising.
    NotReady,
    /// Switch on disabled.
    Disabled,
    /// Ready to switch on.
    Ready,
    /// Switched on.
    On,
    /// Operation enabled.
    Enabled,
    /// Quick stop active.
    QuickStop,
    /// Fault reaction active.
    Reacting,
    /// Fault.
    Fault,
}

/// The request of a controlword, by bits 0–3 and the rise of bit 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Request {
    DisableVoltage,
    QuickStop,
    Shutdown,
    SwitchOn,
    EnableOperation,
    FaultReset,
    /// Bit 7 stays set: no request.
    None,
}

impl Request {
    const fn of(word: u16, previous: u16) -> Self {
        if word & 0x80 != 0 {
            return if previous & 0x80 == 0 {
                Self::FaultReset
            } else {
                Self::None
            };
        }
        match word & 0x0F {
            0b1111 => Self::EnableOperation,
            0b0111 => Self::SwitchOn,
            0b0110 | 0b1110 => Self::Shutdown,
            w if w & 0b0010 == 0 => Self::DisableVoltage,
            // Bit 1 set, bit 2 clear.
            _ => Self::QuickStop,
        }
    }
}

impl Power {
    /// The state after a controlword; `previous` is the controlword before it.
    #[must_use]
    pub const fn after(self, word: u16, previous: u16) -> Self {
        match (self, Request::of(word, previous)) {
            // Transition 2.
            (Self::Disabled, Request::Shutdown) => Self::Ready,
            // 3; also the first half of 3 and 4 where both are requested at once.
            (Self::Ready, Request::SwitchOn | Request::EnableOperation) => Self::On,
            // 4 and 16.
            (Self::On | Self::QuickStop, Request::EnableOperation) => Self::Enabled,
            // 5.
            (Self::Enabled, Request::SwitchOn) => Self::On,
            // 6 and 8.
            (Self::On | Self::Enabled, Request::Shutdown) => Self::Ready,
            // 7 and 10.
            (Self::Ready | Self::On, Request::QuickStop | Request::DisableVoltage) => {
                Self::Disabled
            }
            // 9 and 12.
            (Self::Enabled | Self::QuickStop, Request::DisableVoltage) => Self::Disabled,
            // 11.
            (Self::Enabled, Request::QuickStop) => Self::QuickStop,
            // 15.
            (Self::Fault, Request::FaultReset) => Self::Disabled,
            (state, _) => state,
        }
    }

    /// True for a state that a drive reaches later than this one on its way to operation. One that is held in quick stop
    /// has left that way.
    #[must_use]
    pub const fn is_beyond(self, most: Self) -> bool {
        self.place() > most.place()
    }

    /// The place on the way to operation. A fault is on none.
    const fn place(self) -> u8 {
        match self {
            Self::Reacting | Self::Fault | Self::NotReady | Self::QuickStop => 0,
            Self::Disabled => 1,
            Self::Ready => 2,
            Self::On => 3,
            Self::Enabled => 4,
        }
    }

    /// The statusword: state, voltage enabled (bit 4), remote (bit 9). In operation enabled also bit 12: the drive
    /// follows its target.
    #[must_use]
    pub const fn statusword(self) -> u16 {
        0x0200
            | match self {
                Self::NotReady => 0x0000,
                Self::Disabled => 0x0050,
                Self::Ready => 0x0031,
                Self::On => 0x0033,
                Self::Enabled => 0x1037,
                Self::QuickStop => 0x0017,
                Self::Reacting => 0x001F,
                Self::Fault => 0x0018,
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_core::bus::{State, Statusword};

    const ALL: [Power; 8] = [
        Power::NotReady,
        Power::Disabled,
        Power::Ready,
        Power::On,
        Power::Enabled,
        Power::QuickStop,
        Power::Reacting,
        Power::Fault,
    ];

    #[test]
    fn the_master_reads_every_state_as_it_is_meant() {
        for (power, state) in ALL.into_iter().zip(State::ALL) {
            let word = Statusword::from_raw(power.statusword());
            assert_eq!(word.state(), Some(state));
        }
    }

    #[test]
    fn every_state_under_every_controlword() {
        use Power::{Disabled, Enabled, Fault, NotReady, On, QuickStop, Reacting, Ready};
        // The columns are in the order of ALL: the state after the word.
        let table = [
            // Disable voltage: xx0x.
            (
                0x0000,
                [
                    NotReady, Disabled, Disabled, Disabled, Disabled, Disabled, Reacting, Fault,
                ],
            ),
            // Quick stop: x01x.
            (
                0x0002,
                [
                    NotReady, Disabled, Disabled, Disabled, QuickStop, QuickStop, Reacting, Fault,
                ],
            ),
            // Shutdown: x110.
            (
                0x0006,
                [
                    NotReady, Ready, Ready, Ready, Ready, QuickStop, Reacting, Fault,
                ],
            ),
            // Switch on, disable operation: 0111.
            (
                0x0007,
                [NotReady, Disabled, On, On, On, QuickStop, Reacting, Fault],
            ),
            // Enable operation: 1111.
            (
                0x000F,
                [
                    NotReady, Disabled, On, Enabled, Enabled, Enabled, Reacting, Fault,
                ],
            ),
            // Fault reset: bit 7 rises.
            (
                0x0080,
                [
                    NotReady, Disabled, Ready, On, Enabled, QuickStop, Reacting, Disabled,
                ],
            ),
        ];
        for low in 0..=0xFFu16 {
            // The row of a controlword, by the masks of the standard.
            let row = match low {
                w if w & 0x80 == 0x80 => 5,
                w if w & 0x02 == 0x00 => 0,
                w if w & 0x06 == 0x02 => 1,
                w if w & 0x07 == 0x06 => 2,
                w if w & 0x0F == 0x07 => 3,
                _ => 4,
            };
            for high in [0x0000, 0x0100, 0xFF00] {
                for (from, to) in ALL.into_iter().zip(table[row].1) {
                    assert_eq!(
                        from.after(high | low, 0),
                        to,
                        "{from:?} under {:04X}h",
                        high | low
                    );
                }
            }
        }
        for (word, states) in table {
            for (from, to) in ALL.into_iter().zip(states) {
                assert_eq!(from.after(word, 0), to);
            }
        }
    }

    #[test]
    fn a_standing_reset_bit_resets_nothing() {
        assert_eq!(Power::Fault.after(0x0080, 0x0080), Power::Fault);
        assert_eq!(Power::Fault.after(0x008F, 0x0080), Power::Fault);
        assert_eq!(Power::Fault.after(0x0080, 0x000F), Power::Disabled);
        assert_eq!(Power::Enabled.after(0x008F, 0x0080), Power::Enabled);
    }
}
