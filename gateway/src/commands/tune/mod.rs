//! `tune`: moves an axis to and fro by jogging, and finds how far its drive lags behind; or runs the spindle up, and finds
//! its ramp and its ripple.
//!
//! [`strokes`] moves an axis and hears, [`spindle`] the spindle; `crate::tuning` computes; [`result`] and [`turned`] say
//! what was found, and [`telling`] hands that out.
//! It holds no limit of its own: the board does.

mod result;
mod spindle;
mod strokes;
mod telling;
mod turned;

use leadscrew_core::operating::OperatingMode;
use leadscrew_core::units::Axis;

use crate::cli::{AxisWay, Global, Tune, Tuned};
use crate::commands::board::Greeted;
use crate::failure::{Failure, Outcome};
use crate::tuning::{Known, Pace, look};
use crate::words::both;

/// Moves, finds, tells, and writes where that was asked.
pub fn run(global: &Global, args: &Tune) -> Outcome {
    match args.what {
        Tuned::Axis(way) => axis(global, args, way),
        Tuned::Spindle => spindle::run(global, args),
    }
}

/// The drive of an axis.
fn axis(global: &Global, args: &Tune, way: AxisWay) -> Outcome {
    if !args.speeds.is_empty() || args.seconds.is_some() {
        return Err(Failure::Usage(both!(
            "`--speeds` and `--seconds` are for `tune spindle`",
            "`--speeds` 和 `--seconds` 用于 `tune spindle`"
        )));
    }
    let file = telling::file(args)?;
    let axis = if way.on_z { Axis::Z } else { Axis::X };
    let mut machine = Greeted::meet(global)?.read()?;
    let params = &machine.params;
    let letter = char::from(axis.letter());
    let dead_time = args.dead_time.unwrap_or(params.latency_us(axis));
    if dead_time == 0 {
        return Err(Failure::Usage(both!(
            "the bus does not show which part of the lag is dead time, and 9003.{letter} is 0: give the time of buffer and \
             interpolation with `--dead-time US` (one SYNC period, and one for each target that waits)",
            "总线上无法看出滞后中哪一部分是死区时间，而 9003.{letter} 为 0：请用 `--dead-time US` 给出缓冲与插补的时间（一个 SYNC 周期，每个等待的目标再加一个周期）"
        )));
    }
    let age = args.age.unwrap_or(params.actual_age_us(axis));
    let (many, nm) = (params.drive_numerator(axis), params.drive_denominator(axis));
    let increment = f64::from(nm) / f64::from(many) / 1000.0;
    let tick = f64::from(params.tick_us()) * 1e-6;
    let feed_forward = args
        .feed_forward
        .map_or(params.drive_feed_forward(axis), |percent| percent * 10);
    let age_within = result::age_within(args.age_within, age, params.actual_age_us(axis));
    let other = if way.on_z { Axis::X } else { Axis::Z };
    let before = result::Before {
        letter,
        others: result::Others {
            letter: char::from(other.letter()),
            gain: params.drive_gain(other),
            latency: params.latency_us(other),
            spindle_gain: way.on_z.then(|| params.spindle_drive_gain()),
        },
        taken_off: f64::from(params.latency_us(axis)) * 1e-6
            + result::behind(params.drive_gain(axis), params.drive_feed_forward(axis)),
        increment,
        tick,
    };
    let gain = params.drive_gain(axis);
    let gain = (gain > 0).then(|| f64::from(gain) / 10.0);
    let pace = Pace::of(increment, tick, gain);
    machine.link.hear_status()?;
    machine.link.set_mode(OperatingMode::Manual)?;
    let scale = strokes::Scale {
        increment,
        tick,
        pace,
    };
    let heard = strokes::make(&mut machine, way, axis, scale)?;
    drop(machine);
    let known = Known {
        tick,
        pace,
        quantum: heard.quantum(increment),
        dead_time: f64::from(dead_time + age) * 1e-6,
        feed_forward: f64::from(feed_forward) / 1000.0,
    };
    let found = look(&heard.runs, &heard.rest, &known).map_err(|why| result::refusal(&why))?;
    let told = result::Told {
        before,
        dead_time,
        feed_forward,
        age,
        age_within,
        found,
        known,
    };
    telling::finish(global, args, file, &told)
}
