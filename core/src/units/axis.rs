//! Axes and what limits them.

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
