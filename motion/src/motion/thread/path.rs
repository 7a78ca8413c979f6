//! The path of a pass: the tool's position for a way along the long axis.

use super::helix::Helix;
use super::plan::ThreadPlan;
use super::ramp::{Slope, along};
use crate::call::Position;
use crate::motion::ease::{Fine, whole};
use crate::units::{Length, Turns};

/// The short axis' way out in mid-thread: a corner into the slope and, `apart` further on, a corner out of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Out {
    pub from: Fine,
    pub slope: Slope,
    pub apart: Fine,
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

    /// The angle, counted in the direction in which the spindle must turn.
    pub(super) fn turned(&self, angle: Turns) -> Turns {
        if self.reverse { -angle } else { angle }
    }

    /// The pass's line with its run-in, relative to the start point on the short axis.
    pub(super) fn line(&self, way: Fine) -> Fine {
        let line = along(way, self.taper);
        if self.run_in.slope == 0 {
            return line;
        }
        // The offset from the line is the rest of the ramp, counted backwards from its end; at the start it is the
        // whole ramp.
        let corner = self.run_in.ease.half();
        let left = self.run_in.at.wrapping_sub(way).wrapping_sub(corner);
        let ramp = along(self.run_in.ease.at(left), self.run_in.slope);
        line.wrapping_add(ramp).wrapping_sub(self.run_in_rise)
    }

    /// The tool's position when the long axis is `way` along, either on the way out in mid-thread or on the pass's own
    /// run-out. In the corner to the stroke before, `aside` of the line: there the way may come from any side, and means
    /// nothing to what follows the corner.
    pub(super) fn position(&self, way: Fine, aside: Option<Fine>, out: Option<Out>) -> Position {
        let mut beside = self.line(way);
        if let Some(aside) = aside {
            beside = beside.wrapping_add(aside);
        } else if let Some(out) = out {
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

    /// The move of the pass to which a way belongs, from 0. `out`: true on the way out in mid-thread.
    pub(super) fn move_index(&self, way: Fine, out: bool) -> u8 {
        let behind_run_in = u8::from(self.run_in.at > 0 && way >= self.run_in.at);
        let in_run_out = u8::from(self.run_out.at > 0 && !out && way >= self.run_out.at);
        behind_run_in.wrapping_add(in_run_out)
    }
}
