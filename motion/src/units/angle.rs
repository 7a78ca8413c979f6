//! Angles: rotary axes ([`Angle`]), the spindle ([`Turns`]) and the start angle of a thread ([`StartAngle`]).

use core::ops::{Add, AddAssign, Neg, Sub, SubAssign};

use fixed::types::I32F32;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Position of a rotary axis in millionths of a degree (C words; 1 µ° to a degree is what a nanometre is to a
/// millimetre).
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
pub struct Angle(i64);

/// Spindle angle in turns, continuous (never wrapped), positive in the direction of M03.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Turns(I32F32);

macro_rules! saturating_ops {
    ($type:ident) => {
        impl Add for $type {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0.saturating_add(other.0))
            }
        }
        impl Sub for $type {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0.saturating_sub(other.0))
            }
        }
        impl Neg for $type {
            type Output = Self;
            fn neg(self) -> Self {
                Self(self.0.saturating_neg())
            }
        }
        impl AddAssign for $type {
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }
        impl SubAssign for $type {
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
    };
}
saturating_ops!(Angle);
saturating_ops!(Turns);
as_bits!(Turns);

impl Angle {
    /// The zero of the axis.
    pub const ZERO: Self = Self(0);

    /// An angle of `udeg` millionths of a degree.
    #[must_use]
    pub const fn from_udeg(udeg: i64) -> Self {
        Self(udeg)
    }

    /// The angle in millionths of a degree.
    #[must_use]
    pub const fn udeg(self) -> i64 {
        self.0
    }
}

impl Turns {
    /// The index at start-up.
    pub const ZERO: Self = Self(I32F32::ZERO);
    /// One turn.
    pub const ONE: Self = Self(I32F32::ONE);

    /// An angle of `raw` · 2⁻³² turns.
    #[must_use]
    pub const fn from_raw(raw: i64) -> Self {
        Self(I32F32::from_bits(raw))
    }

    /// The angle in 2⁻³² turns.
    #[must_use]
    pub const fn raw(self) -> i64 {
        self.0.to_bits()
    }

    /// Millionths of a turn, rounded to the nearest.
    #[must_use]
    pub const fn micro(self) -> i64 {
        ((self.raw() as i128)
            .wrapping_mul(1_000_000)
            .wrapping_add(1 << 31)
            >> 32) as i64
    }

    /// `n` whole turns.
    #[must_use]
    pub const fn whole(n: i32) -> Self {
        Self(I32F32::const_from_int(n as i64))
    }

    /// The first whole turn above this angle.
    #[must_use]
    pub const fn next_whole(self) -> Self {
        Self(self.0.wrapping_floor().wrapping_add(I32F32::ONE))
    }
}

/// Angle of a thread start after the spindle index, in thousandths of a degree, 0…359 999, counted in the direction
/// the spindle turns.
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
#[serde(from = "u32", into = "u32")]
pub struct StartAngle(u32);

impl From<u32> for StartAngle {
    fn from(mdeg: u32) -> Self {
        Self::from_mdeg(mdeg)
    }
}

impl From<StartAngle> for u32 {
    fn from(angle: StartAngle) -> Self {
        angle.mdeg()
    }
}

impl StartAngle {
    /// A full turn in thousandths of a degree.
    pub const FULL: u32 = 360_000;
    /// At the index.
    pub const INDEX: Self = Self(0);

    /// `mdeg` thousandths of a degree, wrapped into one turn.
    #[must_use]
    pub const fn from_mdeg(mdeg: u32) -> Self {
        Self(mdeg % Self::FULL)
    }

    /// The angle in thousandths of a degree.
    #[must_use]
    pub const fn mdeg(self) -> u32 {
        self.0
    }

    /// The same angle in 2⁻³² turns, rounded to the nearest.
    #[must_use]
    pub const fn turns(self) -> Turns {
        // (mdeg · 2³² + 180 000) / 360 000; mdeg < 360 000 keeps this below 2⁵¹.
        Turns::from_raw((((self.0 as u64) << 32).wrapping_add(180_000) / 360_000) as i64)
    }
}
