//! An axis that finds its reference by a switch that is an input of its drive (60FDh) and that the board looks for.

use leadscrew_board_sim::plant::{HomingOptions, Trouble};
use leadscrew_board_sim::switch;
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, State};
use leadscrew_core::bus::{NmtCommand, NodeId};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axes, Axis};
use leadscrew_seed::{amount, volume};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use crate::bench::{Bench, MARK};
use crate::switches::{EDGE, MARK_SPEED, judge_targets, with_options as with_switches};

/// The home switch, a limit switch, and on which side the axis looks for it.
const WIRED: [(i64, i64); 4] = [(33, 0), (34, 1), (35, 0), (35, 1)];

fn params(input: i64, towards: i64, more: &[(&str, i64)]) -> Params {
    let mut values = vec![
        ("9050.X", 2),
        ("9051.X", input),
        ("9052.X", towards),
        ("9058.X", MARK),
        ("9061.X", 30_000),
    ];
    values.extend_from_slice(more);
    with(&values)
}

/// A machine whose X is at this place, with the switch of its parameters at its drive.
fn at(params: &Params, place: i64, counts_from: i64) -> Bench {
    let fitted = switch(Axis::X, params).expect("a switch at the drive");
    with_switches(params, fitted, place, counts_from)
}

/// Writes objects of X's drive that it takes in pre-operational alone; no SYNC passes meanwhile.
fn set_up(bench: &mut Bench, objects: &[(u16, u8, u8, u32)]) {
    let tell = |bench: &mut Bench, command: NmtCommand| {
        let frame = command.frame(Some(NodeId::DRIVE_X));
        bench.sim.plant().hear(&frame, |_| ());
    };
    tell(bench, NmtCommand::PreOperational);
    for (index, sub, bytes, value) in objects {
        bench.write(*index, *sub, *bytes, *value);
    }
    tell(bench, NmtCommand::Start);
}

/// `far` increments before the switch, as the axis goes to it; negative on it.
fn before(towards: i64, far: i64) -> i64 {
    EDGE + if towards == 1 { -far } else { far }
}

#[test]
fn each_input_on_either_side_from_off_the_switch_and_on_it() {
    for (input, towards) in WIRED {
        for far in [300_000, 15_000, 100, -100, -40_000] {
            let what = format!("input {input} towards {towards}, {far} before it");
            let params = params(input, towards, &[("9055.X", 3_000_000)]);
            let mut bench = at(&params, before(towards, far), -7_654);
            let machine = bench.home_x(&what);
            let off = machine / 100 - bench.drive().place();
            assert!(off.abs() <= 5 * MARK_SPEED, "{what}: {off}");
            let back = (MARK - machine) * if towards == 1 { 1 } else { -1 };
            assert!((back - 3_000_000).abs() <= 100, "{what}: {back}");
            judge_targets(&bench, &what);
            // The drive is never told another mode: it follows its targets all the way.
            assert!(bench.modes.is_empty(), "{what}: {:?}", bench.modes);
        }
    }
}

/// Whenever it begins, and from wherever: the mark moves by no more than the way of a tick at the speed of the mark.
#[test]
fn the_mark_repeats_to_the_way_of_a_tick() {
    volume(0x60FD, |seed| {
        let mut random = Random(seed);
        for statuses in [1, 4] {
            for speed in [1, 5] {
                let (input, towards) = random.of(&WIRED);
                let way = MARK_SPEED * speed;
                let params = params(
                    input,
                    towards,
                    &[
                        ("9021", statuses),
                        ("9054.X", 60_000_000 * speed),
                        // So that it comes to rest anywhere.
                        ("9055.X", 1_234_567),
                    ],
                );
                let start = before(towards, random.within(1, 60_000));
                let mut bench = at(&params, start, random.within(-2_000_000, 2_000_000));
                let mut offs = Vec::new();
                for round in 0..amount(6, 25) {
                    for _ in 0..random.within(0, 17) {
                        bench.tick();
                    }
                    let machine = bench.home_x(&format!("{round}"));
                    offs.push(machine / 100 - bench.drive().place());
                }
                let (low, high) = (offs.iter().min().unwrap(), offs.iter().max().unwrap());
                let what = format!("{input}, status at {statuses}, {way} a tick: {offs:?}");
                assert!(high - low <= way, "{what}");
                // Three looks, and up to a tick on either side of them.
                assert!(offs.iter().all(|off| off.abs() <= 4 * way), "{what}");
            }
        }
    });
}

/// The inputs alone are enough, for the mode is not ordered.
#[test]
fn a_drive_that_tells_its_inputs_alone() {
    let params = params(35, 1, &[]);
    let mut bench = Bench::unprepared(&params, EDGE - 100_000, HomingOptions::FAR);
    let fitted = switch(Axis::X, &params).unwrap();
    bench.drive().set_homing(fitted);
    let objects = [
        (0x1801, 1, 4, 0xC000_0290),
        (0x1A01, 0, 1, 0),
        (0x1A01, 1, 4, 0x60FD_0020),
        (0x1A01, 0, 1, 1),
        (0x1801, 1, 4, 0x4000_0290),
    ];
    set_up(&mut bench, &objects);
    bench.until("up", |bench| bench.state() == State::Idle);
    let machine = bench.home_x("alone");
    let off = machine / 100 - bench.drive().place();
    assert!(off.abs() <= 5 * MARK_SPEED, "{off}");
}

