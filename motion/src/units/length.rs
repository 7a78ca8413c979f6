//! Lengths on the radius and along Z ([`Length`]), and X words as they are written ([`Diameter`]).

use core::ops::{Add, AddAssign, Neg, Sub, SubAssign};

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A length or a coordinate in nanometres: Z, a radius, a depth.
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
pub struct Length(i64);

impl Length {
    /// No length.
    pub const ZERO: Self = Self(0);
    /// The largest magnitude a position or a distance may have where it enters the core: 2⁴² nm, about 4.4 km.
    pub const INPUT_LIMIT: Self = Self(1 << 42);

    /// A length of `nm` nanometres.
    #[must_use]
    pub const fn from_nm(nm: i64) -> Self {
        Self(nm)
    }

    /// The length in nanometres.
    #[must_use]
    pub const fn nm(self) -> i64 {
        self.0
    }

    /// The magnitude.
    #[must_use]
    pub const fn abs(self) -> Self {
        Self(self.0.saturating_abs())
    }

    /// −1, 0 or +1.
    #[must_use]
    pub const fn signum(self) -> i64 {
        self.0.signum()
    }

    /// `self` times a small whole number.
    #[must_use]
    pub const fn times(self, n: i64) -> Self {
        Self(self.0.saturating_mul(n))
    }

    /// True where the magnitude is within [`Length::INPUT_LIMIT`].
    #[must_use]
    pub const fn is_in_range(self) -> bool {
        self.0.saturating_abs() <= Self::INPUT_LIMIT.0
    }
}

/// The remainder of rounding a computed length to nanometres: 2⁻¹⁵ nm, −½ nm … +½ nm. Two computed lengths that make one
/// coordinate keep it, so that the coordinate is rounded once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub struct Remainder(i16);

impl Remainder {
    /// Fractional bits.
    pub const BITS: u32 = 15;
    /// Nothing: the length is exact.
    pub const ZERO: Self = Self(0);

    /// A remainder of `raw` · 2⁻¹⁵ nm.
    #[must_use]
    pub const fn from_raw(raw: i16) -> Self {
        Self(raw)
    }

    /// `length`, within [`Length::INPUT_LIMIT`], with this remainder, in 2⁻¹⁵ nm.
    #[must_use]
    pub const fn behind(self, length: Length) -> i64 {
        (length.0 << Self::BITS).wrapping_add(self.0 as i64)
    }
}

impl Add for Length {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Length {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Length {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

impl AddAssign for Length {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Length {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// An X coordinate or distance as programmed: a diameter, in nanometres. Even for every input increment, so that its
/// [`radius`](Diameter::radius) is exact.
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
pub struct Diameter(i64);

impl Diameter {
    /// A diameter of `nm` nanometres.
    #[must_use]
    pub const fn from_nm(nm: i64) -> Self {
        Self(nm)
    }

    /// The diameter in nanometres.
    #[must_use]
    pub const fn nm(self) -> i64 {
        self.0
    }

    /// The diameter whose half is `radius`.
    #[must_use]
    pub const fn of_radius(radius: Length) -> Self {
        Self(radius.0.saturating_mul(2))
    }

    /// Half of the diameter. Exact for every programmable value; a stray odd nanometre is dropped towards zero.
    #[must_use]
    pub const fn radius(self) -> Length {
        Length(self.0 / 2)
    }
}
