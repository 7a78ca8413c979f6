//! How a machine is operated: its modes, and what an operator asks of an axis by hand.
//!
//! Plain values: what each mode lets in is decided on the board.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::units::Length;

/// What keeps the machine from starting, from turning its spindle, or from moving an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
#[repr(u8)]
pub enum Interlock {
    /// Feed hold is on.
    Hold = 0,
    /// The door is open.
    Door = 1,
    /// The chuck is open.
    Chuck = 2,
    /// The chuck has no pressure.
    ChuckPressure = 3,
    /// The tailstock has no pressure.
    TailstockPressure = 4,
    /// The enabling switch is not held, with the door open.
    Enable = 5,
    /// The spindle turns, or has not stood for a second.
    Spindle = 6,
}

impl Interlock {
    /// All of them; each at the index of its number.
    pub const ALL: [Self; 7] = [
        Self::Hold,
        Self::Door,
        Self::Chuck,
        Self::ChuckPressure,
        Self::TailstockPressure,
        Self::Enable,
        Self::Spindle,
    ];

    /// The name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Door => "door",
            Self::Chuck => "chuck",
            Self::ChuckPressure => "chuck_pressure",
            Self::TailstockPressure => "tailstock_pressure",
            Self::Enable => "enable",
            Self::Spindle => "spindle",
        }
    }
}

/// A zone that the tip of a tool may not enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
#[repr(u8)]
pub enum Zone {
    /// The body of the chuck.
    Chuck = 0,
    /// Its jaws.
    Jaws = 1,
    /// The tailstock.
    Tailstock = 2,
}

impl Zone {
    /// All of them; each at the index of its number.
    pub const ALL: [Self; 3] = [Self::Chuck, Self::Jaws, Self::Tailstock];
}

/// The mode in which the machine is operated. It says which requests the board lets in; a change moves nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
#[repr(u8)]
pub enum OperatingMode {
    /// By hand: axes move while a key is held.
    #[default]
    Manual = 0,
    /// By hand in steps.
    Step = 1,
    /// By handwheel.
    Wheel = 2,
    /// Reference.
    Reference = 3,
    /// Single lines (manual data input).
    Mdi = 4,
    /// Programs.
    Automatic = 5,
}

impl OperatingMode {
    /// All modes; each at the index of its number.
    pub const ALL: [Self; 6] = [
        Self::Manual,
        Self::Step,
        Self::Wheel,
        Self::Reference,
        Self::Mdi,
        Self::Automatic,
    ];

    /// The name in commands and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Manual => "manual",
            Self::Step => "step",
            Self::Wheel => "wheel",
            Self::Reference => "reference",
            Self::Mdi => "mdi",
            Self::Automatic => "automatic",
        }
    }

    /// A program or a line may be begun, and goes on after a hold.
    #[must_use]
    pub const fn runs(self) -> bool {
        matches!(self, Self::Mdi | Self::Automatic)
    }

    /// Axes are moved by hand.
    #[must_use]
    pub const fn by_hand(self) -> bool {
        matches!(self, Self::Manual | Self::Step | Self::Wheel)
    }

    /// The mode with this number.
    #[must_use]
    pub fn from_raw(raw: u8) -> Option<Self> {
        Self::ALL.get(usize::from(raw)).copied()
    }
}

/// One direction of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Towards {
    /// Greater coordinates.
    Plus,
    /// Smaller coordinates.
    Minus,
}

impl Towards {
    /// The direction of a way with its sign; none is one towards plus.
    #[must_use]
    pub fn of(way: Length) -> Self {
        if way < Length::ZERO {
            Self::Minus
        } else {
            Self::Plus
        }
    }

    /// The other direction.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Plus => Self::Minus,
            Self::Minus => Self::Plus,
        }
    }
}

/// What a handwheel leads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Led {
    /// The slide of X.
    #[default]
    X = 0,
    /// Z.
    Z = 1,
    /// The program along its path.
    Path = 2,
}

impl Led {
    /// What has this number.
    #[must_use]
    pub const fn from_raw(raw: u8) -> Option<Self> {
        Some(match raw {
            0 => Self::X,
            1 => Self::Z,
            2 => Self::Path,
            _ => return None,
        })
    }
}

/// How many increments a count of the handwheel is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum WheelFactor {
    /// One.
    #[default]
    One = 1,
    /// Ten.
    Ten = 10,
    /// A hundred.
    Hundred = 100,
}

impl WheelFactor {
    /// The factor with this number.
    #[must_use]
    pub const fn from_raw(raw: u8) -> Option<Self> {
        Some(match raw {
            1 => Self::One,
            10 => Self::Ten,
            100 => Self::Hundred,
            _ => return None,
        })
    }

    /// This many increments of `increment`.
    #[must_use]
    pub const fn of(self, increment: Length) -> Length {
        Length::from_nm(increment.nm().saturating_mul(self as i64))
    }
}

/// What became of the last press, step or claim of the handwheel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum PressState {
    /// There was none.
    #[default]
    None = 0,
    /// An axis moves, or may.
    Runs = 1,
    /// Over.
    Ended = 2,
    /// Over at a limit of the travel, or at a zone.
    Limit = 3,
    /// Not let in.
    Refused = 4,
}

impl PressState {
    const ALL: [Self; 5] = [
        Self::None,
        Self::Runs,
        Self::Ended,
        Self::Limit,
        Self::Refused,
    ];

    /// The state with this number.
    #[must_use]
    pub fn from_raw(raw: u8) -> Option<Self> {
        Self::ALL.get(usize::from(raw)).copied()
    }
}
