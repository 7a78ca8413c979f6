//! Feed hold, single block and override: the tables of the sheet.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::call::{Position, TapCall, TapRepeat};
use leadscrew_core::params::Params;
use leadscrew_core::units::Millis;
use leadscrew_tests::machine::{Pause, Ran, run_calls};
use leadscrew_tests::params::with;

use super::hole::{bottom, deep, high_speed, nm, program, sheet};
use super::watch::{depth, judge, locked, run, set};

/// A hole with a rapid on both sides and a dwell at the bottom.
fn hole() -> TapCall {
    let place = Position {
        z: nm(3_000_000),
        ..Position::ZERO
    };
    TapCall {
        hole: place,
        dwell: Millis::new(40),
        ..bottom(sheet(), -9_000)
    }
}

fn forms() -> [TapCall; 3] {
    [
        hole(),
        high_speed(hole(), 2_500, 700),
        deep(hole(), 2_500, 700),
    ]
}

/// Holds at `tick`, resumes 150 ticks after the machine says it is held. The row in the middle of the hold comes back.
fn held(hole: &TapCall, params: &Params, tick: u64) -> (Ran, Row) {
    let mut pause = Pause::new(tick, 150);
    let ran = run_calls(
        program(&[*hole]),
        params,
        &PlantOptions::default(),
        |sim, ticks| pause.operate(sim, ticks),
    );
    let rest = pause.since().expect("the machine was held") + 100;
    let row = *ran.rows.iter().find(|row| row.tick == rest).expect("a row");
    (ran, row)
}

/// First and last tick in which the hole is geared.
fn geared(hole: &TapCall, params: &Params) -> (u64, u64) {
    let ran = run(program(&[*hole]), params);
    let ticks: Vec<u64> = locked(&ran).map(|row| row.tick).collect();
    (ticks[0], ticks[ticks.len() - 1])
}

#[test]
fn feed_hold_not_allowed_rests_at_r() {
    let params = with(&[]);
    for hole in forms() {
        let (first, last) = geared(&hole, &params);
        for tick in (first..last).step_by(37) {
            let (ran, rest) = held(&hole, &params, tick);
            assert_eq!(rest.doing, Doing::Hold, "hold at {tick}");
            assert_eq!(depth(&rest, &hole), 0, "hold at {tick}");
            judge(&ran, &hole, &params);
            let end = ran.rows.last().expect("rows").position;
            assert_eq!(end, hole.hole);
        }
    }
}

/// Between two deep pecks the tap is at R: it rests there and goes on with the pecks that are left.
#[test]
fn feed_hold_between_deep_pecks_goes_on_with_the_rest() {
    let params = with(&[]);
    let hole = deep(hole(), 2_500, 700);
    let (first, _) = geared(&hole, &params);
    let (ran, rest) = held(&hole, &params, first + 5);
    assert_eq!(depth(&rest, &hole), 0);
    let before = locked(&ran)
        .filter(|row| row.tick < rest.tick)
        .map(|row| depth(row, &hole))
        .max();
    assert_eq!(before, Some(2_500_000));
    let after = locked(&ran)
        .filter(|row| row.tick > rest.tick)
        .map(|row| depth(row, &hole))
        .max();
    assert_eq!(after, Some(9_000_000));
}

#[test]
fn feed_hold_allowed_rests_at_once_and_in_phase() {
    let params = with(&[("5200.6", 1)]);
    for hole in forms() {
        let (first, last) = geared(&hole, &params);
        for tick in (first..last - 5).step_by(29) {
            let (ran, rest) = held(&hole, &params, tick);
            assert_eq!(rest.doing, Doing::Hold, "hold at {tick}");
            assert!(
                rest.tick < tick + 700,
                "hold at {tick} rests at {}",
                rest.tick
            );
            judge(&ran, &hole, &params);
            // Axis and spindle stand together, and nothing is lost.
            let standing: Vec<&Row> = ran
                .rows
                .iter()
                .filter(|row| (rest.tick - 40..rest.tick + 40).contains(&row.tick))
                .collect();
            assert!(standing.iter().all(|row| row.position == rest.position));
            assert!(standing.iter().all(|row| set(row) == set(&rest)));
            let deepest = locked(&ran).map(|row| depth(row, &hole)).max();
            assert_eq!(deepest, Some(9_000_000), "hold at {tick}");
            assert_eq!(ran.rows.last().expect("rows").position, hole.hole);
        }
    }
}

/// Three blocks with a hole each; stops of single block at which tick, and where.
fn single_block(params: &Params) -> Vec<Position> {
    let holes: Vec<TapCall> = [1, 2, 3]
        .map(|n| TapCall {
            hole: Position {
                x: nm(n * 5_000_000),
                ..hole().hole
            },
            ..hole()
        })
        .into();
    let mut stops = Vec::new();
    let ran = run_calls(
        program(&holes),
        params,
        &PlantOptions::default(),
        |sim, ticks| {
            if ticks == 0 {
                sim.command(Command::SingleBlock(true));
            }
            if ticks % 50 == 0 && sim.board().ticker().state() == State::Held {
                stops.push(sim.board().ticker().executor().position());
                sim.command(Command::Resume);
            }
        },
    );
    assert_eq!(ran.alarm, None);
    assert!(ran.events.contains(&Event::Finished));
    stops
}

#[test]
fn single_block_stops_after_the_last_hole_or_after_each() {
    let at = |n: i64| Position {
        x: nm(n * 5_000_000),
        ..hole().hole
    };
    // After M30 too, as after every block with a function.
    assert_eq!(single_block(&with(&[])), [at(3), at(3)]);
    assert_eq!(
        single_block(&with(&[("5200.6", 1)])),
        [at(1), at(2), at(3), at(3)]
    );
}

