//! Turns of a geared spindle, exactly ([`TurnRatio`]).

use super::wide::narrow_div;
use super::{Lead, Length};

/// Signed spindle turns as an exact ratio; the denominator is positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TurnRatio {
    numerator: i64,
    denominator: i64,
}

impl TurnRatio {
    /// The turns of a travel at a lead, with the sign of the travel. Exact for every length within
    /// [`Length::INPUT_LIMIT`] and every denominator below 2²⁰.
    #[must_use]
    pub const fn of_travel(travel: Length, lead: Lead) -> Self {
        Self {
            numerator: travel.nm().saturating_mul(lead.denominator()),
            denominator: lead.numerator(),
        }
    }

    /// As many turns the other way round.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self {
            numerator: self.numerator.saturating_neg(),
            denominator: self.denominator,
        }
    }

    /// Numerator, signed: turns times [`denominator`](Self::denominator).
    #[must_use]
    pub const fn numerator(self) -> i64 {
        self.numerator
    }

    /// Denominator, positive.
    #[must_use]
    pub const fn denominator(self) -> i64 {
        self.denominator
    }

    /// Millionths of a turn, rounded to the nearest, ties away from zero.
    #[must_use]
    pub const fn micro(self) -> i64 {
        let whole = self.numerator.checked_div(self.denominator);
        let rest = self.numerator.checked_rem(self.denominator);
        let (Some(whole), Some(rest)) = (whole, rest) else {
            return 0;
        };
        // |rest| is below the denominator, itself below 2⁵⁰ for every lead that F can give: the product needs 128 bits.
        let twice = (rest.unsigned_abs() as u128).wrapping_mul(2_000_000);
        let denominator = self.denominator.unsigned_abs();
        let part = narrow_div(
            twice.wrapping_add(denominator as u128),
            denominator.wrapping_mul(2),
        ) as i64;
        let part = if self.numerator < 0 {
            part.saturating_neg()
        } else {
            part
        };
        whole.saturating_mul(1_000_000).saturating_add(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheets_hole_has_twenty_five_turns() {
        // 50 mm at F2000 S1000.
        let lead = Lead::new(2_000_000_000, 1000).unwrap();
        let turns = TurnRatio::of_travel(Length::from_nm(50_000_000), lead);
        assert_eq!(turns.numerator(), turns.denominator() * 25);
        assert_eq!(turns.micro(), 25_000_000);
        assert_eq!(turns.reversed().micro(), -25_000_000);
    }

    #[test]
    fn a_lead_that_does_not_end_stays_exact() {
        // F1000 at S3: 333.3… mm a turn.
        let lead = Lead::new(1_000_000_000, 3).unwrap();
        let turns = TurnRatio::of_travel(Length::from_nm(-1_000_000), lead);
        assert_eq!(
            (turns.numerator(), turns.denominator()),
            (-3_000_000, 1_000_000_000)
        );
        assert_eq!(turns.micro(), -3_000);
        let tie = TurnRatio::of_travel(Length::from_nm(-1), Lead::new(2_000_000, 1).unwrap());
        assert_eq!(tie.micro(), -1);
    }
}
