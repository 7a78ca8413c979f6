//! Speed along a path ([`PathRate`]), the operator's factor ([`Rate`]) and the distance covered ([`Travel`]).

use fixed::types::{U16F16, U24F8, U48F16};

use crate::units::{Feed, Length};

/// Speed along a path in nanometres (rotary moves: µ°) per tick, up to 16.7 mm per tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PathRate(U24F8);

impl PathRate {
    /// Standing.
    pub const ZERO: Self = Self(U24F8::ZERO);

    /// `raw` · 1/256 nanometre per tick.
    #[must_use]
    pub const fn from_raw(raw: u32) -> Self {
        Self(U24F8::from_bits(raw))
    }

    /// 1/256 nanometres per tick.
    #[must_use]
    pub const fn raw(self) -> u32 {
        self.0.to_bits()
    }

    /// `feed` at a tick of `tick_us` microseconds, rounded to the nearest; saturates at the range of the type. Negative
    /// feeds count as zero.
    #[inline(never)]
    #[must_use]
    pub const fn of_feed(feed: Feed, tick_us: u32) -> Self {
        let nm = if feed.nm_per_min() < 0 {
            0
        } else {
            feed.nm_per_min() as u64
        };
        // nm/min · µs · 256 / (60 · 10⁶ µs/min). Values that saturate here are far beyond the type's range.
        let scaled = nm
            .saturating_mul(tick_us as u64)
            .saturating_mul(256)
            .saturating_add(30_000_000)
            / 60_000_000;
        if scaled > u32::MAX as u64 {
            Self(U24F8::MAX)
        } else {
            Self::from_raw(scaled as u32)
        }
    }

    /// The speed as a feed at a tick of `tick_us` microseconds, rounded down.
    #[must_use]
    pub const fn feed(self, tick_us: u32) -> Feed {
        let nm = (self.raw() as u64)
            .saturating_mul(60_000_000 / 256)
            .checked_div(tick_us as u64);
        Feed::from_nm_per_min(match nm {
            Some(nm) => nm as i64,
            None => 0,
        })
    }
}

/// The factor that operator and spindle apply to a programmed speed: from 0 (hold) to 2, in steps of 2⁻¹⁶.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Rate(U16F16);

impl Rate {
    /// Feed hold.
    pub const HOLD: Self = Self(U16F16::ZERO);
    /// As programmed.
    pub const FULL: Self = Self(U16F16::ONE);
    /// The largest factor.
    pub const MAX: Self = Self(U16F16::const_from_int(2));

    /// `raw` · 2⁻¹⁶, at most [`Rate::MAX`].
    #[must_use]
    pub const fn from_raw(raw: u32) -> Self {
        if raw > Self::MAX.raw() {
            Self::MAX
        } else {
            Self(U16F16::from_bits(raw))
        }
    }

    /// The factor in 2⁻¹⁶.
    #[must_use]
    pub const fn raw(self) -> u32 {
        self.0.to_bits()
    }

    /// `percent` per cent, at most 200.
    #[must_use]
    pub const fn percent(percent: u8) -> Self {
        Self::from_raw(U16F16::const_from_int(percent as u32).to_bits() / 100)
    }

    /// The factor by which `whole` becomes `part`, or a little less; at most [`Rate::FULL`]. Nothing is no part.
    #[must_use]
    pub const fn share(part: PathRate, whole: PathRate) -> Self {
        let (part, whole) = (part.raw(), whole.raw());
        if part == 0 {
            return Self::HOLD;
        }
        if part >= whole {
            return Self::FULL;
        }
        // Both in 17 bits at most; the part is rounded down, the whole up.
        let shift = 16_u32.saturating_sub(whole.leading_zeros());
        let (part, whole) = (part >> shift, whole.div_ceil(1 << shift));
        match (part << 16).checked_div(whole) {
            Some(share) => Self::from_raw(share),
            None => Self::HOLD,
        }
    }

    /// The product of both factors, at most [`Rate::MAX`].
    #[must_use]
    pub const fn times(self, other: Self) -> Self {
        // Both are at most 2.
        Self::from_raw(self.0.wrapping_mul(other.0).to_bits())
    }

    /// `speed` times this factor, saturating.
    #[must_use]
    pub fn of(self, speed: PathRate) -> PathRate {
        PathRate(self.0.wide_mul(speed.0).saturating_to_num())
    }
}

/// Distance covered along a path in nanometres (rotary moves: µ°); up to 2⁴⁴ nm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Travel(U48F16);

impl Travel {
    /// The start.
    pub const ZERO: Self = Self(U48F16::ZERO);

    /// `raw` · 2⁻¹⁶ nanometre.
    #[must_use]
    pub const fn from_raw(raw: u64) -> Self {
        Self(U48F16::from_bits(raw))
    }

    /// 2⁻¹⁶ nanometres.
    #[must_use]
    pub const fn raw(self) -> u64 {
        self.0.to_bits()
    }

    /// `length` from the start; negative lengths count as zero.
    #[must_use]
    pub fn of(length: Length) -> Self {
        Self(U48F16::wrapping_from_num(length.nm().max(0)))
    }

    /// The part of this distance beyond `other`, at least zero.
    #[must_use]
    pub const fn beyond(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// This and `more` together.
    #[must_use]
    pub const fn and(self, more: Self) -> Self {
        Self(self.0.saturating_add(more.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feeds_convert_both_ways() {
        // 60 mm/min = 1 mm/s = 1000 nm in 1 ms.
        let rate = PathRate::of_feed(Feed::from_nm_per_min(60_000_000), 1_000);
        assert_eq!(rate, PathRate::from_raw(256_000));
        assert_eq!(rate.feed(1_000), Feed::from_nm_per_min(60_000_000));
        assert_eq!(
            PathRate::of_feed(Feed::from_nm_per_min(i64::MAX), 1_000).raw(),
            u32::MAX
        );
        assert_eq!(PathRate::of_feed(Feed::from_nm_per_min(-1), 1_000).raw(), 0);
    }

    #[test]
    fn rates_multiply_and_stop_at_two() {
        assert_eq!(Rate::percent(100), Rate::FULL);
        assert_eq!(Rate::percent(150).times(Rate::percent(150)), Rate::MAX);
        assert_eq!(
            Rate::percent(50).times(Rate::percent(50)),
            Rate::percent(25)
        );
        for (part, whole, raw) in [
            (0, 1_000, 0),
            (1, 4, 16_384),
            (1_000, 1_000, 65_536),
            (2_000, 1_000, 65_536),
            (0, 0, 0),
            (1 << 30, 1 << 31, 32_768),
            (u32::MAX - 1, u32::MAX, 65_535),
            (0x1_0001, 0x2_0003, 32_767),
            (1, u32::MAX, 0),
        ] {
            let share = Rate::share(PathRate::from_raw(part), PathRate::from_raw(whole));
            assert_eq!(share.raw(), raw, "{part} of {whole}");
        }
        let speed = PathRate::from_raw(1_001);
        assert_eq!(Rate::FULL.of(speed), speed);
        assert_eq!(Rate::HOLD.of(speed), PathRate::ZERO);
        assert_eq!(Rate::MAX.of(PathRate::from_raw(u32::MAX)).raw(), u32::MAX);
    }
}
