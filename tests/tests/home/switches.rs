//! An axis that finds its reference by a switch at the board.

use leadscrew_board_sim::plant::HomingOptions;
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::params::{Contact, Params};
use leadscrew_core::units::{Axes, Axis};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use crate::bench::{Bench, MARK};
use crate::pitch::{beside_mark, table};

/// The edge of the switch, in increments of 100 nm: where 9058 says that the mark is.
pub const EDGE: i64 = MARK / 100;

/// Towards the mark 1 mm/s: a micrometre, or ten increments, a tick.
pub const MARK_SPEED: i64 = 10;

/// X has its switch at input 5, on the plus side unless told otherwise.
fn params(more: &[(&str, i64)]) -> Params {
    let mut values = vec![
        ("9050.X", 2),
        ("9051.X", 5),
        ("9058.X", MARK),
        ("9061.X", 30_000),
    ];
    values.extend_from_slice(more);
    with(&values)
}

/// A machine whose X is at this place, and whose drive counts from somewhere else.
fn at(params: &Params, place: i64, counts_from: i64) -> Bench {
    with_options(params, HomingOptions::FAR, place, counts_from)
}

/// The same with switches at the drive.
pub fn with_options(
    params: &Params,
    options: HomingOptions,
    place: i64,
    counts_from: i64,
) -> Bench {
    let mut bench = Bench::unprepared(params, place, options);
    // A drive that is switched on counts from where it likes.
    bench.drive().count_from(counts_from);
    bench.drive().restart();
    bench.until("lost", |bench| matches!(bench.state(), State::Alarm(_)));
    bench.sim.command(Command::Reset);
    bench.until("up again", |bench| bench.state() == State::Idle);
    assert_eq!(bench.drive().place(), place);
    // A slide is beside its drive by the error of its pitch, where one is taken off: 450 µm at its last point.
    let beside = bench.at().x.nm() - counts_from * 100;
    assert!(beside.abs() <= 460_000, "{beside}");
    bench.events.clear();
    bench.told.clear();
    bench
}

/// The speed and the acceleration of every target of X are within its limits, and none jumps; in increments, a tick.
pub fn judge_targets(bench: &Bench, what: &str) {
    let targets: Vec<i64> = bench
        .told
        .iter()
        .map(|(_, target, _)| (*target).into())
        .collect();
    for three in targets.windows(3) {
        let [a, b, c] = [three[0], three[1], three[2]];
        // 200 mm/s and 2 m/s²; what makes up for a lag of 1/30 s adds 60 m/s³ over 30. And the rounding of three places.
        assert!((c - b).abs() <= 2_001, "{what}: {three:?}");
        assert!((c - 2 * b + a).abs() <= 42, "{what}: {three:?}");
    }
}

#[test]
fn the_mark_has_the_place_of_9058_from_anywhere_on_the_way() {
    leadscrew_seed::volume(0x0B5E_55ED, |seed| {
        let mut random = Random(seed);
        for round in 0..leadscrew_seed::amount(20, 80) {
            let side = random.sign();
            // 60 mm before the switch to 4 mm on it, and the drive counts from anywhere.
            let start = EDGE + side * random.within(-600_000, 40_000);
            let counts = random.within(-2_000_000, 2_000_000);
            let fast = 60_000_000 * random.within(5, 40);
            let retreat = 100_000 * random.within(0, 80);
            let backlash = random.of(&[0, 30_000]);
            let pitch = random.of(&[0, -37, 300]);
            let values = [
                ("9052.X", i64::from(side > 0)),
                ("9053.X", fast),
                ("9055.X", retreat),
                // What makes up for the lag of a drive has to stay behind when the place changes.
                ("9070.X", random.of(&[0, 300])),
                ("1851.X", backlash),
            ];
            let params = params(&[&values[..], &table(pitch)].concat());
            let what = format!(
                "{round}: side {side}, from {start}, counts {counts}, {fast} nm/min, back {retreat} nm, loose {backlash} nm, pitch {pitch}"
            );
            let mut bench = at(&params, start, counts);
            let machine = bench.home_x(&what);
            // What is put in for backlash counts from the mark on, whatever was before.
            (0..300).for_each(|_| bench.tick());
            // Between the sample of the switch and the status of the drive there are a few ticks, always the same.
            let off = (machine - beside_mark(pitch, machine)) / 100 - bench.drive().place();
            let off_minus = off - backlash / 100;
            assert!(
                off.abs().min(off_minus.abs()) <= 5 * MARK_SPEED,
                "{what}: {off}"
            );
            // It stands off the mark by what 9055 says.
            let back = (MARK - machine) * side;
            assert!((back - retreat).abs() <= 100, "{what}: {back}");
            judge_targets(&bench, &what);
            // Again, and to the same place.
            let again = bench.home_x(&what);
            (0..300).for_each(|_| bench.tick());
            let off_again = (again - beside_mark(pitch, again)) / 100 - bench.drive().place();
            assert!(
                (off - off_again).abs() <= 2 * MARK_SPEED,
                "{what}: {off} {off_again}"
            );
            judge_targets(&bench, &what);
        }
    });
}

