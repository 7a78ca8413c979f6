//! Against simulated drives whose figures are known.

use leadscrew_board_sim::plant::{Following, Interpolation, Servo, ServoOptions};
use leadscrew_core::bus::Increments;
use leadscrew_core::units::{Acceleration, Feed, Length};

use super::*;

const TICK: f64 = 1e-3;
/// An inner step of the drive.
const STEP: f64 = TICK / 8.0;
/// Micrometres a second.
const SPEEDS: [f64; 3] = [10_000.0, 25_000.0, 50_000.0];

/// A small lathe's Z.
fn drive(kv: u32, ff_percent: u16, buffer: u8, count_nm: i64) -> ServoOptions {
    let acceleration = |mm_s2: i64| Acceleration::from_nm_per_s2(mm_s2 * 1_000_000);
    ServoOptions {
        buffer,
        interpolation: Interpolation::Linear,
        kv_milli: kv * 1000,
        feed_forward_milli: ff_percent * 10,
        speed_loop_milli: 400_000,
        integral_us: 10_000,
        current_loop_milli: 5_026_548,
        speed_limit: Feed::from_nm_per_min(30_000_000_000),
        acceleration_limit: acceleration(6000),
        sticking: acceleration(250),
        sliding: acceleration(250),
        viscous_milli: 2000,
        play: Length::from_nm(10_000),
        count: Length::from_nm(count_nm),
        following: None,
        undelayed: false,
        age_us: 0,
        late: None,
        ..ServoOptions::LOOPS_ALONE
    }
}

/// A stroke with ramps of 1 m/s² and this time at constant speed; it has an actual position at every `every`-th SYNC.
fn stroke(options: &ServoOptions, speed: f64, constant: f64, every: usize) -> Vec<Sample> {
    let mut servo = Servo::new(options, (1, 1), 1000, Increments::new(0)).unwrap();
    let window = Following {
        window: Following::OFF,
        timeout_ms: 0,
    };
    let (ramp, mut at) = (speed.abs() / 1e6, 0.0);
    let syncs = ((2.0 * ramp + constant + 0.6) / TICK) as usize;
    let mut samples = Vec::new();
    for sync in 0..syncs {
        let time = sync as f64 * TICK - 0.02;
        let left = 2.0 * ramp + constant - time;
        let share = (time / ramp).min(left / ramp).clamp(0.0, 1.0);
        at += share * speed * TICK;
        let nm = (at * 1000.0).round() as i32;
        samples.push(Sample {
            setpoint: f64::from(nm) / 1000.0,
            actual: (sync % every == 0).then(|| f64::from(servo.actual().get()) / 1000.0),
            following: Some(f64::from(servo.following_error().get()) / 1000.0),
        });
        assert_eq!(servo.latch(Increments::new(nm), true), None);
        assert_eq!(servo.period(window), None);
    }
    samples
}

fn run(of: impl Fn(f64) -> ServoOptions, constant: f64, every: usize) -> Vec<Vec<Sample>> {
    let speeds = SPEEDS.iter().flat_map(|speed| [*speed, -speed]);
    speeds
        .map(|speed| stroke(&of(speed), speed, constant, every))
        .collect()
}

fn known(buffer: u8, ff_percent: u16, count_nm: i64) -> Known {
    Known {
        tick: TICK,
        pace: Pace::of(0.001, TICK, None),
        quantum: count_nm as f64 / 1000.0,
        dead_time: f64::from(buffer + 1) * TICK,
        feed_forward: f64::from(ff_percent) / 100.0,
    }
}

/// What is found of a drive.
fn found(options: &ServoOptions, every: usize) -> Result<Found, Refusal> {
    let once = run(|_| *options, 1.1, every);
    look(
        &[once.clone(), once],
        &[],
        &known(
            options.buffer,
            options.feed_forward_milli / 10,
            options.count.nm(),
        ),
    )
}

#[test]
fn lag_and_kv_of_known_drives() {
    for (kv, ff, buffer) in [15, 30, 100].into_iter().flat_map(|kv| {
        [0, 50, 100]
            .into_iter()
            .flat_map(move |ff| [0, 5, 10].map(move |buffer| (kv, ff, buffer)))
    }) {
        for (count, every, most) in [(100, 1, 2e-6), (1000, 4, 11e-6)] {
            let case = format!("Kv {kv}, ff {ff}, n {buffer}, {count} nm");
            let found = found(&drive(kv, ff, buffer, count), every).expect(&case);
            let behind = (1.0 - f64::from(ff) / 100.0) / f64::from(kv) - STEP;
            let exact = f64::from(buffer + 1) * TICK + behind;
            let off = found.lag.total.mean - exact;
            assert!(off.abs() <= most, "{case}: {off}");
            let Some(told) = found.model.kv else {
                assert_eq!(ff, 100, "{case}");
                continue;
            };
            let lag = (1.0 - f64::from(ff) / 100.0) / told;
            assert!((lag - behind).abs() <= most, "{case}: {lag}");
            // An inner step of the drive is in the lag: 1.3 % of it at Kv 100, and twice that with half of the speed known.
            let of_step = STEP / (behind + STEP);
            let off = told / f64::from(kv) - 1.0;
            assert!(
                (off - of_step).abs() < of_step / 10.0 + 2e-3,
                "{case}: Kv {told}"
            );
        }
    }
}

