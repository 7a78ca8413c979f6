//! Speed along a path ([`PathRate`]), the operator's factor ([`Rate`]) and the distance covered ([`Travel`]).

use crate::units::{Feed, Length};

/// Speed along a path in 1/256 nanometre (rotary moves: µ°) per tick, up to 16.7 mm per tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PathRate(u32);

impl PathRate {
    /// Standing.
    pub const ZERO: Self = Self(0);

    /// `raw` · 1/256 nanometre per tick.
    #[must_use]
    pub const fn from_raw(raw: u32) -> Self {
        Self(raw)
    }

    /// 1/256 nanometres per tick.
    #[must_use]
    pub const fn raw(self) -> u32 {
        self.0
    }

    /// `feed` at a tick of `tick_us` microseconds, rounded to the nearest; saturates at the range of the type. Negative
    /// feeds count as zero.
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
            Self(u32::MAX)
        } else {
            Self(scaled as u32)
        }
    }

    /// The speed as a feed at a tick of `tick_us` microseconds, rounded down.
    #[must_use]
    pub const fn feed(self, tick_us: u32) -> Feed {
        let nm = (self.0 as u64)
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
pub struct Rate(u32);

impl Rate {
    /// Feed hold.
    pub const HOLD: Self = Self(0);
    /// The speed as programmed.
    pub const FULL: Self = Self(1 << 16);
    /// The largest factor.
    pub const MAX: Self = Self(2 << 16);

    /// `raw` · 2⁻¹⁶, at most [`Rate::MAX`].
    #[must_use]
    pub const fn from_raw(raw: u32) -> Self {
        if raw > Self::MAX.0 {
            Self::MAX
        } else {
            Self(raw)
        }
    }

    /// The factor in 2⁻¹⁶.
    #[must_use]
    pub const fn raw(self) -> u32 {
        self.0
    }

    /// `percent` per cent, at most 200.
    #[must_use]
    pub const fn percent(percent: u8) -> Self {
        Self::from_raw((percent as u32).wrapping_mul(1 << 16) / 100)
    }

    /// The product of both factors, at most [`Rate::MAX`].
    #[must_use]
    pub const fn times(self, other: Self) -> Self {
        // Both factors are at most 2¹⁷.
        Self::from_raw(((self.0 as u64).wrapping_mul(other.0 as u64) >> 16) as u32)
    }

    /// `speed` times this factor, saturating.
    #[must_use]
    pub const fn of(self, speed: PathRate) -> PathRate {
        let scaled = (self.0 as u64).wrapping_mul(speed.0 as u64) >> 16;
        PathRate(if scaled > u32::MAX as u64 {
            u32::MAX
        } else {
            scaled as u32
        })
    }
}

/// Distance covered along a path in 2⁻¹⁶ nanometre (rotary moves: µ°); up to 2⁴⁴ nm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Travel(u64);

impl Travel {
    /// The start.
    pub const ZERO: Self = Self(0);

    /// `raw` · 2⁻¹⁶ nanometre.
    #[must_use]
    pub const fn from_raw(raw: u64) -> Self {
        Self(raw)
    }

    /// 2⁻¹⁶ nanometres.
    #[must_use]
    pub const fn raw(self) -> u64 {
        self.0
    }

    /// `length` from the start; negative lengths count as zero.
    #[must_use]
    pub const fn of(length: Length) -> Self {
        Self(if length.nm() < 0 {
            0
        } else {
            (length.nm() as u64) << 16
        })
    }

    /// The part of this distance beyond `other`, at least zero.
    #[must_use]
    pub const fn beyond(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
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
        let speed = PathRate::from_raw(1_001);
        assert_eq!(Rate::FULL.of(speed), speed);
        assert_eq!(Rate::HOLD.of(speed), PathRate::ZERO);
        assert_eq!(Rate::MAX.of(PathRate::from_raw(u32::MAX)).raw(), u32::MAX);
    }
}
