//! Steps by hand that have been let in since the axes stood: they go on from each other.
//!
//! Must not know where the axis is by now.

use crate::alarm::{Alarm, Arg, Code};
use crate::call::Position;
use crate::cycle::Forbidden;
use crate::motion::AxisTravel;
use crate::operating::Towards;
use crate::params::Params;
use crate::units::{Axes, Axis, Diameter, Length};

/// The step under way and those that wait.
const MOST: u8 = 4;

/// The steps of one axis, from where it stood.
#[derive(Debug, Default)]
pub struct Steps {
    count: u8,
    on_z: bool,
    /// Where the last of them ends.
    end: Length,
    /// Its way, signed: all go the same way.
    way: Length,
}

impl Steps {
    /// Lets a step of this way in. `at`: where the machine stands, if nothing moves. An axis without a reference has no
    /// limits.
    ///
    /// # Errors
    /// [`Code::StepsWait`], [`Code::NotAtRest`] for another axis or the other direction, [`Code::StepBeyondLimit`],
    /// [`Code::ZoneEntered`].
    pub fn admit(
        &mut self,
        on_z: bool,
        way: Length,
        at: &Position,
        referenced: Axes,
        params: &Params,
        forbidden: &Forbidden,
    ) -> Result<(), Alarm> {
        if self.count >= MOST {
            return Err(Alarm::of(Code::StepsWait, &[]));
        }
        let goes_on = self.on_z == on_z && self.way.signum() == way.signum();
        if self.count > 0 && !goes_on {
            return Err(Alarm::of(Code::NotAtRest, &[]));
        }
        let (axis, stands) = if on_z {
            (Axis::Z, at.z)
        } else {
            (Axis::X, at.x)
        };
        let from = if self.count == 0 { stands } else { self.end };
        let towards = Towards::of(way);
        let left = AxisTravel::of(params, axis).left(from, towards);
        if way.abs() > left && referenced.contains(axis) {
            let free = left.max(Length::ZERO);
            let told = match axis {
                Axis::X => Arg::Diameter(Diameter::of_radius(free)),
                _ => Arg::Length(free),
            };
            let figures = [Arg::Letter(axis.letter()), told];
            return Err(Alarm::of(Code::StepBeyondLimit, &figures));
        }
        forbidden.step(axis, from, way, *at)?;
        *self = Self {
            count: self.count.saturating_add(1),
            on_z,
            end: from + way,
            way,
        };
        Ok(())
    }
}