/// What makes up for a lag of 1/30 s that the drive has not: the setpoint comes to rest before the mark.
#[test]
fn an_axis_that_stays_at_the_mark_goes_on_to_it() {
    for back in [0, 2_000, 20_000] {
        let params = params(&[("9055.X", back), ("9070.X", 300)]);
        let mut bench = at(&params, EDGE - 300_000, -12_345);
        let machine = bench.home_x("stays");
        assert!((MARK - machine - back).abs() <= 1, "{back}: {machine}");
        judge_targets(&bench, "stays");
    }
}

/// Whatever happens on the way: the axis brakes, is not referenced, and can home again.
#[test]
fn a_cancel_a_reset_and_a_stop_anywhere() {
    let params = params(&[]);
    for (name, command) in [
        ("cancel", Command::Cancel),
        ("reset", Command::Reset),
        ("stop", Command::Stop),
    ] {
        for ticks in [1, 5, 200, 1_200, 1_500, 1_600, 1_800, 2_100] {
            let what = format!("{name} after {ticks}");
            let mut bench = at(&params, EDGE - 150_000, 777);
            bench.home(Axes::NONE.with(Axis::X));
            for _ in 0..ticks {
                bench.tick();
            }
            assert_eq!(bench.state(), State::Homing, "{what}");
            let found = bench.referenced().contains(Axis::X);
            bench.sim.command(command);
            bench.until(&what, |bench| {
                matches!(bench.state(), State::Idle | State::Alarm(_))
            });
            assert_eq!(bench.referenced().contains(Axis::X), found, "{what}");
            let place = bench.drive().place();
            for _ in 0..50 {
                bench.tick();
            }
            assert_eq!(bench.drive().place(), place, "{what}");
            bench.sim.command(Command::Reset);
            for _ in 0..200 {
                bench.tick();
            }
            assert_eq!(bench.state(), State::Idle, "{what}");
            let machine = bench.home_x(&what);
            let off = machine / 100 - bench.drive().place();
            assert!(off.abs() <= 5 * MARK_SPEED, "{what}: {off}");
            judge_targets(&bench, &what);
        }
    }
}

#[test]
fn feed_hold_stops_it_at_any_stage_and_resume_goes_on() {
    // What makes up for a lag is steady only after a run-up: a mark that is taken without it is off.
    let params = params(&[("9070.X", 300)]);
    let mut bench = at(&params, EDGE - 250_000, -12_345);
    bench.home(Axes::NONE.with(Axis::X));
    let mut holds = 0;
    while bench.state() == State::Homing && holds < 100 {
        // The mark is taken in one go, which takes longer than a second.
        for _ in 0..if holds < 15 { 300 } else { 3_000 } {
            bench.tick();
        }
        bench.sim.command(Command::Hold);
        // 10 mm/s are braked within 0.1 s.
        for _ in 0..150 {
            bench.tick();
        }
        let place = bench.drive().place();
        for _ in 0..100 {
            bench.tick();
        }
        assert_eq!(bench.drive().place(), place, "hold {holds}");
        bench.sim.command(Command::Resume);
        holds += 1;
    }
    assert!(holds > 5, "{holds}");
    assert_eq!(bench.state(), State::Idle, "{:?}", bench.events);
    let off = bench.at().x.nm() / 100 - bench.drive().place();
    assert!(off.abs() <= 5 * MARK_SPEED, "{off}");
    judge_targets(&bench, "hold");
}

