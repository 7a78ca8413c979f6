//! Drives that limit their targets (9077, 9078): what goes on the wire keeps to it in rapids, cuts and threads, whatever
//! lag is taken off.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::params::{Entry, Params, Part};
use leadscrew_core::units::Axis;
use leadscrew_seed::{amount, volume};
use leadscrew_tests::machine::run;
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

/// An increment of the drives, in nanometres.
const INCREMENT: i64 = 100;

const PROGRAM: &str = "M3 S300\nG0 X40 Z5\nG78 P010360 Q0.1 R0.05 L2 E1.5\n\
    G78 X30 Z-20 R-0.8 P1.2 Q0.8 F2 J1 K2\nG0 X80 Z40\nG98 G1 X70 Z0 F1500\nX71\nG3 X60 Z-12 R13\nG0 X300 Z90\nX20\nM30\n";

/// A machine whose drives lag and limit their targets; one that can work.
fn machine(random: &mut Random, axis: Axis) -> Option<Params> {
    let name = axis.letter() as char;
    let plain = Params::sheets();
    let fastest = plain.rapid(axis).nm_per_min();
    let acceleration = plain.acceleration(axis).nm_per_s2();
    let mut values = vec![
        (format!("9070.{name}"), random.within(60, 400)),
        (format!("9071.{name}"), random.of(&[0, 0, 500, 900])),
    ];
    if random.chance(80) {
        let speed = fastest / 100 * random.within(101, 150);
        values.push((format!("9077.{name}"), speed));
    }
    if random.chance(80) {
        let most = acceleration / 100 * random.within(30, 250);
        values.push((format!("9078.{name}"), most));
    }
    if random.chance(30) {
        values.push((format!("1851.{name}"), 20_000));
    }
    let values: Vec<(&str, i64)> = values
        .iter()
        .map(|(key, raw)| (key.as_str(), *raw))
        .collect();
    let params = with(&values);
    params.validate().is_ok().then_some(params)
}

/// The largest speed (nm/ms) and acceleration (nm/ms²) of targets.
fn most(targets: &[i64]) -> [i64; 2] {
    let speed = targets.windows(2).map(|two| (two[1] - two[0]).abs());
    let bend = targets
        .windows(3)
        .map(|three| (three[2] - 2 * three[1] + three[0]).abs());
    [speed.max().unwrap_or(0), bend.max().unwrap_or(0)]
}

/// The parameters of a case, and the targets around the fastest.
fn told(params: &Params, axis: Axis, targets: &[i64]) -> String {
    let values = [9070, 9071, 9077, 9078, 1851].map(|number| {
        let entry = Entry::find(number, Some(Part::Axis(axis)));
        (number, entry.map(|entry| params.get(entry)))
    });
    let at = (1..targets.len()).max_by_key(|at| (targets[*at] - targets[at - 1]).abs());
    let from = at.unwrap_or(0).saturating_sub(30);
    let around: Vec<i64> = targets.iter().skip(from).take(60).copied().collect();
    format!("{values:?}; {at:?}: {around:?}")
}

#[test]
fn targets_keep_to_what_their_drive_takes() {
    volume(0x9077, |seed| {
        let mut random = Random(seed);
        let (mut run_through, mut lowered) = (0, 0);
        for round in 0..amount(12, 150) {
            let axis = random.of(&[Axis::X, Axis::Z]);
            let Some(params) = machine(&mut random, axis) else {
                continue;
            };
            let mut targets = Vec::new();
            let ran = run(PROGRAM, &params, &PlantOptions::default(), |sim, _| {
                targets.push(sim.plant().place(&params, axis).expect("within its counts"));
            });
            if ran.alarm.is_some() {
                // Too little is left for a thread.
                continue;
            }
            run_through += 1;
            let [speed, bend] = most(&targets);
            let takes = params.drive_max_speed(axis).nm_per_min() / 60_000;
            assert!(
                takes == 0 || speed <= takes + INCREMENT,
                "{round}: {axis:?} {speed} of {takes} nm/ms, {}",
                told(&params, axis, &targets)
            );
            let takes = params.drive_max_acceleration(axis).nm_per_s2() / 1_000_000;
            assert!(
                takes == 0 || bend <= takes + 2 * INCREMENT,
                "{round}: {axis:?} {bend} of {takes} nm/ms², {}",
                told(&params, axis, &targets)
            );
            let (plain, left) = (params.jerk(axis), params.motion_jerk(axis));
            lowered += u32::from(left.nm_per_s3() < plain.nm_per_s3() * 9 / 10);
        }
        assert!(lowered * 3 > run_through, "{lowered} of {run_through}");
        assert!(run_through > 3, "{run_through}");
    });
}

/// Without the parameters the same targets are faster than the axis: the test above asks for something.
#[test]
fn a_lag_that_is_taken_off_makes_targets_faster_than_their_axis() {
    let params = with(&[("9070.Z", 150)]);
    let mut targets = Vec::new();
    let ran = run(PROGRAM, &params, &PlantOptions::default(), |sim, _| {
        targets.push(
            sim.plant()
                .place(&params, Axis::Z)
                .expect("within its counts"),
        );
    });
    assert_eq!(ran.alarm, None);
    let [speed, bend] = most(&targets);
    let axis = params.rapid(Axis::Z).nm_per_min() / 60_000;
    assert!(speed > axis + axis / 10, "{speed} of {axis}");
    let axis = params.acceleration(Axis::Z).nm_per_s2() / 1_000_000;
    assert!(bend > 2 * axis, "{bend} of {axis}");
}
