//! Compares every setpoint with every limit, by finite differences in nanometres.

use leadscrew_board_sim::Row;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

/// The axis positions of a row.
fn at(row: &Row, axis: Axis) -> i64 {
    match axis {
        Axis::X => row.position.x.nm(),
        Axis::Z => row.position.z.nm(),
        Axis::C => row.position.c.udeg(),
    }
}

/// True where the spindle leads in this row.
fn leads(row: &Row) -> bool {
    row.error.is_some() && !row.is_rigid()
}

/// The first setpoint that exceeds the speed, the acceleration or the jerk of its axis, in words. Rounding to nanometres is
/// allowed with 2ⁿ·0.5 nm in the n-th difference. Differences with a row on a helix are judged by speed alone, because the
/// spindle leads there. In a tap the spindle follows, so its axis is judged as usual.
#[must_use]
pub fn first_excess(rows: &[Row], params: &Params) -> Option<String> {
    first_excess_with(rows, params, 1.0)
}

/// As [`first_excess`], with `jerks` times the jerk allowed.
#[must_use]
pub fn first_excess_with(rows: &[Row], params: &Params, jerks: f64) -> Option<String> {
    let tick = f64::from(params.tick_us()) * 1e-6;
    for axis in Axis::ALL {
        let speed = params.rapid(axis).nm_per_min() as f64 / 60.0 * tick;
        let accel = params.acceleration(axis).nm_per_s2() as f64 * tick * tick;
        let jerk = jerks * params.jerk(axis).nm_per_s3() as f64 * tick * tick * tick;
        for (index, window) in rows.windows(4).enumerate() {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| at(&window[i], axis));
            let led = window.iter().any(leads);
            let first = (d - c) as f64;
            let second = (d - 2 * c + b) as f64;
            let third = (d - 3 * c + 3 * b - a) as f64;
            let tick_of = rows[index + 3].tick;
            if first.abs() > speed + 1.0 {
                return Some(format!(
                    "tick {tick_of}: {axis:?} moves {first} nm, limit {speed:.1}"
                ));
            }
            if !led && second.abs() > accel + 2.0 {
                return Some(format!(
                    "tick {tick_of}: {axis:?} accelerates by {second} nm, limit {accel:.1}"
                ));
            }
            if !led && third.abs() > jerk + 4.0 {
                return Some(format!(
                    "tick {tick_of}: {axis:?} jerks by {third} nm, limit {jerk:.1}"
                ));
            }
        }
    }
    None
}
