//! A swing and its differences against floating point.

#![allow(
    clippy::float_arithmetic,
    clippy::arithmetic_side_effects,
    clippy::cast_precision_loss
)]

extern crate std;

use std::f64::consts::TAU;

use super::*;

/// A period in the units of an angle.
const WHOLE: f64 = 4_294_967_296.0;

/// Turns in the units of a swing.
const TURN: f64 = (1_u64 << 48) as f64;

/// A swing of the size `size` (turns) with its largest value at `phase`, at `at`, in ticks of `step` (periods): the
/// value and its backward differences.
fn exact(size: f64, phase: f64, at: f64, step: f64) -> [f64; 4] {
    let worth = |ticks: f64| size * (TAU * (at - phase - ticks * step)).cos();
    let [x0, x1, x2, x3] = [0.0, 1.0, 2.0, 3.0].map(worth);
    [
        x0,
        x0 - x1,
        x0 - 2.0 * x1 + x2,
        x0 - 3.0 * x1 + 3.0 * x2 - x3,
    ]
}

/// What rounding to 2⁻³² turns leaves of a difference of this order, where each grows by `chord`.
fn rounding(order: i32, chord: f64) -> f64 {
    let grown: f64 = (1..=order).map(|order| chord.powi(order)).sum();
    2_f64.powi(-31) * if order == 0 { 1.0 } else { grown }
}

/// What the cosine and sine of an angle leave of a difference of this order: they are right to 2⁻²¹, and to 2⁻²⁸ for
/// a small angle like a step's, which comes in once for each order.
fn unit(size: f64, order: i32, chord: f64) -> f64 {
    let of_step = 2_f64.powi(-28) + 2_f64.powi(-21) * chord.powi(3).min(1.0);
    let of_steps = f64::from(order) * chord.powi((order - 1).max(0)) * of_step;
    size * (2_f64.powi(-21) * chord.powi(order) + of_steps)
}

#[test]
fn differences_are_those_of_the_swing_at_any_step() {
    let sizes = [1e-6, 1e-3, 0.0156, 0.1];
    let steps = [1e-4, 0.01, 0.125, 0.25, 0.4999, 0.5];
    for (size, step) in sizes
        .into_iter()
        .flat_map(|size| steps.map(|step| (size, step)))
    {
        for (step, at) in [(step, 0.0), (-step, 0.0), (step, 0.3), (-step, 0.77)] {
            let phase = 0.1_f64;
            let wave = Wave {
                a: (size * (TAU * phase).cos() * TURN) as i64,
                b: (size * (TAU * phase).sin() * TURN) as i64,
            };
            let [at, step] = [at, step].map(|periods| (periods * WHOLE) as i64);
            let [at_unit, step_unit] = [at, step].map(|angle| Unit::of(angle as Angle));
            let [at, step] = [at, step].map(|angle| angle as f64 / WHOLE);
            let found = wave.differences(at_unit, step_unit);
            let found = [found.value, found.speed, found.acceleration, found.jerk];
            // Each difference grows by the chord of a step.
            let chord = 2.0 * (TAU * step / 2.0).sin().abs();
            for ((order, found), exact) in found
                .into_iter()
                .enumerate()
                .zip(exact(size, phase, at, step))
            {
                let off = found as f64 / TURN - exact;
                let order = order as i32;
                assert!(
                    off.abs() < unit(size, order, chord) + rounding(order, chord),
                    "size {size}, step {step}, at {at}: difference {order} is off by {off:e} of {exact:e}"
                );
            }
            let [value, before] = wave.pair(at_unit, step_unit);
            assert_eq!([value, before], [found[0], found[0] - found[1]]);
        }
    }
}

/// A follower adds a jerk up three times. What is always wrong to one side would take it off the swing.
#[test]
fn the_jerk_of_a_slow_swing_is_on_neither_side() {
    let step = Unit::of(800_000);
    let wave = Wave {
        a: (0.0156 * TURN) as i64,
        b: 0,
    };
    let mut sum = 0;
    let mut angle: Angle = 0;
    let ticks = 5_369_u16;
    for _ in 0..ticks {
        sum += wave.differences(Unit::of(angle), step).jerk;
        angle = angle.wrapping_add(800_000);
    }
    // Over a whole period nothing is left but the rounding.
    let mean = sum as f64 / f64::from(ticks) / 65_536.0;
    assert!(mean.abs() < 1e-4, "{mean} of 2⁻³² turns");
}
