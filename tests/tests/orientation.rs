//! M19: the spindle at an angle. Where it arrives, which way it goes, what it may not exceed, and what keeps it from that.

#![expect(
    clippy::inconsistent_digit_grouping,
    reason = "a row is written by its fields: CCC H OO A II TTTT"
)]

use leadscrew_board_sim::plant::{DriveOptions, PlantOptions, Trouble};
use leadscrew_board_sim::{Row, Sim};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, Event, Inputs, State};
use leadscrew_core::operating::Interlock;
use leadscrew_core::params::Params;
use leadscrew_core::units::Turns;
use leadscrew_tests::machine::{Ran, calls, machine, run, run_calls_on};
use leadscrew_tests::params::with;

/// A turn, as rows have it.
const TURN: i128 = 1 << 64;

/// 0.1°.
const TOLERANCE: i128 = TURN / 3600;

/// How far a spindle is from an angle in thousandths of a degree, either way.
fn off(row: &Row, mdeg: i128) -> i128 {
    let apart = row.spindle.raw() - mdeg * TURN / 360_000;
    (apart.rem_euclid(TURN)).min((-apart).rem_euclid(TURN))
}

/// At power-up the spindle stands at a third of a turn.
fn third() -> PlantOptions {
    PlantOptions {
        angle: Turns::from_raw((1 << 32) / 3),
        ..PlantOptions::default()
    }
}

fn plain(text: &str, params: &Params) -> Ran {
    run(text, params, &third(), |_, _| {})
}

/// The angles that the spindle was told in position mode.
fn told(ran: &Ran) -> Vec<i64> {
    let angles = ran.rows.iter().filter_map(|row| row.spindle_set);
    angles.map(Turns::raw).collect()
}

/// The row in which a line is over: the last one of it.
fn last_of(ran: &Ran, line: u32) -> &Row {
    let mut rows = ran.rows.iter().rev();
    rows.find(|row| row.line == line).expect("the line was run")
}

#[test]
fn it_arrives_from_rest_and_from_any_speed_in_either_sense() {
    let params = with(&[]);
    let words = [
        ("", 0),
        (" R90", 90_000),
        (" R359.5", 359_500),
        (" R-90", 270_000),
        (" R450.", 90_000),
        (" R-725.125", 354_875),
    ];
    for (word, mdeg) in words {
        for before in ["", "M3 S40\nG4 P3000\n", "M4 S1500\nG4 P2000\n"] {
            let ran = plain(&format!("{before}M19{word}\nG4 P300\nM30\n"), &params);
            assert_eq!(ran.alarm, None, "{before}{word}");
            let last = ran.rows.last().expect("rows");
            assert!(off(last, mdeg) <= TOLERANCE, "{before}{word}: {last:?}");
            // It stood there before the next block began.
            let line = before.lines().count() as u32 + 1;
            let over = last_of(&ran, line);
            assert!(off(over, mdeg) <= TOLERANCE, "{before}{word}: {over:?}");
            assert!(over.spindle_set.is_some());
        }
    }
}

/// Half a count of the encoder is the most that hides where the spindle stands.
#[test]
fn the_angle_is_as_exact_as_the_encoder() {
    for counts in [4096, 1800, 10_000] {
        let params = with(&[("3720", counts)]);
        for at in [0, 1, 977, 3210] {
            let options = PlantOptions {
                angle: Turns::from_raw(at * ((1 << 32) / 4321)),
                counter: 123_456,
                ..PlantOptions::default()
            };
            let text = "M3 S200\nG4 P2000\nM19 R123.456\nG4 P100\nM30\n";
            let ran = run(text, &params, &options, |_, _| {});
            assert_eq!(ran.alarm, None);
            let last = ran.rows.last().expect("rows");
            let most = TURN / (2 * i128::from(counts)) + TURN / 1_000_000;
            assert!(off(last, 123_456) <= most, "{counts} {at}: {last:?}");
        }
    }
}

#[test]
fn from_rest_it_goes_the_shorter_way() {
    let params = with(&[]);
    for (from, to, plus) in [
        (0, 170, true),
        (0, 190, false),
        (350, 20, true),
        (20, 350, false),
        (90, 269, true),
        (90, 271, false),
    ] {
        let ran = plain(&format!("M19 R{from}\nM19 R{to}\nM30\n"), &params);
        assert_eq!(ran.alarm, None);
        let second: Vec<_> = ran.rows.iter().filter(|row| row.line == 2).collect();
        let angles: Vec<_> = second.iter().filter_map(|row| row.spindle_set).collect();
        let way = angles[angles.len() - 1] - angles[0];
        assert_eq!(way.raw() > 0, plus, "{from} {to}");
        assert!(way.raw().abs() <= 1 << 31, "{from} {to}");
        let goes_on = |two: &[Turns]| (two[1] - two[0]).raw() * way.raw() >= 0;
        assert!(angles.windows(2).all(goes_on), "{from} {to}");
    }
}

