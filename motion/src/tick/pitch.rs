//! What the drives of X and Z are told less, for the errors of their screws' pitch (1861, 1862, 1871 to 1886).
//!
//! A slide is where its drive is, and the error of its place beside that. So the drive is told the place of the slide, less
//! that error. There is no state: at a place there is one error, and nothing leaps, for the [curve](PitchCurve) does not.
//!
//! Must not know what an axis is moved for, its drive's increments, or its backlash.

use crate::params::{Params, PitchCurve};
use crate::units::Axis;

/// X and Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pitch([Option<PitchCurve>; 2]);

impl Pitch {
    pub(super) fn of(params: &Params) -> Self {
        Self([Axis::X, Axis::Z].map(|axis| PitchCurve::of(params, axis)))
    }

    /// No error is known.
    pub(super) const fn is_empty(&self) -> bool {
        matches!(self.0, [None, None])
    }

    pub(super) const fn curve(&self, axis: Axis) -> Option<&PitchCurve> {
        let [x, z] = &self.0;
        match axis {
            Axis::X => x.as_ref(),
            Axis::Z => z.as_ref(),
            Axis::C => None,
        }
    }

    /// The error where an axis is to be at this place, in nanometres.
    pub(super) fn error(&self, axis: Axis, place: i64) -> i64 {
        self.curve(axis).map_or(0, |curve| curve.at(place))
    }

    /// The same of X, Z and C.
    pub(super) fn errors(&self, [x, z, _]: [i64; 3]) -> [i64; 3] {
        [self.error(Axis::X, x), self.error(Axis::Z, z), 0]
    }

    /// The place of an axis whose drive is at this one.
    pub(super) fn place(&self, axis: Axis, drive: i64) -> i64 {
        self.curve(axis).map_or(drive, |curve| curve.place(drive))
    }
}
