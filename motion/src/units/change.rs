//! A lead that changes from turn to turn ([`LeadChange`]).

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::{Lead, Length, div_wide, narrow_div, root_wide};

/// By how much a lead changes in each turn, in picometres: positive where it grows. A picometre divides every metric and
/// inch increment of K.
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
pub struct LeadChange(i64);

/// Leads behind a changing one are in 2⁻¹⁶ nm.
const PARTS: i64 = 1 << 16;

impl LeadChange {
    /// A constant lead.
    pub const NONE: Self = Self(0);
    /// The largest change, either way: 500 mm a turn.
    pub const LIMIT: Self = Self(500_000_000_000);

    /// The longest stroke with a changing lead, 10 m: up to it the law of its travel is monotonic.
    pub const REACH: Length = Length::from_nm(10_000_000_000);

    /// `pm` picometres a turn.
    #[must_use]
    pub const fn from_pm(pm: i64) -> Self {
        Self(pm)
    }

    /// Picometres a turn.
    #[must_use]
    pub const fn pm(self) -> i64 {
        self.0
    }

    /// The change rounded to the nearest nanometre.
    #[must_use]
    pub const fn rounded(self) -> Length {
        let half = if self.0 < 0 { -500 } else { 500 };
        match self.0.saturating_add(half).checked_div(1000) {
            Some(nm) => Length::from_nm(nm),
            None => Length::ZERO,
        }
    }

    /// The lead that `lead` has become after `way`, rounded down to 2⁻¹⁶ nm: `√(F² + 2·K·way)`. `None` where it is used
    /// up before. Exact leads up to 500 mm, ways up to 10 m: beyond that the result saturates.
    #[must_use]
    pub fn after(self, lead: Lead, way: Length) -> Option<Lead> {
        if self == Self::NONE {
            return Some(lead);
        }
        let square = self.square_after(lead, way)?;
        let parts = root_wide(square).min(i64::MAX as u64);
        Lead::new(parts as i64, PARTS)
    }

    /// F² + 2·K·way in 2⁻³² nm²; `None` where it is not positive.
    fn square_after(self, lead: Lead, way: Length) -> Option<u128> {
        let (nm, turns) = lead.parts();
        // Below 2⁴⁶ for leads below 2³⁰ nm.
        let first = u128::from(narrow_div(u128::from(nm) << 16, turns));
        let before = first.saturating_mul(first);
        // 2·K·way: picometres times nanometres, in 2⁻³² nm².
        let product =
            u128::from(self.0.unsigned_abs()).saturating_mul(u128::from(way.nm().unsigned_abs()));
        let by = div_wide(product.saturating_mul(1 << 32), 500);
        let square = if self.0 < 0 {
            before.checked_sub(by)?
        } else {
            before.saturating_add(by)
        };
        (square > 0).then_some(square)
    }

    /// The way after which a lead that becomes shorter is used up: `F²/(2·|K|)`.
    #[must_use]
    pub fn used_up_after(self, lead: Lead) -> Length {
        let (nm, turns) = lead.parts();
        let first = narrow_div(u128::from(nm) << 16, turns);
        let square = u128::from(first).saturating_mul(u128::from(first));
        let way = narrow_div(square.saturating_mul(500) >> 32, self.0.unsigned_abs());
        Length::from_nm(way.min(i64::MAX as u64) as i64)
    }
}

#[cfg(test)]
#[allow(clippy::float_arithmetic)]
mod tests {
    use super::*;

    fn lead(nm: i64) -> Lead {
        Lead::new(nm, 1).unwrap()
    }

    #[test]
    fn the_lead_at_the_end_is_the_root() {
        let mm = |mm: i64| Length::from_nm(mm * 1_000_000);
        let grows = LeadChange::from_pm(100_000_000);
        let end = grows.after(lead(2_000_000), mm(22)).unwrap();
        assert_eq!(end.rounded(), Length::from_nm(2_898_275));
        // √(4 + 2·0.1·22.5) would be whole: 2.9154…; √(4 + 5) is.
        assert_eq!(grows.after(lead(2_000_000), mm(25)), Some(lead(3_000_000)));
        assert_eq!(
            LeadChange::NONE.after(lead(7), mm(25)),
            Some(lead(7)),
            "a constant lead stays exact"
        );
        let falls = LeadChange::from_pm(-100_000_000);
        assert_eq!(falls.after(lead(3_000_000), mm(25)), Some(lead(2_000_000)));
        assert_eq!(falls.after(lead(2_000_000), mm(20)), None);
        assert_eq!(falls.after(lead(2_000_000), mm(21)), None);
        assert!(
            falls
                .after(lead(2_000_000), Length::from_nm(19_999_999))
                .is_some()
        );
        assert_eq!(falls.used_up_after(lead(2_000_000)), mm(20));
    }

    #[test]
    fn nothing_overflows() {
        let longest = lead(i64::MAX);
        let way = Length::from_nm(i64::MAX);
        for change in [
            LeadChange::LIMIT,
            LeadChange::from_pm(i64::MIN),
            LeadChange::from_pm(1),
        ] {
            let _ = change.after(longest, way);
            let _ = change.used_up_after(longest);
            let _ = change.rounded();
        }
    }
}
