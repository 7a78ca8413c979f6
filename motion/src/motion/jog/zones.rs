//! How far X and Z may go by hand where zones are.
//!
//! Each axis against all places where the other one may be meanwhile: an axis that moves already, between here and its end;
//! one that begins, between here and its clamp. So the rectangle of both ways is free, whichever axis is first.

use super::{AxisPress, AxisTravel, Jog, JogAxis, Press};
use crate::call::Position;
use crate::operating::Towards;
use crate::units::{Axis, Length};
use crate::zones::{Extent, Zones};

impl JogAxis {
    /// Where it may be until it stands, if it goes on as it does.
    fn reaches(&self, at: Length) -> Extent {
        let end = match (self.moves, self.follower.target()) {
            (false, _) => at,
            (true, Some(target)) => self.from + target,
            (true, None) => match self.towards {
                Towards::Plus => self.from + self.way,
                Towards::Minus => self.from - self.way,
            },
        };
        Extent::between(at, end)
    }
}

impl Jog {
    /// How far X and Z may go by `press` within their travel, from `at`.
    // Both kinds of press call it, and none of it is in a tick that nobody presses in.
    #[cold]
    #[inline(never)]
    #[must_use]
    pub fn clear_of(
        &self,
        zones: &Zones,
        press: &Press,
        at: Position,
        [x, z]: [AxisTravel; 2],
    ) -> [AxisTravel; 2] {
        let Some([tip_x, tip_z]) = press.tip else {
            return [x, z];
        };
        let (at_x, at_z) = (at.x - tip_x, at.z - tip_z);
        let along_x = self.x.reaches(at.x).moved(-tip_x);
        let along_z = self.z.reaches(at.z).moved(-tip_z);
        let z = zones.travel(Axis::Z, at_z, along_x, extent(z).moved(-tip_z));
        let along_z = along_z.joined(asked(press, press.z.as_ref(), at_z, z));
        let x = zones.travel(Axis::X, at_x, along_z, extent(x).moved(-tip_x));
        [travel(x.moved(tip_x)), travel(z.moved(tip_z))]
    }
}

/// Where an axis may go by a press, if it may go within `free`.
fn asked(press: &Press, wanted: Option<&AxisPress>, at: Length, free: Extent) -> Extent {
    let end = match wanted {
        None => at,
        // A wheel turns either way.
        Some(_) if press.wheel.is_some() => return free.joined(Extent::between(at, at)),
        Some(wanted) => match wanted.towards {
            Towards::Plus => free.high.max(at),
            Towards::Minus => free.low.min(at),
        },
    };
    Extent::between(at, end)
}

const fn extent(travel: AxisTravel) -> Extent {
    let AxisTravel { low, high } = travel;
    Extent { low, high }
}

const fn travel(extent: Extent) -> AxisTravel {
    let Extent { low, high } = extent;
    AxisTravel { low, high }
}
