//! Plans what is asked of the axes by hand: a speed and a ramp for each.

use crate::board::device::Asked;
use crate::motion::{AxisPress, Limits, PathRate, Press};
use crate::operating::Towards;
use crate::params::Params;
use crate::units::{Axes, Axis, Feed};

/// Nanometres in a millimetre.
const MM: i64 = 1_000_000;

/// The press for the tick. No axis goes faster than its rapid (1420) and 9042; one without a reference, or that goes back to
/// where a program was left, or with the door open, than 9043. `door`: it is open.
pub fn plan_press(
    asked: &Asked,
    (referenced, door): (Axes, bool),
    params: &Params,
    limits: &Limits,
) -> Press {
    let tick_us = params.tick_us();
    let speed = match asked.mm_per_min {
        Some(mm) => Feed::from_nm_per_min(i64::from(mm).saturating_mul(MM)),
        None => params.jog_feed(),
    };
    let top = PathRate::of_feed(params.manual_rapid(), tick_us);
    let speed = match asked.rapid {
        true => top,
        false => PathRate::of_feed(speed, tick_us),
    };
    let slow = PathRate::of_feed(params.slow_feed(), tick_us).min(top);
    let plan = |axis, towards: Option<Towards>| {
        let top = match referenced.contains(axis) && !door && !asked.returns {
            true => top,
            false => slow,
        };
        AxisPress::new((axis, towards?), (speed, top), asked.rapid, limits)
    };
    Press {
        number: asked.number,
        x: plan(Axis::X, asked.x),
        z: plan(Axis::Z, asked.z),
        at_rapid: asked.rapid,
        slow: door,
        way: asked.way,
        until: asked.until,
        returns: asked.returns,
    }
}