#[test]
fn single_block_stops_behind_a_hole_that_ends_at_r() {
    // R at the initial level: there is no move after the extraction.
    let hole = TapCall {
        repeat: TapRepeat::Holes(2.try_into().expect("two")),
        ..bottom(sheet(), -5_000)
    };
    let stops = |params: &Params| {
        let ran = run_calls(
            program(&[hole]),
            params,
            &PlantOptions::default(),
            |sim, ticks| {
                if ticks == 0 {
                    sim.command(Command::SingleBlock(true));
                }
                if ticks % 50 == 0 && sim.board().ticker().state() == State::Held {
                    sim.command(Command::Resume);
                }
            },
        );
        ran.events
            .iter()
            .filter(|event| **event == Event::Held)
            .count()
    };
    assert_eq!(stops(&with(&[])), 2);
    assert_eq!(stops(&with(&[("5200.6", 1)])), 3);
}

#[test]
fn overrides_do_nothing_unless_5203_4_lets_the_feed_override_act() {
    let ticks = |settings: &[(&str, i64)], commands: &[Command]| {
        let params = with(settings);
        let hole = bottom(sheet(), -40_000);
        let ran = run_calls(
            program(&[hole]),
            &params,
            &PlantOptions::default(),
            |sim, ticks| {
                if ticks == 0 {
                    commands.iter().for_each(|command| sim.command(*command));
                }
            },
        );
        judge(&ran, &hole, &params);
        locked(&ran).count()
    };
    let plain = ticks(&[], &[]);
    let commands = [
        Command::FeedOverride(50),
        Command::SpindleOverride(50),
        Command::RapidOverride(25),
    ];
    assert_eq!(ticks(&[], &commands), plain);
    let slow = ticks(&[("5203.4", 1)], &[Command::FeedOverride(50)]);
    let fast = ticks(&[("5203.4", 1)], &[Command::FeedOverride(150)]);
    assert!(slow > plain + 500 && fast < plain, "{slow} {plain} {fast}");
}

/// The override never turns the tap faster than 5241.
#[test]
fn an_override_stays_below_5241() {
    let params = with(&[("5203.4", 1), ("5241", 1200)]);
    let hole = bottom(sheet(), -80_000);
    let ran = run_calls(
        program(&[hole]),
        &params,
        &PlantOptions::default(),
        |sim, ticks| {
            if ticks == 0 {
                sim.command(Command::FeedOverride(150));
            }
        },
    );
    judge(&ran, &hole, &params);
    let rows: Vec<_> = locked(&ran).collect();
    let peak = rows
        .windows(2)
        .map(|rows| (set(rows[1]) - set(rows[0])).raw().abs())
        .max()
        .expect("rows");
    let rpm = peak as f64 / 2f64.powi(32) * 60_000.0;
    assert!((1199.0..=1200.1).contains(&rpm), "{rpm}");
}

/// The spindle turns when rigid mode is asked for: it is stopped first, and taken up where it stands.
#[test]
fn a_turning_spindle_is_brought_to_a_stand_first() {
    use leadscrew_core::alarm::Span;
    use leadscrew_core::call::{Call, CallKind, SpindleCall};
    use leadscrew_core::units::Rpm;
    let params = with(&[]);
    let hole = hole();
    let call = |kind| Call {
        span: Span::default(),
        origin: Position::ZERO,
        kind,
    };
    let mut calls = vec![
        call(CallKind::Spindle(SpindleCall::speed(Rpm::new(-777)))),
        call(CallKind::Dwell(Millis::new(913))),
    ];
    calls.extend(program(&[hole]));
    let ran = run(calls, &params);
    assert_eq!(ran.alarm, None);
    judge(&ran, &hole, &params);
    assert_eq!(
        locked(&ran).map(|row| depth(row, &hole)).max(),
        Some(9_000_000)
    );
    let waiting = ran
        .rows
        .iter()
        .filter(|row| row.doing == Doing::Wait)
        .count();
    // 777 rpm at 500 ms for 1000.
    assert!((380..500).contains(&waiting), "{waiting}");
    // It had turned several times, and the commanded angle is the true one all the same.
    assert!(set(locked(&ran).next().expect("rows")).raw() < -(5 << 32));
}

/// After the holes the spindle is in speed mode and turns as it is told.
#[test]
fn speed_mode_comes_back() {
    use leadscrew_core::alarm::Span;
    use leadscrew_core::call::{Call, CallKind, SpindleCall};
    use leadscrew_core::units::Rpm;
    let params = with(&[]);
    let call = |kind| Call {
        span: Span::default(),
        origin: Position::ZERO,
        kind,
    };
    let mut calls = program(&[hole()]);
    calls.insert(
        2,
        call(CallKind::Spindle(SpindleCall::speed(Rpm::new(300)))),
    );
    calls.insert(3, call(CallKind::Dwell(Millis::new(1000))));
    let ran = run(calls, &params);
    assert_eq!(ran.alarm, None);
    let last = ran
        .rows
        .iter()
        .rev()
        .find(|row| row.doing == Doing::Dwell)
        .expect("a dwell");
    assert_eq!(last.spindle_set, None);
    let before = ran
        .rows
        .iter()
        .find(|row| row.tick + 100 == last.tick)
        .expect("a row");
    let turned = last.spindle.micro_turns() - before.spindle.micro_turns();
    assert!((499_990..=500_010).contains(&turned), "{turned}");
}
