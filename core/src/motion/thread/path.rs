//! Where a pass runs: the helix' travel for an angle, and the tool's position for a way along the long axis.

use super::plan::{ThreadPlan, whole};
use super::ramp::{Slope, along};
use crate::motion::ease::Fine;
use crate::program::Position;
use crate::units::{Lead, Length, Turns, narrow_div};

/// The short axis' way out in mid-thread: a ramp up and, `apart` further on, one down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Out {
    pub from: Fine,
    pub slope: Slope,
    pub apart: Fine,
}

/// The exact helix of a pass, to judge its setpoints by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Helix {
    travel: HelixTravel,
    base: Turns,
    start: Length,
    long_x: bool,
    backward: bool,
    reverse: bool,
}

impl Helix {
    /// True where X is the long axis.
    #[must_use]
    pub const fn long_x(&self) -> bool {
        self.long_x
    }

    /// Where the helix stands on the long axis at a spindle angle.
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

/// What turns an angle into a travel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::motion) struct HelixTravel {
    /// Angles below and above count as these: a turn around the pass.
    pub low: Turns,
    pub high: Turns,
    /// Travel per turn: whole nanometres, and the rest in 2⁻³² nm.
    pub lead: (u64, u64),
}

impl HelixTravel {
    /// The travel of a helix of `lead`, from a turn before `join` ahead of the start point to a turn behind `done`.
    /// `rounding`: of the lead's denominator, what its part below a nanometre is given before it is rounded down.
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
        }
    }

    /// The helix' travel for an angle since it was at the start point.
    pub fn at(&self, relative: Turns) -> Fine {
        // Not `clamp`, which panics where the limits cross.
        let relative = relative.raw().max(self.low.raw()).min(self.high.raw());
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
}

impl ThreadPlan {
    /// The helix that is at the start point at the angle `base`.
    pub(super) fn helix(&self, base: Turns) -> Helix {
        Helix {
            travel: self.travel,
            base,
            start: if self.long_x {
                self.start.x
            } else {
                self.start.z
            },
            long_x: self.long_x,
            backward: self.backward,
            reverse: self.reverse,
        }
    }

    /// An angle counted in the direction the spindle is to turn.
    pub(super) fn turned(&self, angle: Turns) -> Turns {
        if self.reverse { -angle } else { angle }
    }

    /// The pass's line with its run-in, relative to the start point on the short axis.
    pub(super) fn line(&self, way: Fine) -> Fine {
        let line = along(way, self.taper);
        if self.run_in.slope == 0 {
            return line;
        }
        // Beside the line by what is left of the ramp, backwards from its end; at the start all of it is left.
        let corner = self.run_in.ease.half();
        let left = self.run_in.at.wrapping_sub(way).wrapping_sub(corner);
        let ramp = along(self.run_in.ease.at(left), self.run_in.slope);
        line.wrapping_add(ramp).wrapping_sub(self.run_in_rise)
    }

    /// The tool's position with the long axis `way` along, on the way out in mid-thread or on the pass's own run-out.
    pub(super) fn position(&self, way: Fine, out: Option<Out>) -> Position {
        let mut beside = self.line(way);
        if let Some(out) = out {
            let ease = &self.retract.ease;
            let since = way.wrapping_sub(out.from).wrapping_sub(ease.half());
            let ramp = ease
                .at(since)
                .wrapping_sub(ease.at(since.wrapping_sub(out.apart)));
            beside = beside.wrapping_add(along(ramp, out.slope));
        } else if self.run_out.slope != 0 {
            let ease = &self.run_out.ease;
            let since = way.wrapping_sub(self.run_out.at).wrapping_sub(ease.half());
            beside = beside.wrapping_add(along(ease.at(since), self.run_out.slope));
        }
        let long = self.long_at(whole(way));
        let short = self.short_start() + whole(beside);
        let (x, z) = if self.long_x {
            (long, short)
        } else {
            (short, long)
        };
        Position {
            x,
            z,
            c: self.start.c,
        }
    }

    /// Coordinate of the long axis at a way from the start point.
    pub(super) fn long_at(&self, way: Length) -> Length {
        let start = if self.long_x {
            self.start.x
        } else {
            self.start.z
        };
        if self.backward {
            start - way
        } else {
            start + way
        }
    }

    /// Coordinate of the short axis at the start point.
    pub(super) const fn short_start(&self) -> Length {
        if self.long_x {
            self.start.z
        } else {
            self.start.x
        }
    }

    /// Which move of the pass a way belongs to, from 0; `out`: on the way out in mid-thread.
    pub(super) fn move_index(&self, way: Fine, out: bool) -> u8 {
        let behind_run_in = u8::from(self.run_in.at > 0 && way >= self.run_in.at);
        let in_run_out = u8::from(self.run_out.at > 0 && !out && way >= self.run_out.at);
        behind_run_in.wrapping_add(in_run_out)
    }
}
