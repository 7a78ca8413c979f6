//! Plans what is asked of the axes by hand: a speed and a ramp for each.

use crate::board::device::Asked;
use crate::bus::Periods;
use crate::call::Position;
use crate::cycle::Forbidden;
use crate::motion::{AxisPress, Limits, PathRate, Press, Wheel};
use crate::operating::Towards;
use crate::params::Params;
use crate::units::{Axes, Axis, Feed, Length};

/// Nanometres in a millimetre.
const MM: i64 = 1_000_000;

/// The target of a handwheel may be so far behind it as 9046 is fast in this time: frames come every 20 to 25 ms, and each
/// brings what was turned since the one before [D312].
const WHEEL_MS: u32 = 50;

/// The press for the tick. No axis goes faster than its rapid (1420) and 9042, or 9046 by handwheel; one without a
/// reference, or that goes back to where a program was left, or with the door open, than 9043. So does one whose tool was
/// not measured, or stands in a zone, where there are zones. `door`: it is open; `at`: where the machine is.
pub fn plan_press(
    asked: &Asked,
    (referenced, door): (Axes, bool),
    (forbidden, at): (&Forbidden, Position),
    params: &Params,
    limits: &Limits,
) -> Press {
    let tick_us = params.tick_us();
    let speed = match asked.speed {
        Some(mm) => Feed::from_nm_per_min(i64::from(mm).saturating_mul(MM)),
        None => params.jog_feed(),
    };
    let highest = match asked.wheel {
        true => params.wheel_speed(),
        false => params.manual_rapid(),
    };
    let top = PathRate::of_feed(highest, tick_us);
    let speed = match asked.rapid {
        true => top,
        false => PathRate::of_feed(speed, tick_us),
    };
    let slow = PathRate::of_feed(params.slow_feed(), tick_us).min(top);
    let zones = !forbidden.zones.are_off();
    let watched = zones && (forbidden.tip.is_none() || forbidden.is_in_zone(at));
    let plan = |axis, towards: Option<Towards>| {
        let fast = referenced.contains(axis) && !door && !asked.returns && !watched;
        let top = if fast { top } else { slow };
        if asked.wheel {
            towards?;
            return AxisPress::led(axis, top, limits);
        }
        AxisPress::new((axis, towards?), (speed, top), asked.rapid, limits)
    };
    let (x, z) = (plan(Axis::X, asked.x), plan(Axis::Z, asked.z));
    let led = x.as_ref().or(z.as_ref()).filter(|_| asked.wheel);
    Press {
        number: asked.number,
        x,
        z,
        spindle: asked.spindle,
        at_rapid: asked.rapid,
        slow: door,
        tip: forbidden.tip.filter(|_| zones),
        way: asked.way,
        wheel: led.map(|led| wheel(led, params)),
        until: asked.until,
        returns: asked.returns,
    }
}

/// How a handwheel leads its axis.
fn wheel(led: &AxisPress, params: &Params) -> Wheel {
    let ticks = Periods::from_ms(WHEEL_MS, params.tick_us()).map_or(0, Periods::get);
    let way = i64::from(led.speed.raw()).saturating_mul(ticks.into()) >> 8;
    let follows = params.wheel_follows();
    let more = if follows {
        params.wheel_lag()
    } else {
        Length::ZERO
    };
    Wheel {
        lag: Length::from_nm(way) + more,
        warns: follows,
    }
}