#[test]
fn a_switch_that_stays_on_and_one_that_never_comes() {
    for (home, code) in [
        (
            (HomingOptions::FAR.negative, HomingOptions::FAR.positive),
            Code::HomeSwitchStuck,
        ),
        (HomingOptions::FAR.home, Code::HomeNotFound),
    ] {
        let params = params(35, 1, &[("9062.X", 20_000_000)]);
        let options = HomingOptions {
            home,
            ..HomingOptions::FAR
        };
        let mut bench = with_switches(&params, options, EDGE - 100_000, 0);
        let alarm = bench.fails("no edge");
        assert_eq!(alarm.code, code);
        assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(35)]);
        // All the way that it may go, and no farther.
        let way = bench.drive().place() - (EDGE - 100_000);
        assert_eq!(way.abs(), 200_000, "{code:?}");
        assert!(!bench.referenced().contains(Axis::X));
        judge_targets(&bench, "no edge");
    }
}

/// What the drive has told at power-up does not count: it has to tell now, and again and again.
#[test]
fn a_drive_that_does_not_tell_its_inputs_is_not_moved() {
    let params = params(35, 1, &[]);
    let silent = |bench: &mut Bench| bench.drive().trouble(Trouble::Unreported);
    // On change alone: without an event time nobody knows whether it still lives.
    let on_change = |bench: &mut Bench| set_up(bench, &[(0x1801, 5, 2, 0)]);
    for (name, before_power_up, then) in [
        ("never", true, &silent as &dyn Fn(&mut Bench)),
        ("no more", false, &silent),
        ("on change", true, &on_change),
    ] {
        let mut bench = Bench::unprepared(&params, EDGE - 100_000, HomingOptions::FAR);
        if before_power_up {
            then(&mut bench);
        }
        bench.until("up", |bench| bench.state() == State::Idle);
        for _ in 0..100 {
            bench.tick();
        }
        if !before_power_up {
            then(&mut bench);
        }
        let begun = bench.ticks;
        let alarm = bench.fails(name);
        assert_eq!(alarm.code, Code::HomeInputsUntold, "{name}");
        assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(35)], "{name}");
        assert!(bench.ticks - begun <= 60, "{name}: {}", bench.ticks - begun);
        let moved = bench.places.iter().any(|place| *place != EDGE - 100_000);
        assert!(!moved, "{name}");
    }
}

#[test]
fn a_drive_that_stops_telling_on_the_way_is_stopped() {
    volume(0x1A01, |seed| {
        let mut random = Random(seed);
        for _ in 0..amount(12, 40) {
            let (input, towards) = random.of(&WIRED);
            let params = params(input, towards, &[]);
            let ticks = random.within(1, 2_800);
            let what = format!("input {input}, silent after {ticks}");
            let mut bench = at(&params, before(towards, 150_000), 777);
            bench.home(Axes::NONE.with(Axis::X));
            for _ in 0..ticks {
                bench.tick();
            }
            if bench.state() != State::Homing {
                continue;
            }
            let had_it = bench.referenced().contains(Axis::X);
            bench.drive().trouble(Trouble::Unreported);
            bench.until(&what, |bench| {
                matches!(bench.state(), State::Alarm(_) | State::Idle)
            });
            // The way off the mark may come to its end before.
            if bench.state() != State::Idle {
                assert_eq!(bench.alarm(&what).code, Code::HomeInputsUntold, "{what}");
                assert_eq!(bench.referenced().contains(Axis::X), had_it, "{what}");
            } else {
                assert!(had_it, "{what}");
            }
            let place = bench.drive().place();
            for _ in 0..50 {
                bench.tick();
            }
            assert_eq!(bench.drive().place(), place, "{what}");
            judge_targets(&bench, &what);
            bench.drive().trouble(Trouble::None);
            bench.sim.command(Command::Reset);
            bench.until(&what, |bench| bench.state() == State::Idle);
            let machine = bench.home_x(&what);
            let off = machine / 100 - bench.drive().place();
            assert!(off.abs() <= 5 * MARK_SPEED, "{what}: {off}");
        }
    });
}

#[test]
fn feed_hold_stops_it_anywhere_and_resume_goes_on() {
    let params = params(34, 1, &[("9070.X", 300)]);
    // In the first ticks it waits for the drive, and may not begin to move.
    for first in [1, 8, 400, 1_500, 1_900, 2_400] {
        let mut bench = at(&params, EDGE - 150_000, -12_345);
        bench.home(Axes::NONE.with(Axis::X));
        for _ in 0..first {
            bench.tick();
        }
        bench.sim.command(Command::Hold);
        for _ in 0..150 {
            bench.tick();
        }
        let place = bench.drive().place();
        for _ in 0..200 {
            bench.tick();
        }
        assert_eq!(bench.drive().place(), place, "held after {first}");
        assert_eq!(bench.state(), State::Homing, "held after {first}");
        bench.sim.command(Command::Resume);
        bench.until("resumed", |bench| bench.state() != State::Homing);
        assert_eq!(bench.state(), State::Idle, "{first}: {:?}", bench.events);
        let off = bench.at().x.nm() / 100 - bench.drive().place();
        assert!(off.abs() <= 5 * MARK_SPEED, "{first}: {off}");
        judge_targets(&bench, "hold");
    }
}
