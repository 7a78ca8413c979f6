//! The power state machine of CiA 402 from the master's view: the meaning of statuswords and controlwords.

/// 6041h.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Statusword(u16);

impl Statusword {
    /// The word with the value `raw`.
    #[must_use]
    pub const fn from_raw(raw: u16) -> Self {
        Self(raw)
    }

    /// The value of the word.
    #[must_use]
    pub const fn raw(self) -> u16 {
        self.0
    }

    /// True in operation enabled.
    #[must_use]
    pub const fn is_enabled(self) -> bool {
        self.0 & 0x6F == 0x27
    }

    /// The homing in the statusword: bits 13, 12 and 10 in mode 6.
    #[must_use]
    pub const fn homing(self) -> HomingState {
        match (self.0 >> 13 & 1, self.0 >> 12 & 1, self.0 >> 10 & 1) {
            (0, 0, 0) => HomingState::Runs,
            (0, 0, _) => HomingState::NotStarted,
            (0, _, 0) => HomingState::Found,
            (0, _, _) => HomingState::Done,
            _ => HomingState::Error,
        }
    }

    /// The state in the statusword; `None` for a pattern that CiA 402 does not define.
    #[must_use]
    pub const fn state(self) -> Option<State> {
        // Bits 3–0 and 6 give the state. Bit 5 (quick stop, active low) counts only where the drive may be switched on.
        match self.0 & 0x4F {
            0x00 => return Some(State::NotReadyToSwitchOn),
            0x40 => return Some(State::SwitchOnDisabled),
            0x0F => return Some(State::FaultReactionActive),
            0x08 => return Some(State::Fault),
            _ => {}
        }
        match self.0 & 0x6F {
            0x21 => Some(State::ReadyToSwitchOn),
            0x23 => Some(State::SwitchedOn),
            0x27 => Some(State::OperationEnabled),
            0x07 => Some(State::QuickStopActive),
            _ => None,
        }
    }
}

/// How far a homing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HomingState {
    /// Under way.
    Runs,
    /// Not started, or interrupted; the axis stands.
    NotStarted,
    /// The mark is found, and the axis still moves.
    Found,
    /// The mark is found, and the axis stands.
    Done,
    /// Failed.
    Error,
}

/// A state of the power state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum State {
    /// Initialising.
    NotReadyToSwitchOn,
    /// Waiting for permission to switch on.
    SwitchOnDisabled,
    /// High voltage may be applied.
    ReadyToSwitchOn,
    /// High voltage is applied.
    SwitchedOn,
    /// Torque is on; the drive follows its target.
    OperationEnabled,
    /// Braking, or standing after braking.
    QuickStopActive,
    /// Reacting to a fault.
    FaultReactionActive,
    /// Stopped by a fault.
    Fault,
}

impl State {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::NotReadyToSwitchOn,
        Self::SwitchOnDisabled,
        Self::ReadyToSwitchOn,
        Self::SwitchedOn,
        Self::OperationEnabled,
        Self::QuickStopActive,
        Self::FaultReactionActive,
        Self::Fault,
    ];

    /// The name of the state in CiA 402.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotReadyToSwitchOn => "not ready to switch on",
            Self::SwitchOnDisabled => "switch on disabled",
            Self::ReadyToSwitchOn => "ready to switch on",
            Self::SwitchedOn => "switched on",
            Self::OperationEnabled => "operation enabled",
            Self::QuickStopActive => "quick stop active",
            Self::FaultReactionActive => "fault reaction active",
            Self::Fault => "fault",
        }
    }
}

/// 6040h.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Controlword(u16);

impl Controlword {
    /// Voltage off: from any state to switch on disabled.
    pub const DISABLE_VOLTAGE: Self = Self(0x0000);
    /// To quick stop active: the drive brakes by itself.
    pub const QUICK_STOP: Self = Self(0x0002);
    /// To ready to switch on.
    pub const SHUTDOWN: Self = Self(0x0006);
    /// To switched on.
    pub const SWITCH_ON: Self = Self(0x0007);
    /// To operation enabled.
    pub const ENABLE_OPERATION: Self = Self(0x000F);
    /// Enabled, bit 4: homing runs as long as the bit stays.
    pub const HOME: Self = Self(0x001F);
    /// Enabled, bit 4 in mode 7: the drive follows its setpoints.
    pub const INTERPOLATE: Self = Self::HOME;
    /// Homing with bit 8: the axis halts on its way.
    pub const HOME_HALTED: Self = Self(0x011F);
    /// Enabled, bit 8: the axis halts.
    pub const HALT: Self = Self(0x010F);
    /// Out of fault, on the rising edge of bit 7.
    pub const FAULT_RESET: Self = Self(0x0080);

    /// The word with the value `raw`.
    #[must_use]
    pub const fn from_raw(raw: u16) -> Self {
        Self(raw)
    }

    /// The value of the word.
    #[must_use]
    pub const fn raw(self) -> u16 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_statusword_is_in_one_state_or_none() {
        // Pattern and mask of each state as CiA 402 prints them.
        let table = [
            (State::NotReadyToSwitchOn, 0x4F, 0x00),
            (State::SwitchOnDisabled, 0x4F, 0x40),
            (State::ReadyToSwitchOn, 0x6F, 0x21),
            (State::SwitchedOn, 0x6F, 0x23),
            (State::OperationEnabled, 0x6F, 0x27),
            (State::QuickStopActive, 0x6F, 0x07),
            (State::FaultReactionActive, 0x4F, 0x0F),
            (State::Fault, 0x4F, 0x08),
        ];
        let mut named = 0;
        for raw in 0..=u16::MAX {
            let mut matching = table
                .iter()
                .filter(|(_, mask, pattern)| raw & mask == *pattern)
                .map(|(state, ..)| *state);
            let wanted = matching.next();
            assert_eq!(matching.next(), None, "{raw:04X}h stands for two states");
            assert_eq!(Statusword::from_raw(raw).state(), wanted, "{raw:04X}h");
            named += u32::from(wanted.is_some());
        }
        // Of the 64 patterns in bits 6–5 and 3–0, four states own two each and four own one.
        assert_eq!(named, 12 * 1024);
    }

    #[test]
    fn statuswords_drives_really_send() {
        for (raw, state) in [
            (0x0250, State::SwitchOnDisabled),
            (0x0231, State::ReadyToSwitchOn),
            (0x0233, State::SwitchedOn),
            (0x1237, State::OperationEnabled),
            (0x0217, State::QuickStopActive),
            (0x0218, State::Fault),
            (0x021F, State::FaultReactionActive),
            (0x0200, State::NotReadyToSwitchOn),
        ] {
            assert_eq!(Statusword::from_raw(raw).state(), Some(state));
        }
    }
}
