//! Axes and what limits them.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// An axis of the lathe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// Cross slide; internally on the radius.
    X,
    /// Carriage.
    Z,
    /// Spindle or work head as a rotary axis.
    C,
}

impl Axis {
    /// All axes in the order of every table and record.
    pub const ALL: [Self; 3] = [Self::X, Self::Z, Self::C];

    /// The address letter.
    #[must_use]
    pub const fn letter(self) -> u8 {
        match self {
            Self::X => b'X',
            Self::Z => b'Z',
            Self::C => b'C',
        }
    }
}

/// A set of axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub struct Axes(u8);

impl Axes {
    /// No axis.
    pub const NONE: Self = Self(0);
    /// All axes.
    pub const ALL: Self = Self(0b111);

    /// The axes of these bits: X 1, Z 2, C 4. `None` where there are others.
    #[must_use]
    pub const fn from_bits(bits: u8) -> Option<Self> {
        match bits {
            0..=0b111 => Some(Self(bits)),
            _ => None,
        }
    }

    /// Its bits: X 1, Z 2, C 4.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    const fn bit(axis: Axis) -> u8 {
        match axis {
            Axis::X => 1,
            Axis::Z => 2,
            Axis::C => 4,
        }
    }

    /// True where `axis` is one of them.
    #[must_use]
    pub const fn contains(self, axis: Axis) -> bool {
        self.0 & Self::bit(axis) != 0
    }

    /// True where there are none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// These, and `axis`.
    #[must_use]
    pub const fn with(self, axis: Axis) -> Self {
        Self(self.0 | Self::bit(axis))
    }

    /// These, but not `axis`.
    #[must_use]
    pub const fn without(self, axis: Axis) -> Self {
        Self(self.0 & !Self::bit(axis))
    }

    /// These, but none of `others`.
    #[must_use]
    pub const fn minus(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }

    /// Those that are in both.
    #[must_use]
    pub const fn and(self, others: Self) -> Self {
        Self(self.0 & others.0)
    }

    /// These, and `others`.
    #[must_use]
    pub const fn or(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    /// These, in the order of [`Axis::ALL`].
    pub fn each(self) -> impl Iterator<Item = Axis> {
        Axis::ALL
            .into_iter()
            .filter(move |axis| self.contains(*axis))
    }
}

/// Acceleration in nanometres (rotary: µ°) per second squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Acceleration(i64);

impl Acceleration {
    /// `nm` nanometres per second squared.
    #[must_use]
    pub const fn from_nm_per_s2(nm: i64) -> Self {
        Self(nm)
    }

    /// Nanometres per second squared.
    #[must_use]
    pub const fn nm_per_s2(self) -> i64 {
        self.0
    }
}

/// Jerk in nanometres (rotary: µ°) per second cubed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Jerk(i64);

impl Jerk {
    /// `nm` nanometres per second cubed.
    #[must_use]
    pub const fn from_nm_per_s3(nm: i64) -> Self {
        Self(nm)
    }

    /// Nanometres per second cubed.
    #[must_use]
    pub const fn nm_per_s3(self) -> i64 {
        self.0
    }
}
