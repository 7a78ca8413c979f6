//! The travel of a helix whose lead changes from turn to turn: `q = F·t + K·t²/2` over the stroke, `t` in turns from its
//! start.
//!
//! Before the start the lead is F, and behind the end it is the lead of the end: there the axis joins and brakes, and a
//! lead that went on changing could reach zero. Evaluated as `(F + K/2·t)·t`, in whole numbers: the mean lead with 62
//! bits, `t` with 63, and the high half of two products, each factor rounded down.
//!
//! Up to [`LeadChange::REACH`] the travel never falls while `t` grows, also where K is negative: a step of the mean lead
//! over the whole stroke is worth less than the smallest step of `t`. With leads from 0.0001 mm on, the turns times the
//! largest lead over the smallest stay below 2²⁹, and the bits of the mean lead leave room for that.
//!
//! This module knows no pass and no limits of axes.

use crate::motion::ease::Fine;
use crate::units::{Lead, LeadChange, Length, Turns, mul_high, narrow_div};

/// The changing part of a helix. The default is none: a constant lead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::motion) struct VariableTravel {
    /// F, and the lead at the end.
    first: u64,
    last: u64,
    /// |K|/2, so that its high product with a shifted `t` counts as the leads do.
    half_change: u64,
    /// Turns of the stroke, and the travel there.
    turns: Turns,
    end: Fine,
    inside: Scale,
    outside: Scale,
    falls: bool,
}

/// How an angle and a lead are multiplied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Scale {
    /// Shift of the angle, and of the product down to 2⁻¹⁶ nm.
    up: u32,
    down: u32,
}

impl Scale {
    /// For angles up to `reach`, which then fill 63 bits, and leads with `bits` behind the nanometre.
    fn of(reach: Turns, bits: u32) -> Option<Self> {
        let reach = reach.raw().max(1).unsigned_abs();
        let up = reach.leading_zeros().checked_sub(1)?;
        // bits + 32 + up behind the point, less the lower half of the product; 16 remain.
        let down = bits.wrapping_add(up).checked_sub(48)?;
        Some(Self { up, down })
    }

    /// `lead` times an angle.
    fn times(self, lead: u64, raw: u64) -> Fine {
        (mul_high(lead, raw.wrapping_shl(self.up)) >> self.down) as i64
    }
}

impl VariableTravel {
    /// The law of a stroke of `length` that begins with `lead` and ends with `last`. Its angles reach `before` the start
    /// and `behind` the end. `None` for a constant lead, and for figures that no stroke may have.
    #[inline(never)]
    pub fn new(
        lead: Lead,
        change: LeadChange,
        last: Lead,
        length: Length,
        before: Turns,
        behind: Turns,
    ) -> Option<Self> {
        if change == LeadChange::NONE {
            return None;
        }
        let most = most_turns(lead, last, length)?;
        let largest = whole_up(lead).max(whole_up(last));
        // The largest lead fills 62 bits.
        let bits = largest.leading_zeros().checked_sub(2)?;
        let inside = Scale::of(most, bits)?;
        let outside = before.raw().max(behind.raw());
        let outside = Scale::of(Turns::from_raw(outside), bits)?;
        let (nm, turns) = lead.parts();
        let size = u128::from(change.pm().unsigned_abs());
        let shift = bits.wrapping_add(31).wrapping_sub(inside.up);
        let mut law = Self {
            first: narrow_div(u128::from(nm).checked_shl(bits)?, turns),
            last: 0,
            half_change: narrow_div(size.checked_shl(shift)?, 1000),
            turns: most,
            end: 0,
            inside,
            outside,
            falls: change < LeadChange::NONE,
        };
        law.turns = law.arrives(length.nm().wrapping_shl(16), most);
        law.end = law.within(law.turns.raw());
        law.last = law
            .mean(law.turns.raw())
            .saturating_mul(2)
            .saturating_sub(law.first);
        Some(law)
    }

    /// True for a constant lead.
    pub const fn is_none(&self) -> bool {
        self.first == 0
    }

    /// Turns of the stroke.
    pub const fn turns(&self) -> Turns {
        self.turns
    }

    /// The travel for an angle that counts from the start.
    pub fn at(&self, raw: i64) -> Fine {
        if raw <= 0 {
            self.outside
                .times(self.first, raw.unsigned_abs())
                .wrapping_neg()
        } else if raw <= self.turns.raw() {
            self.within(raw)
        } else {
            let beyond = raw.wrapping_sub(self.turns.raw());
            self.end
                .wrapping_add(self.outside.times(self.last, beyond as u64))
        }
    }

    /// The travel inside the stroke.
    fn within(&self, raw: i64) -> Fine {
        self.inside.times(self.mean(raw), raw as u64)
    }

    /// F + K/2·t.
    fn mean(&self, raw: i64) -> u64 {
        let by = mul_high(self.half_change, (raw as u64).wrapping_shl(self.inside.up));
        if self.falls {
            self.first.saturating_sub(by)
        } else {
            self.first.wrapping_add(by)
        }
    }

    /// The first angle at which the travel is `length`, at most `most`.
    fn arrives(&self, length: Fine, most: Turns) -> Turns {
        let (mut low, mut high) = (0_i64, most.raw());
        while high.wrapping_sub(low) > 1 {
            let middle = low.midpoint(high);
            if self.within(middle) < length {
                low = middle;
            } else {
                high = middle;
            }
        }
        Turns::from_raw(high)
    }
}

