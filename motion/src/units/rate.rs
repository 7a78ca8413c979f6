//! The speed of the spindle ([`TurnRate`]), and a span of ticks with a fraction ([`Ticks`]).

use fixed::types::{I32F32, U16F16};

use super::Rpm;

/// Speed of the spindle in turns per second, positive in the direction of M03.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TurnRate(I32F32);

as_bits!(TurnRate);

impl TurnRate {
    /// Standing.
    pub const ZERO: Self = Self(I32F32::ZERO);

    /// A speed of `raw` · 2⁻³² turns per second.
    #[must_use]
    pub const fn from_raw(raw: i64) -> Self {
        Self(I32F32::from_bits(raw))
    }

    /// The speed in 2⁻³² turns per second.
    #[must_use]
    pub const fn raw(self) -> i64 {
        self.0.to_bits()
    }

    /// The speed of `rpm` turns per minute, rounded towards zero (by less than 2⁻³² turns per second).
    #[must_use]
    pub const fn of_rpm(rpm: Rpm) -> Self {
        Self::from_raw(I32F32::const_from_int(rpm.get() as i64).to_bits() / 60)
    }

    /// Whole turns per minute, rounded to the nearest.
    #[must_use]
    pub const fn rpm(self) -> Rpm {
        // 60 · 2¹⁶ keeps the product inside 64 bits for every speed below 2⁴¹ turns per second.
        let scaled = (self.raw() >> 16).saturating_mul(60);
        Rpm::new((scaled.saturating_add(1 << 15) >> 16) as i32)
    }

    /// The magnitude.
    #[must_use]
    pub const fn abs(self) -> Self {
        Self(self.0.saturating_abs())
    }

    /// True for M04's direction.
    #[must_use]
    pub const fn is_negative(self) -> bool {
        self.0.is_negative()
    }
}

/// A span of time in ticks, never negative, below 65 536 ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Ticks(U16F16);

impl Ticks {
    /// The next tick.
    pub const ONE: Self = Self(U16F16::ONE);

    /// `whole` ticks.
    #[must_use]
    pub const fn whole(whole: u16) -> Self {
        Self(U16F16::const_from_int(whole as u32))
    }

    /// One tick plus a latency of `us` microseconds, where a tick is `tick_us` long: how far ahead of the sample a
    /// setpoint takes effect. A tick of no length counts as one tick in all.
    #[inline(never)]
    #[must_use]
    pub const fn one_and(us: u32, tick_us: u32) -> Self {
        match ((us as u64) << 16).checked_div(tick_us as u64) {
            Some(extra) if extra < (1 << 31) => {
                Self(U16F16::from_bits(extra as u32).saturating_add(U16F16::ONE))
            }
            _ => Self::ONE,
        }
    }

    /// A tick less than this, but not less than nothing.
    #[must_use]
    pub const fn less_one(self) -> Self {
        Self(self.0.saturating_sub(U16F16::ONE))
    }

    /// As long as both, 65 535 ticks and a fraction at most.
    #[must_use]
    pub const fn and(self, more: Self) -> Self {
        Self(self.0.saturating_add(more.0))
    }

    /// The span in 2⁻¹⁶ ticks.
    #[must_use]
    pub const fn raw(self) -> u32 {
        self.0.to_bits()
    }
}