#[test]
fn a_current_at_its_limit_is_refused() {
    let mut options = drive(30, 0, 0, 100);
    // Friction at 50 mm/s takes 0.35 m/s², and the rest is not enough for the ramp.
    options.acceleration_limit = Acceleration::from_nm_per_s2(360_000_000);
    let told = found(&options, 1).unwrap_err();
    assert!(
        matches!(told, Refusal::Residual { limit: 3.3, .. }),
        "{told:?}"
    );
}

#[test]
fn an_axis_that_sticks_and_slips_is_refused() {
    let mut options = drive(30, 0, 0, 100);
    options.speed_loop_milli = 60_000;
    options.sticking = Acceleration::from_nm_per_s2(5_000_000_000);
    options.sliding = Acceleration::from_nm_per_s2(100_000_000);
    options.integral_us = 3000;
    let told = found(&options, 1).unwrap_err();
    assert!(matches!(told, Refusal::Residual { .. }), "{told:?}");
}

#[test]
fn directions_that_differ_are_refused() {
    let of = |speed: f64| drive(if speed > 0.0 { 30 } else { 31 }, 0, 0, 100);
    let once = run(of, 1.1, 1);
    let told = look(&[once.clone(), once], &[], &known(0, 0, 100)).unwrap_err();
    assert!(
        matches!(told, Refusal::Directions { plus, minus } if plus > minus),
        "{told:?}"
    );
}

#[test]
fn too_short_a_stroke_is_not_settled() {
    // 8/Kv + 0.5 s are 1.03 s.
    let once = run(|_| drive(15, 0, 0, 100), 0.9, 1);
    let told = look(&[once.clone(), once], &[], &known(0, 0, 100)).unwrap_err();
    assert!(matches!(told, Refusal::NotSettled { .. }), "{told:?}");
}

#[test]
fn a_following_error_of_the_newest_target_is_refused() {
    let mut options = drive(30, 0, 5, 100);
    options.undelayed = true;
    let told = found(&options, 1).unwrap_err();
    assert!(
        matches!(told, Refusal::Following { periods } if (periods - 5.0).abs() < 0.6),
        "{told:?}"
    );
}

#[test]
fn runs_that_differ_are_refused() {
    let of = |kv| run(|_| drive(kv, 0, 0, 100), 1.1, 1);
    let told = look(&[of(30), of(31)], &[], &known(0, 0, 100)).unwrap_err();
    assert!(
        matches!(told, Refusal::Runs { first, second } if first > second),
        "{told:?}"
    );
}

#[test]
fn a_direction_without_three_speeds_is_refused() {
    let mut once = run(|_| drive(30, 0, 0, 100), 1.1, 1);
    once.pop();
    let told = look(&[once.clone(), once], &[], &known(0, 0, 100)).unwrap_err();
    assert_eq!(told, Refusal::Speeds { plus: false });
}

#[test]
fn strokes_have_to_be_as_long_as_the_lag_asks() {
    // Buffer and loop are taken for a loop of 13/s, which needs 1.11 s.
    let once = || run(|_| drive(15, 0, 10, 100), 1.1, 1);
    let untold = |mut strokes: Vec<Vec<Sample>>| {
        strokes
            .iter_mut()
            .flatten()
            .for_each(|sample| sample.following = None);
        strokes
    };
    let told = look(&[untold(once()), untold(once())], &[], &known(0, 0, 100)).unwrap_err();
    assert!(matches!(told, Refusal::NotSettled { .. }), "{told:?}");
}

/// 100 nm an increment; the lead of a drive of 30/s that is taken off makes steps differ by more than one of them.
#[test]
fn targets_that_lead_go_on_at_one_speed() {
    const INCREMENT: f64 = 0.1;
    const KV: f64 = 30.0;
    let lead = 0.5 / (TICK * KV);
    // Setpoints in whole nanometres, at a speed that is none.
    let setpoint = |k: i32| (f64::from(k.max(0)) * 8333.37).round();
    let target = |k: i32| {
        let slope = 3.0 * setpoint(k) - 4.0 * setpoint(k - 1) + setpoint(k - 2);
        ((setpoint(k) + lead * slope) / 1000.0 / INCREMENT).round() * INCREMENT
    };
    let steps: Vec<f64> = (3..400).map(|k| target(k) - target(k - 1)).collect();
    let least = steps.iter().copied().fold(f64::INFINITY, f64::min);
    let most = steps.iter().copied().fold(0.0, f64::max);
    assert!(most - least > 1.5 * INCREMENT, "{least} to {most}");
    let pace = Pace::of(INCREMENT, TICK, Some(KV));
    let mean = |to: i32| pace.at_the_end((3..=to).rev().map(target)).unwrap();
    for to in 40..400 {
        assert!(
            pace.is_one(mean(to), 8.33337) && !pace.rests(mean(to)),
            "{to}"
        );
    }
    assert!(!pace.is_one(mean(40), 8.33337 * 1.02));
    assert!(pace.rests(pace.at_the_end((0..40).map(|_| 0.1)).unwrap()));
    assert_eq!(pace.at_the_end((0..20).map(f64::from)), None);
}
