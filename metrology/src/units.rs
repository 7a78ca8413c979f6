//! Quantities, each with its unit in the type. They are floating point: a measurement is no setpoint.

use std::ops::{Add, Mul, Neg, Sub};

macro_rules! quantity {
    ($(#[$about:meta] $name:ident)*) => {$(
        #[$about]
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $name(pub f64);

        impl Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }

        impl Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }

        impl Neg for $name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Mul<f64> for $name {
            type Output = Self;
            fn mul(self, factor: f64) -> Self {
                Self(self.0 * factor)
            }
        }
    )*};
}

quantity! {
    /// Millimetres.
    Mm
    /// Turns of the spindle.
    Turns
    /// Degrees of a plane angle.
    Degrees
    /// Cubic millimetres.
    Cubic
}

impl Mm {
    /// Inches as millimetres.
    #[must_use]
    pub fn from_inch(inches: f64) -> Self {
        Self(inches * 25.4)
    }

    /// Micrometres as millimetres.
    #[must_use]
    pub fn from_um(um: f64) -> Self {
        Self(um / 1000.0)
    }

    /// In micrometres.
    #[must_use]
    pub fn um(self) -> f64 {
        self.0 * 1000.0
    }
}

/// Which surface of the part is worked on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The outer one: a bolt.
    External,
    /// The inner one: a nut.
    Internal,
}

impl Side {
    /// Height of a radius: `u` of this crate; and the radius of a height.
    #[must_use]
    pub fn height(self, radius: f64) -> f64 {
        match self {
            Self::External => radius,
            Self::Internal => -radius,
        }
    }
}
