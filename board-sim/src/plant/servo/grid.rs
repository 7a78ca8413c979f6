//! Places in nanometres, and counts of so many nanometres each.

use super::FARTHEST;

/// The ratio of counts to nanometres, both ways.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// Counts in a nanometre, in 2⁻⁵⁶.
    per_nm: i128,
    /// Nanometres of a count, in 2⁻⁴⁸.
    nm: i128,
}

impl Grid {
    /// `counts` in so many nanometres; `None` where either is 0.
    pub(super) fn new(counts: u32, nm: u32) -> Option<Self> {
        let (counts, nm) = (i128::from(counts), i128::from(nm));
        if counts == 0 {
            return None;
        }
        Some(Self {
            per_nm: counts.wrapping_shl(56).checked_div(nm)?,
            nm: nm.wrapping_shl(48).checked_div(counts)?,
        })
    }

    /// The place of a count, in 2⁻¹⁶ nanometres.
    pub(super) fn place(&self, count: i64) -> i64 {
        let fine = super::rounded(i128::from(count).saturating_mul(self.nm), 32);
        super::within(fine, FARTHEST)
    }

    /// The count nearest to a place.
    pub(super) fn nearest(&self, place: i64) -> i64 {
        super::rounded(i128::from(place).saturating_mul(self.per_nm), 72) as i64
    }

    /// The place of the last whole count that is not behind this place.
    pub(super) fn seen(&self, place: i64) -> i64 {
        /// 2⁻¹² of a count: more than the rounding of ratios, so that a place of a whole count is seen as this count.
        const SLACK: i128 = 1 << 60;
        let fine = i128::from(place).saturating_mul(self.per_nm);
        self.place((fine.saturating_add(SLACK) >> 72) as i64)
    }
}