/// Before the index has been seen nothing says where the spindle stands: it is turned past it first, once.
#[test]
fn the_index_is_looked_for_once() {
    let params = with(&[]);
    let ran = plain("M19 R10\nM19 R20\nM30\n", &params);
    assert_eq!(ran.alarm, None);
    let angles = told(&ran);
    let way = angles.iter().max().unwrap() - angles.iter().min().unwrap();
    assert!(way > 1 << 32 && way < 2 << 32, "{way}");
    let line_2 = ran.rows.iter().filter(|row| row.line == 2);
    let angles: Vec<_> = line_2.filter_map(|row| row.spindle_set).collect();
    assert!((angles[angles.len() - 1] - angles[0]).raw().abs() < 1 << 28);

    let mut sim = machine(&params, &third());
    sim.plant().encoder().break_index(true);
    let ran = run_calls_on(sim, calls("M19 R10\nM30\n", &params), |_, _| {});
    assert_eq!(ran.alarm.map(|alarm| alarm.code), Some(Code::NoIndex));
}

#[test]
fn it_stays_in_position_mode_until_the_spindle_is_told_a_speed() {
    let params = with(&[]);
    for (ends, stays) in [("M3 S100", false), ("M5", false), ("G0 X50", true)] {
        let text = format!("M19 R90\nG0 X40\nG1 X30 F500\n{ends}\nG4 P3000\nM30\n");
        let ran = plain(&text, &params);
        assert_eq!(ran.alarm, None);
        let at = |line| ran.rows.iter().filter(move |row| row.line == line);
        assert!(at(3).count() > 0 && at(3).all(|row| row.spindle_set.is_some()));
        let behind = at(5).next_back().expect("a dwell");
        assert_eq!(behind.spindle_set.is_some(), stays, "{ends}");
        assert_eq!(behind.is_rigid(), stays, "{ends}");
    }
    // A rigid hole takes the spindle from there.
    let ran = plain(
        "M19 R90\nG0 X0 Z5\nM29 S300\nG84 Z-5 F1\nG80\nM30\n",
        &params,
    );
    assert_eq!(ran.alarm, None);
}

/// A lagging drive is there when it says so, and not when it was told so.
#[test]
fn it_waits_for_the_drive() {
    let params = with(&[("1828.C", 100_000)]);
    let options = PlantOptions {
        drives: DriveOptions {
            lag: 120,
            ..DriveOptions::default()
        },
        ..third()
    };
    let ran = run("M19 R90\nM19 R200\nM30\n", &params, &options, |_, _| {});
    assert_eq!(ran.alarm, None);
    let second: Vec<_> = ran.rows.iter().filter(|row| row.line == 2).collect();
    let there = |row: &&&Row| off(row, 200_000) <= TOLERANCE;
    let standing = second.iter().rev().take_while(there).count();
    assert!(standing >= 50, "{standing}");
}

#[test]
fn speed_acceleration_and_jerk_are_within_the_spindle_s() {
    leadscrew_seed::volume(19, |seed| {
        let mut random = leadscrew_seed::Random(seed);
        let mut below = |bound| random.below(bound);
        for _ in 0..6 {
            let tick_us = [500, 1000, 2000, 4000][below(4) as usize];
            let ramp_ms = 50 + below(3000) as i64;
            let most = 20 + below(3000) as i64;
            let params = with(&[
                ("9000", tick_us),
                ("9004", ramp_ms),
                ("3772", most),
                ("5261", [0, 700][below(2) as usize]),
            ]);
            let mut text = String::new();
            for _ in 0..4 {
                text += &format!("M19 R{}.{:03}\n", below(360), below(1000));
            }
            let ran = plain(&(text.clone() + "M30\n"), &params);
            assert_eq!(ran.alarm, None, "{text}");
            let slower = ramp_ms.max([0, 700][usize::from(params.tap_ramp_ms() != 0)]);
            // In 2⁻³² turns a tick, tick², tick³; and what rounding adds to a difference.
            let tick = i128::from(tick_us);
            let turn = 1_i128 << 32;
            let speed = turn * i128::from(most.min(60)) * tick / 60_000_000 + 8;
            let acceleration = turn * tick * tick / (60_000_000 * i128::from(slower)) + 16;
            let jerk = acceleration * tick / 50_000 + 32;
            let angles = told(&ran);
            let differences = |of: &[i64]| of.windows(2).map(|two| two[1] - two[0]).collect();
            let first: Vec<i64> = differences(&angles);
            let second: Vec<i64> = differences(&first);
            let third: Vec<i64> = differences(&second);
            for (what, found, most) in [
                ("speed", first, speed),
                ("acceleration", second, acceleration),
                ("jerk", third, jerk),
            ] {
                let worst = found
                    .iter()
                    .map(|step| i128::from(step.abs()))
                    .max()
                    .unwrap();
                assert!(
                    worst <= most,
                    "{what} {worst} above {most}: {tick_us} {ramp_ms} {text}"
                );
                // It does not creep either.
                assert!(
                    what != "speed" || worst * 20 > most,
                    "{what}: {worst} of {most}"
                );
            }
        }
    });
}

