//! Converts travel and spindle speed by a lead, for planning. Results are rounded up, with divisions of 128 bits.

use super::ease::Fine;
use super::wide::mul_div_up;
use crate::units::{Lead, Length, Turns};

/// The spindle's angle for a travel. It is limited to a quarter of the range, so that a sum of two does not overflow.
#[inline(never)]
pub(super) fn turns_of(lead: Lead, travel: Fine) -> Turns {
    let (nm, turns) = lead.parts();
    let travel = travel.max(0).unsigned_abs();
    let scaled = mul_div_up(travel, turns.saturating_mul(1 << 16), nm);
    Turns::from_raw(scaled.min(1 << 61) as i64)
}

/// The spindle's angle for a whole length.
#[must_use]
pub fn turns_over(lead: Lead, length: Length) -> Turns {
    turns_of(lead, length.nm().saturating_mul(1 << 16))
}

/// The travel for an angle, in 2⁻¹⁶ nm.
#[inline(never)]
pub(super) fn travel_of(lead: Lead, angle: Turns) -> Fine {
    let (nm, turns) = lead.parts();
    let raw = angle.raw().max(0).unsigned_abs();
    // In 2⁻²⁴ turns: up to 2⁴⁰ turns and a metre for each.
    let scaled = mul_div_up(raw >> 8, nm, turns);
    (scaled >> 8).min(1 << 61) as i64
}

/// Nanometres per second (or per second²) at 2⁻³² turns per second (second²).
#[inline(never)]
pub(super) fn speed_of(lead: Lead, rate: u64) -> u64 {
    let (nm, turns) = lead.parts();
    mul_div_up(mul_div_up(nm, 1 << 16, turns), rate, 1 << 48)
}
