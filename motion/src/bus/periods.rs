//! Time on the bus, in SYNC periods.

/// A time in SYNC periods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Periods(u32);

impl Periods {
    /// `count` SYNC periods.
    #[must_use]
    pub const fn new(count: u32) -> Self {
        Self(count)
    }

    /// `ms` milliseconds at a SYNC period of `tick_us` microseconds, rounded up; `None` for a period of 0.
    #[inline(never)]
    #[must_use]
    pub const fn from_ms(ms: u32, tick_us: u32) -> Option<Self> {
        let rounded_up = (ms as u64)
            .wrapping_mul(1000)
            .wrapping_add((tick_us as u64).saturating_sub(1));
        match rounded_up.checked_div(tick_us as u64) {
            Some(ticks) if ticks <= u32::MAX as u64 => Some(Self(ticks as u32)),
            Some(_) => Some(Self(u32::MAX)),
            None => None,
        }
    }

    /// The number of SYNC periods.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }

    /// The sum with `more`; saturates.
    #[must_use]
    pub const fn plus(self, more: Self) -> Self {
        Self(self.0.saturating_add(more.0))
    }

    /// The difference to `less`, not below 0.
    pub const fn minus(self, less: Self) -> Self {
        Self(self.0.saturating_sub(less.0))
    }

    /// One period more; saturates.
    pub(super) const fn one_more(self) -> Self {
        Self(self.0.saturating_add(1))
    }
}