#[test]
fn a_switch_that_never_comes() {
    // 20 mm at most, and the switch is 40 mm away.
    let params = params(&[("9062.X", 20_000_000)]);
    let mut bench = at(&params, EDGE - 400_000, 0);
    let alarm = bench.fails("far");
    assert_eq!(
        (alarm.code, alarm.args[0]),
        (Code::HomeNotFound, Arg::Letter(b'X'))
    );
    assert_eq!(bench.drive().place(), EDGE - 200_000);
    judge_targets(&bench, "far");
    assert!(!bench.referenced().contains(Axis::X));
}

#[test]
fn a_switch_that_takes_too_long() {
    let params = params(&[("9061.X", 500)]);
    let mut bench = at(&params, EDGE - 400_000, 0);
    let begun = bench.ticks;
    assert_eq!(bench.fails("late").code, Code::HomeNotFound);
    let took = bench.ticks - begun;
    assert!((500..700).contains(&took), "{took}");
    judge_targets(&bench, "late");
}

#[test]
fn a_switch_that_stays_on() {
    let params = params(&[("9062.X", 30_000_000)]);
    let mut bench = at(&params, EDGE - 100_000, 0);
    bench.sim.around().set(Contact::new(5).unwrap(), Some(true));
    let alarm = bench.fails("stuck");
    assert_eq!(alarm.code, Code::HomeSwitchStuck);
    assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(5)]);
    judge_targets(&bench, "stuck");
}

/// Two samples in a row are a disturbance, and end no stage; three would.
#[test]
fn a_disturbance_of_the_input() {
    let params = params(&[]);
    let input = Contact::new(5).unwrap();
    for (ticks, ends) in [(2, false), (3, true)] {
        let mut bench = at(&params, EDGE - 400_000, 0);
        bench.home(Axes::NONE.with(Axis::X));
        for _ in 0..1_000 {
            bench.tick();
        }
        bench.sim.around().set(input, Some(true));
        for _ in 0..ticks {
            bench.tick();
        }
        bench.sim.around().set(input, None);
        bench.until("homed", |bench| bench.state() != State::Homing);
        // A stage that has ended far from the switch does not find it where it was left.
        assert_eq!(bench.state() == State::Idle, !ends, "{:?}", bench.events);
    }
}

/// A cam that is shorter than the way in which the axis brakes: what lies behind it is not taken for the way before it.
#[test]
fn a_switch_that_is_run_over() {
    let params = params(&[("9053.X", 1_800_000_000)]);
    let mut bench = at(&params, EDGE - 100_000, 0);
    bench.home(Axes::NONE.with(Axis::X));
    bench.until("on it", |bench| {
        bench.sim.board().ticker().machine_inputs() == 1 << 4
    });
    let input = Contact::new(5).unwrap();
    for _ in 0..6 {
        bench.tick();
    }
    bench.sim.around().set(input, Some(false));
    bench.until("over it", |bench| {
        matches!(bench.state(), State::Alarm(_) | State::Idle)
    });
    assert_eq!(bench.alarm("over it").code, Code::HomeSwitchStuck);
}

/// Z by its drive, X by its switch, in one order.
#[test]
fn one_axis_by_its_drive_and_the_other_by_its_switch() {
    let params = params(&[("9050.Z", 1), ("9059.X", 2)]);
    let mut bench = at(&params, EDGE - 100_000, 5_000);
    bench.home(Axes::ALL);
    bench.until("both", |bench| bench.state() != State::Homing);
    assert_eq!(bench.state(), State::Idle, "{:?}", bench.events);
    assert_eq!(bench.referenced(), Axes::ALL);
    let warned = bench
        .events
        .iter()
        .any(|event| matches!(event, Event::Warning(_) | Event::Alarm(_)));
    assert!(!warned, "{:?}", bench.events);
}