#[test]
fn a_spindle_that_does_not_move_is_an_alarm_in_time() {
    let params = with(&[]);
    for (to, code) in [(40, Code::SpindleNotOriented), (170, Code::SpindleStands)] {
        let text = format!("M19 R0\nG4 P200\nM19 R{to}\nM30\n");
        let mut stuck_at = None;
        let ran = run(&text, &params, &third(), |sim, tick| {
            let line = sim.board().ticker().executor().spindle().is_some();
            if line && stuck_at.is_none() && is_dwelling(sim) {
                sim.plant().spindle_drive().trouble(Trouble::Stuck);
                stuck_at = Some(tick);
            }
        });
        let alarm = ran.alarm.expect("an alarm");
        assert_eq!(alarm.code, code, "{alarm:?}");
        if code == Code::SpindleNotOriented {
            assert_eq!(alarm.span.line, 3);
            let Arg::Angle(should) = alarm.args[1] else {
                panic!("{alarm:?}");
            };
            assert!((should.udeg() - 40_000_000).abs() < 10);
            // The patience that a speed has.
            let waited = ran.rows.iter().filter(|row| row.line == 3).count();
            assert!((4000..6000).contains(&waited), "{waited}");
        }
    }
}

fn is_dwelling(sim: &Sim) -> bool {
    let ticker = sim.board().ticker();
    matches!(ticker.state(), State::Running)
        && !ticker.executor().is_free()
        && !ticker.executor().is_orienting()
}

/// A reset and a stop at any time of the way: the spindle is braked within its limits, and turns again after it.
#[test]
fn a_reset_and_a_stop_on_the_way_brake_it() {
    let params = with(&[]);
    for command in [Command::Reset, Command::Stop] {
        for after in (0..900).step_by(75) {
            let mut began = None;
            let ran = run("M19 R0\nM19 R170\nM30\n", &params, &third(), |sim, tick| {
                let line = sim.board().ticker().executor().is_orienting();
                if line && began.is_none() && sim.board().ticker().observer().indexed() {
                    began = Some(tick);
                }
                if began.is_some_and(|began| tick == began + after) {
                    sim.command(command);
                }
            });
            let stopped = matches!(command, Command::Stop);
            let code = ran.alarm.map(|alarm| alarm.code);
            assert_eq!(code, stopped.then_some(Code::EmergencyStop));
            let reset = ran.events.contains(&Event::Reset);
            assert!(stopped || reset, "{after}");
            let angles = told(&ran);
            let first: Vec<_> = angles.windows(2).map(|two| two[1] - two[0]).collect();
            let change = first.windows(2).map(|two| (two[1] - two[0]).abs()).max();
            let most = (1_i64 << 32) / (60 * 500) + 16;
            assert!(change.unwrap() <= most, "{after}: {change:?} {most}");
            assert_eq!(first.last(), Some(&0), "{after}");
            assert!(ran.rows.last().is_some_and(Row::is_rigid), "{after}");
        }
    }
    // After a reset it turns, and is oriented again.
    let mut sim = machine(&params, &third());
    let mut done = false;
    let ran = run_calls_on(
        {
            let mut ticks = 0;
            let mut calls = calls("M19 R170\nM30\n", &params).into_iter().peekable();
            while !done {
                while calls.peek().is_some_and(|call| sim.offer(call)) {
                    calls.next();
                }
                sim.step();
                ticks += 1;
                if ticks == 900 {
                    sim.command(Command::Reset);
                }
                done = ticks > 3000;
            }
            sim
        },
        calls("M3 S100\nG4 P2000\nM19 R30\nM30\n", &params),
        |_, _| {},
    );
    assert_eq!(ran.alarm, None);
    let turns = |row: &Row| row.line == 2 && row.spindle_set.is_none();
    assert!(ran.rows.iter().any(turns));
    assert!(off(ran.rows.last().expect("rows"), 30_000) <= TOLERANCE);
}

/// Inputs 1, 2 and 3 are door, chuck and its pressure.
fn guarded() -> Params {
    with(&[("9423", 1), ("9424", 2), ("9425", 3)])
}

fn pins(levels: u16) -> Inputs {
    Inputs {
        machine: Some(levels),
        ..Inputs::default()
    }
}

