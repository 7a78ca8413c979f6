//! Which spindle taps, and which way it turns: plain values.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A spindle that can tap (E word, M24–M27).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum TapSpindle {
    /// E1, M24.
    #[default]
    First,
    /// E2, M25.
    Second,
    /// E3, M26.
    Third,
    /// E4, M27.
    Fourth,
}

impl TapSpindle {
    /// All four.
    pub const ALL: [Self; 4] = [Self::First, Self::Second, Self::Third, Self::Fourth];

    /// Spindle `number`; `None` outside 1…4.
    #[must_use]
    pub const fn new(number: u32) -> Option<Self> {
        Some(match number {
            1 => Self::First,
            2 => Self::Second,
            3 => Self::Third,
            4 => Self::Fourth,
            _ => return None,
        })
    }

    /// 1…4.
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::First => 1,
            Self::Second => 2,
            Self::Third => 3,
            Self::Fourth => 4,
        }
    }
}

/// The hand of a tap: which way the spindle turns on the way in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum Hand {
    /// As M03.
    #[default]
    Right,
    /// As M04.
    Left,
}
