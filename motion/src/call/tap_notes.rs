//! The facts about the program that the tap journal keeps for a hole: unit, plane, extraction override.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::units::CentiRpm;

/// The unit a program's lengths are written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum LengthUnit {
    /// G21.
    #[default]
    Metric,
    /// G20.
    Inch,
}

/// A plane of the work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum Plane {
    /// X–Y.
    G17,
    /// Z–X.
    #[default]
    G18,
    /// Y–Z.
    G19,
}

impl Plane {
    /// The plane of `G<code>`; `None` outside 17…19.
    #[must_use]
    pub const fn new(code: u8) -> Option<Self> {
        Some(match code {
            17 => Self::G17,
            18 => Self::G18,
            19 => Self::G19,
            _ => return None,
        })
    }

    /// 17, 18 or 19.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::G17 => 17,
            Self::G18 => 18,
            Self::G19 => 19,
        }
    }
}

/// The extraction override of a tap: speed on the way out over speed on the way in, as it is asked for; the highest speed
/// of a tap is not in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
#[serde(into = "(u32, u32)", try_from = "(u32, u32)")]
pub struct Extraction {
    part: u32,
    whole: u32,
}

impl Default for Extraction {
    fn default() -> Self {
        Self::NONE
    }
}

impl Extraction {
    /// Out as fast as in.
    pub const NONE: Self = Self { part: 1, whole: 1 };

    /// `part` over `whole`; `None` unless both are above zero.
    #[must_use]
    pub const fn new(part: u32, whole: u32) -> Option<Self> {
        if part == 0 || whole == 0 {
            return None;
        }
        Some(Self { part, whole })
    }

    /// Numerator.
    #[must_use]
    pub const fn part(self) -> u32 {
        self.part
    }

    /// Denominator.
    #[must_use]
    pub const fn whole(self) -> u32 {
        self.whole
    }

    /// The speed out for a speed in (its magnitude), to the nearest hundredth of a turn a minute and at least one.
    #[must_use]
    pub fn of(self, speed: CentiRpm) -> CentiRpm {
        let scaled = u64::from(speed.get().unsigned_abs()).saturating_mul(u64::from(self.part));
        let half = u64::from(self.whole >> 1);
        let speed = scaled
            .saturating_add(half)
            .checked_div(u64::from(self.whole))
            .unwrap_or(0)
            .max(1);
        CentiRpm::new(i32::try_from(speed).unwrap_or(i32::MAX))
    }
}

impl From<Extraction> for (u32, u32) {
    fn from(extraction: Extraction) -> Self {
        (extraction.part, extraction.whole)
    }
}

impl TryFrom<(u32, u32)> for Extraction {
    type Error = &'static str;

    fn try_from((part, whole): (u32, u32)) -> Result<Self, Self::Error> {
        Self::new(part, whole).ok_or("an override is a ratio of positive numbers")
    }
}

/// What the tap journal keeps of the program around a hole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub struct TapNotes {
    /// G20 or G21.
    pub unit: LengthUnit,
    /// G17, G18 or G19.
    pub plane: Plane,
    /// The extraction override.
    pub extraction: Extraction,
}

impl TapNotes {
    /// As at power-on, without an extraction override.
    pub const METRIC: Self = Self {
        unit: LengthUnit::Metric,
        plane: Plane::G18,
        extraction: Extraction::NONE,
    };
}
