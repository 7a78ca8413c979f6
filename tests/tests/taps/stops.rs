//! Reset, emergency stop and drive fault at any tick: axis and spindle stop together, in phase, and nothing comes later.

use leadscrew_board_sim::Doing;
use leadscrew_board_sim::plant::{PlantOptions, Trouble};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::call::TapCall;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Millis};
use leadscrew_tests::machine::{Ran, machine, run_calls};
use leadscrew_tests::params::with;

use super::hole::{bottom, deep, high_speed, program, sheet};
use super::watch::{depth, judge, locked, run, set};

fn forms() -> [TapCall; 3] {
    let hole = TapCall {
        dwell: Millis::new(20),
        ..bottom(sheet(), -4_000)
    };
    [hole, high_speed(hole, 1_500, 400), deep(hole, 1_500, 400)]
}

fn stopped(hole: &TapCall, params: &Params, tick: u64, command: Command) -> Ran {
    run_calls(
        program(&[*hole]),
        params,
        &PlantOptions::default(),
        |sim, ticks| {
            if ticks == tick {
                sim.command(command);
            }
        },
    )
}

/// It rests on the line, and stays where it rests.
fn rests(ran: &Ran, hole: &TapCall, params: &Params, tick: u64) {
    judge(ran, hole, params);
    let last = ran.rows.last().expect("rows");
    let standing = ran.rows.iter().rev().take(15);
    for row in standing {
        assert_eq!(row.position, last.position, "stop at {tick}");
        assert_eq!(row.spindle, last.spindle, "stop at {tick}");
        assert_eq!(row.spindle_set, last.spindle_set, "stop at {tick}");
    }
    // Position mode stays, for the tap may be in its hole.
    if depth(last, hole) > 0 {
        let geared = locked(ran).last().expect("a tap");
        assert_eq!(set(last), set(geared), "stop at {tick}");
        assert_eq!(last.position, geared.position, "stop at {tick}");
    }
}

/// Every tick of a tap in all its forms, or one of a few.
fn at_every_tick(command: Command, params: &Params) {
    for hole in forms() {
        let calm = run(program(&[hole]), params);
        let ticks: Vec<u64> = locked(&calm).map(|row| row.tick).collect();
        let stride = leadscrew_seed::amount(7, 1);
        let mut in_the_hole = 0;
        for tick in ticks.into_iter().step_by(stride) {
            let ran = stopped(&hole, params, tick, command);
            rests(&ran, &hole, params, tick);
            let last = ran.rows.last().expect("rows");
            in_the_hole += usize::from(depth(last, &hole) > 0);
            let doing = match command {
                Command::Stop => Doing::Alarm,
                _ => Doing::Idle,
            };
            assert_eq!(last.doing, doing, "stop at {tick}");
        }
        assert!(in_the_hole * stride > 300, "{in_the_hole}");
    }
}

#[test]
fn reset_at_every_tick_keeps_the_phase() {
    at_every_tick(Command::Reset, &with(&[]));
}

#[test]
fn an_emergency_stop_at_every_tick_keeps_the_phase() {
    at_every_tick(Command::Stop, &with(&[]));
}

#[test]
fn a_reset_in_a_feed_hold_leaves_it_where_it_stands() {
    let params = with(&[("5200.6", 1)]);
    for hole in forms() {
        let calm = run(program(&[hole]), &params);
        let ticks: Vec<u64> = locked(&calm).map(|row| row.tick).collect();
        for tick in ticks.into_iter().step_by(17) {
            let ran = run_calls(
                program(&[hole]),
                &params,
                &PlantOptions::default(),
                |sim, ticks| {
                    if ticks == tick {
                        sim.command(Command::Hold);
                    }
                    if ticks == tick + 600 {
                        sim.command(Command::Reset);
                    }
                },
            );
            rests(&ran, &hole, &params, tick);
            assert_eq!(ran.rows.last().expect("rows").doing, Doing::Idle);
        }
    }
}

/// A fault of the axis' drive, of another axis' drive, of the spindle's: an alarm that names it. What still follows stops
/// on its path.
#[test]
fn a_drive_that_fails_in_the_hole_stops_the_others() {
    let params = with(&[]);
    let hole = forms()[0];
    let calm = run(program(&[hole]), &params);
    let ticks: Vec<u64> = locked(&calm).map(|row| row.tick).collect();
    for tick in ticks.into_iter().step_by(61) {
        let ran = run_calls(
            program(&[hole]),
            &params,
            &PlantOptions::default(),
            |sim, ticks| {
                if ticks == tick {
                    sim.plant().drive(Axis::X).trouble(Trouble::Fault(0x3210));
                }
            },
        );
        assert_eq!(ran.alarm.map(|alarm| alarm.number()), Some(4357));
        rests(&ran, &hole, &params, tick);

        let ran = run_calls(
            program(&[hole]),
            &params,
            &PlantOptions::default(),
            |sim, ticks| {
                if ticks == tick {
                    sim.plant().spindle_drive().trouble(Trouble::TorqueOff);
                }
            },
        );
        assert!(ran.alarm.is_some(), "fault at {tick}");
        let last = ran.rows.last().expect("rows");
        // Its angle is lost: no commanded angle any more.
        assert_eq!(last.spindle_set, None);
        assert!(depth(last, &hole) <= 4_000_000);
    }
}

/// A spindle that does not turn with its tap is an alarm that names its drive. When it comes loose it stays where it is:
/// nobody tells it to be elsewhere any more, and the reset does not either.
#[test]
fn a_spindle_that_stands_in_the_hole_is_an_alarm_and_does_not_leap() {
    let params = with(&[]);
    let hole = forms()[0];
    let calm = run(program(&[hole]), &params);
    let ticks: Vec<u64> = locked(&calm).map(|row| row.tick).collect();
    // In the last quarter there may be too little left to turn.
    let places = ticks.iter().take(ticks.len() * 3 / 4).step_by(97);
    for &tick in places {
        let mut sim = machine(&params, &PlantOptions::default());
        let mut waiting = program(&[hole]).into_iter().peekable();
        let mut alarm = None;
        for ticks in 0.. {
            assert!(ticks < 10_000, "stuck at {tick}: no alarm");
            while waiting.peek().is_some_and(|call| sim.offer(call)) {
                waiting.next();
            }
            if ticks == tick {
                sim.plant().spindle_drive().trouble(Trouble::Stuck);
            }
            sim.step();
            while let Some(event) = sim.event() {
                if let Event::Alarm(told) = event {
                    alarm = alarm.or(Some(told));
                }
            }
            if let State::Alarm(_) = sim.board().ticker().state() {
                break;
            }
        }
        assert_eq!(alarm.map(|alarm| alarm.number()), Some(4387), "{tick}");
        // As long as it takes to hear that its drive has let it go.
        for _ in 0..20 {
            sim.step();
        }
        let stands = sim.plant().truth().angle;
        sim.plant().spindle_drive().trouble(Trouble::None);
        for ticks in 0..1_000 {
            if ticks == 500 {
                sim.command(Command::Reset);
            }
            sim.step();
            assert_eq!(sim.plant().truth().angle, stands, "stuck at {tick}");
        }
        assert_eq!(sim.board().ticker().state(), State::Idle);
    }
}