/// The turns of a stroke, rounded up: twice the length over both leads.
fn most_turns(first: Lead, last: Lead, length: Length) -> Option<Turns> {
    const FINE: u32 = 16;
    let fine = |lead: Lead| {
        let (nm, turns) = lead.parts();
        narrow_div(u128::from(nm) << FINE, turns)
    };
    let both = fine(first).saturating_add(fine(last));
    let twice = u128::from(length.nm().unsigned_abs()) << (FINE + 33);
    let raw = narrow_div(twice, both);
    // A little more than the rounding of the leads, which are at least 100 nm.
    let raw = raw.saturating_add(raw >> 24).saturating_add(2);
    (raw < 1 << 60).then(|| Turns::from_raw(raw as i64))
}

/// A lead in whole nanometres, more than it is.
fn whole_up(lead: Lead) -> u64 {
    let (nm, turns) = lead.parts();
    nm.checked_div(turns).unwrap_or(0).saturating_add(1)
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::arithmetic_side_effects)]
mod tests {
    extern crate std;

    use super::*;

    /// A law with a turn before and behind the stroke, from figures in millimetres.
    fn law(first: Lead, change: LeadChange, length: Length) -> (VariableTravel, f64, f64, f64) {
        let last = change.after(first, length).unwrap();
        let law = VariableTravel::new(
            first,
            change,
            last,
            length,
            Turns::ONE,
            Turns::from_raw(1 << 45),
        )
        .unwrap();
        let (nm, turns) = first.parts();
        (
            law,
            nm as f64 / turns as f64,
            change.pm() as f64 / 1000.0,
            length.nm() as f64,
        )
    }

    fn mm(first: f64, change: f64, length: f64) -> (VariableTravel, f64, f64, f64) {
        law(
            Lead::new((first * 1e6).round() as i64, 1).unwrap(),
            LeadChange::from_pm((change * 1e9).round() as i64),
            Length::from_nm((length * 1e6).round() as i64),
        )
    }

    fn cases() -> std::vec::Vec<(VariableTravel, f64, f64, f64)> {
        let mut cases = std::vec![
            mm(2.0, 0.1, 22.0),
            mm(2.9, -0.1, 22.0),
            mm(0.0001, 0.000001, 1.0),
            mm(0.01, 5.0, 600.0),
            mm(80.0, -5.0, 639.0),
            mm(500.0, -0.0001, 10_000.0),
            mm(1.0, -0.0005, 999.99),
            mm(20.0, -0.02, 9_999.99),
            mm(6.0, 12.0, 3.0),
        ];
        // Eleven turns to an inch, and a change in inches.
        cases.push(law(
            Lead::new(25_400_000, 11).unwrap(),
            LeadChange::from_pm(25_400 * 317),
            Length::from_nm(75_000_000),
        ));
        cases
    }

    #[test]
    fn the_law_is_that_of_an_independent_evaluation() {
        for (law, first, change, length) in cases() {
            let turns = law.turns.raw() as f64 / 2f64.powi(32);
            // 2·L/(F + √(F² + 2·K·L)): no difference of nearly equal figures.
            let end = (first * first + 2.0 * change * length).sqrt();
            let exact = 2.0 * length / (first + end);
            assert!(
                (turns - exact).abs() * end < 1e-3 + length * 1e-13 + end * 2.4e-10,
                "{first} {change}: {turns} {exact}"
            );
            for n in -64..=4160_i64 {
                let raw = (i128::from(law.turns.raw()) * i128::from(n) / 4096) as i64;
                let raw = raw + n % 7;
                let t = raw as f64 / 2f64.powi(32);
                let want = if t <= 0.0 {
                    first * t
                } else if t <= turns {
                    (first + change * t / 2.0) * t
                } else {
                    length + end * (t - turns)
                };
                let is = law.at(raw) as f64 / 65536.0;
                // Rounding of the law, and of the floats at ten metres; then a setpoint is rounded to a nanometre.
                assert!(
                    (is - want).abs() < 1e-3 + want.abs() * 4e-15 + end * 2.4e-10,
                    "{first} {change} {length} at {n}: {is} {want}"
                );
            }
        }
    }

    #[test]
    fn the_travel_never_falls_and_ends_at_the_length() {
        for (law, first, change, length) in cases() {
            let all = law.turns.raw();
            let mut starts = std::vec![-2000, all - 2000, all / 2, all / 3];
            starts.extend((0..200).map(|n| (i128::from(all) * n / 200) as i64));
            for start in starts {
                let mut before = law.at(start - 1);
                for raw in start..start + 3000 {
                    let at = law.at(raw);
                    assert!(at >= before, "{first} {change} {length}: {raw}");
                    before = at;
                }
            }
            let end = length * 65536.0;
            assert!(law.at(all) as f64 >= end);
            assert!((law.at(all - 1) as f64) < end, "{first} {change} {length}");
            assert_eq!(law.at(0), 0);
        }
    }

    #[test]
    fn the_thread_of_the_worked_figures() {
        let (law, ..) = mm(2.0, 0.1, 22.0);
        let micro = (i128::from(law.turns.raw()) * 1_000_000 + (1 << 31)) >> 32;
        assert_eq!(micro, 8_982_753);
        // The bits of a few setpoints, the same on every target: 2⁻¹⁶ nm at whole turns.
        let at = |turns: i64| law.at(turns << 32);
        let exact = |turns: i64| (turns * 2_000_000 + turns * turns * 50_000) << 16;
        for turns in 0..=8 {
            assert!((exact(turns) - at(turns)).abs() <= 2, "{turns}");
        }
        assert_eq!(at(-1), -2_000_000 << 16);
    }

    #[test]
    fn a_constant_lead_has_no_law() {
        let lead = Lead::new(2_000_000, 1).unwrap();
        let none = VariableTravel::new(
            lead,
            LeadChange::NONE,
            lead,
            Length::from_nm(22_000_000),
            Turns::ONE,
            Turns::ONE,
        );
        assert_eq!(none, None);
        assert!(VariableTravel::default().is_none());
    }
}