#[test]
fn the_door_the_chuck_and_its_pressure_keep_it_from_turning() {
    let params = guarded();
    for (pin, by) in [
        (0b001, Interlock::Door),
        (0b010, Interlock::Chuck),
        (0b100, Interlock::ChuckPressure),
    ] {
        // It was open before the program came.
        let mut sim = machine(&params, &third());
        for _ in 0..200 {
            sim.set_pins(pins(0b111 & !pin));
            sim.step();
        }
        let ran = run_calls_on(sim, calls("M19 R90\nM30\n", &params), |sim, _| {
            sim.set_pins(pins(0b111 & !pin));
        });
        let alarm = ran.alarm.expect("refused");
        assert_eq!(
            (alarm.code, alarm.args[0]),
            (Code::Interlocked, Arg::Interlock(by))
        );
        assert_eq!(told(&ran), [0_i64; 0]);

        // On the way.
        let mut began = None;
        let ran = run("M19 R90\nM30\n", &params, &third(), |sim, tick| {
            if sim.board().ticker().executor().is_orienting() {
                began = began.or(Some(tick));
            }
            let gone = began.is_some_and(|began| tick > began + 200);
            sim.set_pins(pins(if gone { 0b111 & !pin } else { 0b111 }));
        });
        let alarm = ran.alarm.expect("stopped");
        let code = if pin == 1 {
            Code::Interlocked
        } else {
            Code::ClampingLost
        };
        assert_eq!((alarm.code, alarm.args[0]), (code, Arg::Interlock(by)));
        let angles = told(&ran);
        assert_eq!(angles[angles.len() - 1], angles[angles.len() - 2]);
        let way = angles[angles.len() - 1] - angles[0];
        assert!(way > 0 && way < 1 << 31, "{way}");

        // At its angle, standing, all of them may be opened.
        let mut dwelt = 0;
        let text = "M19 R90\nG4 P2000\nM30\n";
        let ran = run(text, &params, &third(), |sim, _| {
            dwelt += u32::from(is_dwelling(sim));
            let opened = dwelt > 1 && pin != 0b001;
            sim.set_pins(pins(if opened { 0b111 & !pin } else { 0b111 }));
        });
        assert_eq!(ran.alarm, None, "{by:?}");
        assert!(dwelt > 1990, "{dwelt}");
    }
}

/// Feed hold holds axes; a spindle on its way to an angle is none, and the program waits behind it.
#[test]
fn a_hold_on_the_way_stops_the_program_behind_it() {
    let params = with(&[]);
    let mut began = None;
    let ran = run("M19 R90\nG0 X40\nM30\n", &params, &third(), |sim, tick| {
        if sim.board().ticker().executor().is_orienting() && began.is_none() {
            began = Some(tick);
            sim.command(Command::Hold);
        }
        if began.is_some_and(|began| tick == began + 5000) {
            assert!(matches!(sim.board().ticker().state(), State::Held));
            sim.command(Command::Resume);
        }
    });
    assert_eq!(ran.alarm, None);
    assert!(off(ran.rows.last().expect("rows"), 90_000) <= TOLERANCE);
    assert!(ran.rows.iter().any(|row| row.line == 2));
}

/// It told that it is held at each stage of the way, and was running again in between.
#[test]
fn a_hold_on_the_way_is_told_once() {
    leadscrew_seed::volume(1905, |seed| {
        let mut random = leadscrew_seed::Random(seed);
        for _ in 0..leadscrew_seed::amount(10, 100) {
            let at = random.below(5000);
            let params = with(&[]);
            let (mut held, mut resumed) = (None, false);
            let text = "M19 R90\nM19 R260\nG0 X40\nM30\n";
            let ran = run(text, &params, &third(), |sim, tick| {
                let is_held = sim.board().ticker().state() == State::Held;
                if tick == at {
                    sim.command(Command::Hold);
                }
                if is_held && held.is_none() {
                    held = Some(tick);
                }
                assert!(is_held || held.is_none() || resumed, "held at {at}, {tick}");
                if held.is_some_and(|held| tick == held + 3000) {
                    sim.command(Command::Resume);
                    resumed = true;
                }
            });
            assert_eq!(ran.alarm, None, "{at}");
            let told = ran.events.iter().filter(|event| **event == Event::Held);
            assert_eq!(told.count(), usize::from(held.is_some()), "{at}");
            assert!(off(ran.rows.last().expect("rows"), 260_000) <= TOLERANCE);
        }
    });
}

/// A row of the table of machine functions goes before.
#[test]
fn a_row_of_m19_is_what_it_was() {
    let params = with(&[("9401", 19_1_01_0_00_0000)]);
    let ran = plain("M19\nM30\n", &params);
    assert_eq!(ran.alarm, None);
    assert_eq!(told(&ran), [0_i64; 0]);
}
