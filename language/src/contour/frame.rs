//! One frame for both roughing cycles: `h` is the height above the part, `l` the way along the strokes.
//!
//! Outside and inside, both directions of Z, and the exchanged axes of G72 differ in this frame alone.

use leadscrew_core::units::Length;

use super::words::Along;
use crate::plane::Point;

/// A place in the frame, nanometres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Local {
    /// Height: larger is further from the part.
    pub h: i64,
    /// Way along the strokes: larger is later.
    pub l: i64,
}

/// How the plane of the machine lies in the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub along: Along,
    /// +1 where a larger infeed coordinate is higher, else −1.
    pub up: i64,
    /// +1 where the strokes go toward larger coordinates, else −1.
    pub forward: i64,
}

impl Frame {
    /// A place of the machine in the frame.
    pub const fn enter(&self, point: Point) -> Local {
        let (h, l) = self.along.split(point);
        Local {
            h: h * self.up,
            l: l * self.forward,
        }
    }

    /// A place of the frame on the machine.
    pub const fn leave(&self, place: Local) -> Point {
        let (h, l) = (
            Length::from_nm(place.h * self.up),
            Length::from_nm(place.l * self.forward),
        );
        match self.along {
            Along::Z => Point { x: h, z: l },
            Along::X => Point { x: l, z: h },
        }
    }

    /// True where an arc that goes forward runs over the top of its circle.
    pub const fn is_over(&self, clockwise: bool) -> bool {
        let turn = if clockwise { 1 } else { -1 };
        let hand = match self.along {
            Along::Z => 1,
            Along::X => -1,
        };
        turn * hand * self.up * self.forward > 0
    }
}
