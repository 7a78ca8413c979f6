//! Hard limit switches and homing: the switch that is sought stops nothing, any other one does.

use leadscrew_board_sim::plant::{HomingOptions, Trouble};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::params::{Contact, Params};
use leadscrew_core::units::{Axes, Axis};
use leadscrew_tests::params::with;

use crate::bench::{Bench, MARK, SWITCHES, params_and};
use crate::switches::{EDGE, judge_targets, with_options};

const X: Axes = Axes::NONE.with(Axis::X);

fn hit(bench: &Bench, side: u8, what: &str) {
    let alarm = bench.alarm(what);
    assert_eq!(alarm.code, Code::HardLimit, "{what}");
    assert_eq!(
        alarm.args[..2],
        [Arg::Letter(b'X'), Arg::Letter(side)],
        "{what}"
    );
}

/// X's reference switch is this limit switch.
fn by_board(input: i64, towards: i64) -> Params {
    let key = if towards == 1 { "9065.X" } else { "9064.X" };
    with(&[
        ("9050.X", 2),
        ("9051.X", input),
        ("9052.X", towards),
        ("9058.X", MARK),
        ("9061.X", 30_000),
        (key, input),
    ])
}

/// The board looks for the very limit switch, at an input and at the drive; from off it and from on it.
#[test]
fn the_switch_that_the_board_looks_for_stops_nothing() {
    for (input, towards) in [(5, 1), (5, 0), (33, 0), (34, 1)] {
        for far in [300_000, 100, -30_000] {
            let what = format!("{input} {towards} {far}");
            let place = EDGE + if towards == 1 { -far } else { far };
            let options = match input {
                33 => HomingOptions {
                    negative: EDGE,
                    ..HomingOptions::FAR
                },
                34 => HomingOptions {
                    positive: EDGE,
                    ..HomingOptions::FAR
                },
                _ => HomingOptions::FAR,
            };
            let mut bench = with_options(&by_board(input, towards), options, place, 777);
            bench.home_x(&what);
            judge_targets(&bench, &what);
            // It has gone off the switch, which then stops the axis as any other.
            for _ in 0..100 {
                bench.tick();
            }
            assert_eq!(bench.state(), State::Idle, "{what}");
            if input == 5 {
                bench.sim.around().set(Contact::new(5).unwrap(), Some(true));
                for _ in 0..5 {
                    bench.tick();
                }
                hit(&bench, if towards == 1 { b'+' } else { b'-' }, &what);
            }
        }
    }
}

/// The other switch stops the search, and refuses one towards it.
#[test]
fn another_switch_stops_the_search() {
    let params = with(&[
        ("9050.X", 2),
        ("9051.X", 5),
        ("9058.X", MARK),
        ("9061.X", 30_000),
        ("9065.X", 6),
    ]);
    let mut bench = with_options(&params, HomingOptions::FAR, EDGE - 300_000, 777);
    bench.home(X);
    for _ in 0..800 {
        bench.tick();
    }
    assert_eq!(bench.state(), State::Homing);
    bench.sim.around().set(Contact::new(6).unwrap(), Some(true));
    for _ in 0..200 {
        bench.tick();
    }
    hit(&bench, b'+', "on its way");
    judge_targets(&bench, "on its way");
    bench.sim.command(Command::Reset);
    bench.until("up", |bench| bench.state() == State::Idle);
    let place = bench.drive().place();
    bench.events.clear();
    bench.home(X);
    for _ in 0..100 {
        bench.tick();
    }
    assert_eq!((bench.state(), bench.drive().place()), (State::Idle, place));
    let refused =
        |event: &Event| matches!(event, Event::Warning(alarm) if alarm.code == Code::HardLimit);
    assert!(bench.events.iter().any(refused), "{:?}", bench.events);
}

/// Drives home onto their limit switches, turn round at them, and end on one, with each method of the page.
#[test]
fn a_drive_that_homes_looks_after_its_own_switches() {
    let params = params_and(&[("9064.X", 33), ("9065.X", 34)]);
    for method in [1, 2, 7, 10, 11, 14, 17, 18, 19, 23, 26, 27, 30] {
        for place in [0, 350_000, 600_000] {
            let what = format!("method {method} from {place}");
            let mut bench = Bench::with(&params, place, SWITCHES, method);
            bench.until(&what, |bench| bench.state() == State::Idle);
            bench.home(X);
            bench.until(&what, |bench| bench.state() != State::Homing);
            assert_eq!(bench.state(), State::Idle, "{what}: {:?}", bench.events);
            assert!(bench.referenced().contains(Axis::X), "{what}");
        }
    }
}

/// A switch at an input of the board, which the drive does not see, stops its homing.
#[test]
fn a_switch_at_the_board_stops_a_drive_that_homes() {
    let params = params_and(&[("9065.X", 6)]);
    let mut bench = Bench::with(&params, 0, SWITCHES, 24);
    bench.until("up", |bench| bench.state() == State::Idle);
    bench.home(X);
    for _ in 0..300 {
        bench.tick();
    }
    bench.sim.around().set(Contact::new(6).unwrap(), Some(true));
    bench.until("stopped", |bench| matches!(bench.state(), State::Alarm(_)));
    hit(&bench, b'+', "by the board");
    let place = bench.drive().place();
    for _ in 0..100 {
        bench.tick();
    }
    assert_eq!(bench.drive().place(), place);
    bench.sim.command(Command::Reset);
    bench.until("up", |bench| bench.state() == State::Idle);
    bench.home(X);
    for _ in 0..100 {
        bench.tick();
    }
    assert_eq!((bench.state(), bench.drive().place()), (State::Idle, place));
}

/// A drive that stops telling its inputs stops the machine: nobody would know of a switch.
#[test]
fn a_drive_has_to_go_on_telling_its_limit_switches() {
    let params = with(&[("9064.X", 33)]);
    let mut bench = Bench::unprepared(&params, 0, SWITCHES);
    bench.until("up", |bench| bench.state() == State::Idle);
    for _ in 0..500 {
        bench.tick();
    }
    assert_eq!(bench.state(), State::Idle);
    bench.drive().trouble(Trouble::Unreported);
    for _ in 0..60 {
        bench.tick();
    }
    let alarm = bench.alarm("silent");
    assert_eq!(alarm.code, Code::LimitInputsUntold);
    assert_eq!(alarm.args[..1], [Arg::Letter(b'X')]);
}
