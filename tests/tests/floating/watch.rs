//! What every tick of an ordinary tap is judged by.

use leadscrew_board_sim::Row;
use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_tests::machine::{Ran, run};

use super::hole::Hole;

/// A spindle that ripples by so many per cent, five times a second.
pub fn rippling(percent: u32) -> PlantOptions {
    PlantOptions {
        ripple: Ripple::new(percent * 1000, 5_000),
        ..PlantOptions::default()
    }
}

pub fn locked(ran: &Ran) -> impl Iterator<Item = &Row> {
    ran.rows.iter().filter(|row| row.error.is_some())
}

/// Depth below R in nanometres.
pub fn depth(row: &Row, hole: &Hole) -> i64 {
    hole.level() - row.position.z.nm()
}

/// The largest error of the locked part, in nanometres.
pub fn worst(ran: &Ran) -> i64 {
    locked(ran)
        .filter_map(|row| row.error)
        .map(|error| error.nm().abs())
        .max()
        .expect("a locked part")
}

/// One hole from Z0 to its end: nothing beyond the bottom and the bottom reached, R
/// and the initial level exact, limits kept.
pub fn tap(hole: &Hole, params: &Params, plant: &PlantOptions) -> Ran {
    let ran = run(&hole.program(), params, plant, |_, _| {});
    assert_eq!(ran.alarm, None, "{hole:?}");
    judge(&ran, hole, params);
    let deepest = ran.rows.iter().map(|row| depth(row, hole)).max();
    assert_eq!(deepest, Some(hole.total()), "the bottom: {hole:?}");
    assert_eq!(ran.rows.last().expect("rows").position.z.nm(), 0);
    ran
}

/// Nothing beyond the bottom; speed and acceleration of the axis within its limits, whoever leads; nothing but Z moves.
pub fn judge(ran: &Ran, hole: &Hole, params: &Params) {
    judge_uneven(ran, hole, params, 0.0);
}

/// As [`judge`], with a spindle whose unevenness is worth so much acceleration of the axis, in m/s².
pub fn judge_uneven(ran: &Ran, hole: &Hole, params: &Params, uneven: f64) {
    let tick = f64::from(params.tick_us()) * 1e-6;
    let speed = params.rapid(Axis::Z).nm_per_min() as f64 / 60.0 * tick;
    let acceleration =
        (params.acceleration(Axis::Z).nm_per_s2() as f64 + uneven * 1e9) * tick * tick;
    for rows in ran.rows.windows(3) {
        let [a, b, c] = [0, 1, 2].map(|i| rows[i].position.z.nm());
        let row = &rows[2];
        assert!(depth(row, hole) <= hole.total(), "beyond: {row:?}");
        assert!(((c - b) as f64).abs() <= speed + 1.0, "speed: {row:?}");
        let second = (c - 2 * b + a) as f64;
        assert!(
            second.abs() <= acceleration + 2.0,
            "{second} nm/tick² of {acceleration}: {row:?}"
        );
        assert_eq!((row.position.x.nm(), row.position.c.udeg()), (0, 0));
        assert_eq!(row.spindle_set, None);
    }
}
