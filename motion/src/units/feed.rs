//! Speeds as they are programmed: feed, lead, spindle speed, dwell.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::Length;

/// Path speed in nanometres per minute (G98), never negative.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    Schema,
)]
pub struct Feed(i64);

impl Feed {
    /// `nm` nanometres per minute.
    #[must_use]
    pub const fn from_nm_per_min(nm: i64) -> Self {
        Self(nm)
    }

    /// Nanometres per minute.
    #[must_use]
    pub const fn nm_per_min(self) -> i64 {
        self.0
    }
}

/// Path feed in nanometres per spindle turn (G99).
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    Schema,
)]
pub struct FeedPerTurn(i64);

impl FeedPerTurn {
    /// `nm` nanometres per turn.
    #[must_use]
    pub const fn from_nm(nm: i64) -> Self {
        Self(nm)
    }

    /// Nanometres per turn.
    #[must_use]
    pub const fn nm(self) -> i64 {
        self.0
    }

    /// The feed at a spindle speed (its magnitude).
    #[must_use]
    pub const fn at(self, rpm: Rpm) -> Feed {
        Feed(self.0.saturating_mul(rpm.abs() as i64))
    }
}

/// Lead of a thread: long-axis travel per spindle turn as an exact ratio, `nm / turns` nanometres per turn, both
/// positive and without a common factor. `F` gives `nm/1`; `I` (turns per inch) gives 25 400 000 · 10ᵏ over its digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
#[serde(into = "(i64, i64)", try_from = "(i64, i64)")]
pub struct Lead {
    nm: i64,
    turns: i64,
}

impl Lead {
    /// A nanometre a turn.
    pub const LEAST: Self = Self { nm: 1, turns: 1 };

    /// The ratio in lowest terms; `None` unless both are positive.
    #[must_use]
    pub const fn new(nm: i64, turns: i64) -> Option<Self> {
        if nm <= 0 || turns <= 0 {
            return None;
        }
        let (mut a, mut b) = (nm, turns);
        while b != 0 {
            // b > 0, so the remainder is defined.
            let r = match a.checked_rem(b) {
                Some(r) => r,
                None => 0,
            };
            a = b;
            b = r;
        }
        match (nm.checked_div(a), turns.checked_div(a)) {
            (Some(nm), Some(turns)) => Some(Self { nm, turns }),
            _ => None,
        }
    }

    /// Numerator: nanometres.
    #[must_use]
    pub const fn numerator(self) -> i64 {
        self.nm
    }

    /// Denominator: turns.
    #[must_use]
    pub const fn denominator(self) -> i64 {
        self.turns
    }

    /// Both without a sign: nanometres, turns.
    #[must_use]
    pub const fn parts(self) -> (u64, u64) {
        (self.nm as u64, self.turns as u64)
    }

    /// The lead rounded to the nearest nanometre.
    #[must_use]
    pub const fn rounded(self) -> Length {
        let half = self.turns >> 1;
        match self.nm.saturating_add(half).checked_div(self.turns) {
            Some(nm) => Length::from_nm(nm),
            None => Length::ZERO,
        }
    }
}

impl From<Lead> for (i64, i64) {
    fn from(lead: Lead) -> Self {
        (lead.nm, lead.turns)
    }
}

impl TryFrom<(i64, i64)> for Lead {
    type Error = &'static str;

    fn try_from((nm, turns): (i64, i64)) -> Result<Self, Self::Error> {
        Self::new(nm, turns).ok_or("a lead is a ratio of positive numbers")
    }
}

/// Spindle speed in turns per minute; positive M03, negative M04.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    Schema,
)]
pub struct Rpm(i32);

impl Rpm {
    /// Standing.
    pub const STOPPED: Self = Self(0);

    /// `rpm` turns per minute.
    #[must_use]
    pub const fn new(rpm: i32) -> Self {
        Self(rpm)
    }

    /// Turns per minute, signed.
    #[must_use]
    pub const fn get(self) -> i32 {
        self.0
    }

    /// The magnitude in turns per minute.
    #[must_use]
    pub const fn abs(self) -> u32 {
        self.0.unsigned_abs()
    }
}

/// Spindle speed of a tap in hundredths of a turn per minute, signed like [`Rpm`]: fine enough for a whole speed times a
/// whole percentage.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    Schema,
)]
pub struct CentiRpm(i32);

impl CentiRpm {
    /// `raw` hundredths of a turn per minute.
    #[must_use]
    pub const fn new(raw: i32) -> Self {
        Self(raw)
    }

    /// The same speed.
    #[must_use]
    pub const fn of_rpm(rpm: Rpm) -> Self {
        Self(rpm.0.saturating_mul(100))
    }

    /// Hundredths of a turn per minute, signed.
    #[must_use]
    pub const fn get(self) -> i32 {
        self.0
    }

    /// As fast, the other way round.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

/// A time in milliseconds (G04, dwell at the bottom of a hole).
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    Schema,
)]
pub struct Millis(u32);

impl Millis {
    /// `ms` milliseconds.
    #[must_use]
    pub const fn new(ms: u32) -> Self {
        Self(ms)
    }

    /// Milliseconds.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }
}
