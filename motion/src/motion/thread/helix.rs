//! The helix of a pass: from an angle to a travel.
//!
//! This module knows no pass and no limits of axes.

use super::variable::VariableTravel;
use crate::motion::ease::{Fine, whole};
use crate::units::{Lead, Length, Turns, narrow_div};

/// The exact helix of a pass, as a reference for its setpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Helix {
    pub(super) travel: HelixTravel,
    pub(super) base: Turns,
    pub(super) start: Length,
    pub(super) long_x: bool,
    pub(super) backward: bool,
    pub(super) reverse: bool,
}

impl Helix {
    /// True if X is the long axis.
    #[must_use]
    pub const fn long_x(&self) -> bool {
        self.long_x
    }

    /// Its lead in whole nanometres, negative where the long axis goes down while the angle grows; `None` for a lead that
    /// changes, or of more than 2 m.
    #[must_use]
    pub fn lead_nm(&self) -> Option<i32> {
        if !self.travel.variable.is_none() {
            return None;
        }
        let lead = i32::try_from(self.travel.lead.0).ok()?;
        Some(if self.backward == self.reverse {
            lead
        } else {
            lead.wrapping_neg()
        })
    }

    /// The long axis' position on the helix at a spindle angle.
    #[must_use]
    pub fn at(&self, angle: Turns) -> Length {
        let turned = if self.reverse { -angle } else { angle };
        let way = whole(self.travel.at(turned - self.base));
        if self.backward {
            self.start - way
        } else {
            self.start + way
        }
    }
}

/// Converts an angle into a travel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::motion) struct HelixTravel {
    /// Angles below `low` count as `low`, angles above `high` as `high`: each is one turn outside the pass.
    pub low: Turns,
    pub high: Turns,
    /// Travel per turn: whole nanometres, and the rest in 2⁻³² nm.
    pub lead: (u64, u64),
    /// What a changing lead has instead.
    pub variable: VariableTravel,
}

impl HelixTravel {
    /// The travel of a helix of `lead`. Its angles reach from one turn before `join`, which lies before the start
    /// point, to one turn after `done`. `rounding` is added before the part of the lead below a nanometre is divided by
    /// the lead's denominator and rounded down.
    #[inline(never)]
    pub fn new(lead: Lead, join: Turns, done: Turns, rounding: u64) -> Self {
        let (nm, turns) = lead.parts();
        let whole = nm.checked_div(turns).unwrap_or(0);
        let below = u128::from(nm.wrapping_sub(whole.wrapping_mul(turns))) << 32;
        let rest = narrow_div(below.wrapping_add(u128::from(rounding)), turns);
        Self {
            low: -join - Turns::ONE,
            high: done + Turns::ONE,
            lead: (whole, rest.min(u64::from(u32::MAX))),
            variable: VariableTravel::default(),
        }
    }

    /// The helix' travel for an angle that counts from the start point.
    pub fn at(&self, relative: Turns) -> Fine {
        // Not `clamp`, which panics if the limits cross.
        let relative = relative.raw().max(self.low.raw()).min(self.high.raw());
        if !self.variable.is_none() {
            return self.variable.at(relative);
        }
        let turns = relative >> 32;
        let part = (relative as u64) & 0xffff_ffff;
        let (lead, rest) = self.lead;
        // turns + part·2⁻³², times lead + rest·2⁻³², in 2⁻¹⁶.
        let whole_turns = turns
            .wrapping_mul(lead as i64)
            .wrapping_shl(16)
            .wrapping_add(turns.wrapping_mul(rest as i64) >> 16);
        let within =
            ((part >> 2).wrapping_mul(lead) >> 14).wrapping_add(part.wrapping_mul(rest) >> 48);
        whole_turns.wrapping_add(within as i64)
    }
    /// The travel over the last `step` up to `angle`, which counts from the start point.
    pub fn over(&self, angle: Turns, step: Turns) -> Fine {
        if self.variable.is_none() {
            self.at(step)
        } else {
            self.at(angle).wrapping_sub(self.at(angle - step))
        }
    }
}
