//! Strokes of G32 and G34 on a whole board: limits, and what hold and reset do to a stroke that has no way back.

use leadscrew_board_sim::Doing;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::{Command, State};
use leadscrew_core::params::Params;
use leadscrew_tests::limits::{first_excess, first_excess_with};
use leadscrew_tests::machine::{Ran, run};
use leadscrew_tests::params::with;

/// A thread that grows from X40 to X50 over 30 mm of Z, in a block of this text.
fn program(stroke: &str) -> String {
    format!("M3 S300\nG4 P300\nG0 X40 Z10\n{stroke}\nG0 X60\nZ10\nM30\n")
}

const TAPER: &str = "G32 U10 W-30 F2";
const RUN_OUT: &str = "G32 U10 W-30 F2 J2 K3";
const FALLS: &str = "G32 U-10 W-30 F2 J3 K4";
const VARIABLE: &str = "G34 W-30 F2 K0.1";

fn plain(text: &str, params: &Params) -> Ran {
    run(text, params, &PlantOptions::default(), |_, _| {})
}

/// X on the radius less that of the line, where the tool is beside the stroke, nanometres.
fn beside(x: i64, z: i64, rise: i64) -> i64 {
    let way = (10_000_000 - z).clamp(0, 30_000_000);
    x - 20_000_000 - (way * rise) / 30
}

/// Rise of the line on the radius, in millimetres.
fn rise(stroke: &str) -> i64 {
    match stroke {
        TAPER | RUN_OUT => 5,
        FALLS => -5,
        _ => 0,
    }
}

#[test]
fn strokes_keep_the_limits_and_end_where_their_words_say() {
    let params = Params::sheets();
    for (stroke, x, z) in [
        (TAPER, 25_000_000, -20_000_000),
        (RUN_OUT, 26_500_000, -20_000_000),
        (FALLS, 18_666_667, -20_000_000),
        (VARIABLE, 20_000_000, -20_000_000),
        // Too steep for X at this speed: a move by time makes up for it.
        ("G32 W-30 F4 J2 K1", 22_000_000, -20_000_000),
    ] {
        let ran = plain(&program(stroke), &params);
        assert_eq!(ran.alarm, None, "{stroke}");
        assert_eq!(first_excess(&ran.rows, &params), None, "{stroke}");
        let there = |row: &leadscrew_board_sim::Row| {
            (row.position.x.nm() - x).abs() <= 1 && row.position.z.nm() == z
        };
        assert!(ran.rows.iter().any(there), "{stroke}");
        let worst = ran.rows.iter().filter_map(|row| row.error);
        let worst = worst.map(|error| error.nm().abs()).max();
        assert!(worst.is_some_and(|worst| worst <= 1), "{stroke}: {worst:?}");
    }
}

#[test]
fn a_reset_in_a_stroke_never_leads_into_the_work() {
    let params = Params::sheets();
    for stroke in [TAPER, RUN_OUT, FALLS, VARIABLE] {
        let text = program(stroke);
        let calm = plain(&text, &params);
        let rise = rise(stroke);
        let locked = calm.rows.iter().filter(|row| row.error.is_some());
        for row in locked.step_by(203) {
            let tick = row.tick;
            let ran = run(&text, &params, &PlantOptions::default(), |sim, ticks| {
                if ticks == tick {
                    sim.command(Command::Reset);
                }
            });
            assert_eq!(ran.alarm, None, "{stroke}, reset at {tick}");
            assert_eq!(
                first_excess(&ran.rows, &params),
                None,
                "{stroke}, reset at {tick}"
            );
            let last = ran.rows.last().expect("rows");
            assert_eq!(last.doing, Doing::Idle, "{stroke}, reset at {tick}");
            for row in ran.rows.iter().filter(|row| row.tick >= tick) {
                let out = beside(row.position.x.nm(), row.position.z.nm(), rise);
                assert!(out >= -2, "{stroke}, reset at {tick}: {out}");
            }
            // With a side the tool is out of the thread.
            let out = beside(last.position.x.nm(), last.position.z.nm(), rise);
            let sided = matches!(stroke, RUN_OUT | FALLS);
            assert_eq!(out > 1_000_000, sided, "{stroke}, reset at {tick}: {out}");
        }
    }
}

#[test]
fn a_hold_waits_for_the_end_of_a_stroke() {
    for params in [Params::sheets(), with(&[("9008.0", 1)])] {
        for stroke in [TAPER, RUN_OUT, VARIABLE] {
            let text = program(stroke);
            let calm = plain(&text, &params);
            let locked = calm.rows.iter().filter(|row| row.error.is_some());
            let tick = locked.map(|row| row.tick).nth(300).expect("locked rows");
            let mut resumed = false;
            let mut rest = None;
            let ran = run(&text, &params, &PlantOptions::default(), |sim, ticks| {
                if ticks == tick {
                    sim.command(Command::Hold);
                }
                if ticks > tick && sim.board().ticker().state() == State::Held && !resumed {
                    rest = Some(ticks);
                    resumed = true;
                    sim.command(Command::Resume);
                }
            });
            let rest = rest.expect("the machine was held");
            let row = ran.rows.iter().find(|row| row.tick == rest).expect("a row");
            assert_eq!(row.position.z.nm(), -20_000_000, "{stroke}");
            assert_eq!(first_excess(&ran.rows, &params), None, "{stroke}");
            assert_eq!(
                ran.rows.last().expect("rows").position,
                calm.rows.last().expect("rows").position,
                "{stroke}"
            );
        }
    }
}

/// A chain: straight, a taper, a steeper one with a larger lead, and a face with a run-out.
const CHAIN: &str = "G32 W-15 F2 J3 K2\nU4 W-20\nF2.5 U3 W-5\nG32 U30";

/// Where the line of [`CHAIN`] is at the way `z` from its start (negative), or beyond it along X: X on the radius.
fn on_chain(x: i64, z: i64) -> bool {
    const LINE: [(i64, i64); 5] = [
        (20_000_000, 10_000_000),
        (20_000_000, -5_000_000),
        (22_000_000, -25_000_000),
        (23_500_000, -30_000_000),
        (38_500_000, -30_000_000),
    ];
    // Within what a corner is rounded by; a run-out of 3 mm over the last 2 mm of X.
    LINE.windows(2).any(|ends| {
        let [(x0, z0), (x1, z1)] = [ends[0], ends[1]];
        let (dx, dz) = ((x1 - x0) as f64, (z1 - z0) as f64);
        let (px, pz) = ((x - x0) as f64, (z - z0) as f64);
        let along = ((px * dx + pz * dz) / (dx * dx + dz * dz)).clamp(0.0, 1.0);
        (px - along * dx).hypot(pz - along * dz) < 700_000.0
    }) || x > 36_000_000 && (-30_000_001..=-26_900_000).contains(&z)
}

#[test]
fn a_chain_is_one_thread_without_a_stop() {
    let params = Params::sheets();
    let ran = plain(&program(CHAIN), &params);
    assert_eq!(ran.alarm, None);
    assert_eq!(first_excess(&ran.rows, &params), None);
    let worst = ran.rows.iter().filter_map(|row| row.error);
    let worst = worst.map(|error| error.nm().abs()).max();
    assert!(worst.is_some_and(|worst| worst <= 1), "{worst:?}");
    // One wait, and from then on the tool moves in every tick until it is at the end of the run-out.
    let end = (38_500_000, -27_000_000);
    let at = |row: &leadscrew_board_sim::Row| (row.position.x.nm(), row.position.z.nm());
    let begins = ran
        .rows
        .iter()
        .position(|row| row.error.is_some())
        .expect("a thread");
    let ends = ran
        .rows
        .iter()
        .position(|row| at(row) == end)
        .expect("its end");
    for pair in ran.rows[begins..=ends].windows(2) {
        assert_ne!(
            at(&pair[0]),
            at(&pair[1]),
            "it stands in tick {}",
            pair[1].tick
        );
        assert!(
            on_chain(at(&pair[0]).0, at(&pair[0]).1),
            "{:?}",
            at(&pair[0])
        );
    }
}

#[test]
fn a_reset_or_a_stop_anywhere_in_a_chain_comes_to_rest_on_it() {
    let params = Params::sheets();
    let text = program(CHAIN);
    let calm = plain(&text, &params);
    let locked: Vec<u64> = calm
        .rows
        .iter()
        .skip_while(|row| row.error.is_none())
        .take_while(|row| row.position.x.nm() < 38_000_000)
        .map(|row| row.tick)
        .collect();
    for (nth, tick) in locked.iter().step_by(61).enumerate() {
        let command = if nth % 2 == 0 {
            Command::Reset
        } else {
            Command::Stop
        };
        let ran = run(&text, &params, &PlantOptions::default(), |sim, ticks| {
            if ticks == *tick {
                sim.command(command);
            }
        });
        assert_eq!(
            ran.alarm.is_some(),
            nth % 2 == 1,
            "at {tick}: {:?}",
            ran.alarm
        );
        assert_eq!(
            first_excess_with(&ran.rows, &params, 2.0),
            None,
            "at {tick}"
        );
        let beside = ran.rows.iter().filter_map(|row| row.error);
        let beside = beside.map(|error| error.nm().abs()).max();
        assert!(beside <= Some(1), "at {tick}: {beside:?} nm off the helix");
        let last = ran.rows.last().expect("rows").position;
        let (x, z) = (last.x.nm(), last.z.nm());
        // On the face, the last stroke, a reset leaves to the side of J.
        let is_out =
            command == Command::Reset && x > 23_500_000 && (-27_900_000..=-26_900_000).contains(&z);
        assert!(on_chain(x, z) || is_out, "at {tick}: {last:?}");
    }
}

#[test]
fn hold_and_single_block_wait_for_the_end_of_a_chain() {
    let params = Params::sheets();
    let text = program(CHAIN);
    let calm = plain(&text, &params);
    let tick = calm
        .rows
        .iter()
        .find(|row| row.error.is_some())
        .expect("a thread")
        .tick;
    for command in [Command::Hold, Command::SingleBlock(true)] {
        let mut rests = Vec::new();
        let ran = run(&text, &params, &PlantOptions::default(), |sim, ticks| {
            if ticks == tick + 50 {
                sim.command(command);
            }
            if ticks > tick + 50 && sim.board().ticker().state() == State::Held {
                rests.push(ticks);
                sim.command(Command::Resume);
            }
        });
        let first = *rests.first().expect("the machine was held");
        let row = ran
            .rows
            .iter()
            .find(|row| row.tick == first)
            .expect("a row");
        assert_eq!(
            (row.position.x.nm(), row.position.z.nm()),
            (38_500_000, -27_000_000),
            "{command:?}"
        );
        assert_eq!(first_excess(&ran.rows, &params), None, "{command:?}");
    }
}

#[test]
fn what_a_chain_cannot_be_is_told_before_it_moves() {
    let params = Params::sheets();
    for (stroke, number, line) in [
        // The second stroke is too short for its corners at 300 rpm.
        ("G32 W-15 F5\nU1 W-0.5\nU30", 4265, 5),
        ("G32 W-15 F2\nF40 W-80", 4251, 5),
    ] {
        let ran = plain(&program(stroke), &params);
        let alarm = ran.alarm.expect(stroke);
        assert_eq!(
            (alarm.number(), alarm.span.line),
            (number, line),
            "{stroke}: {alarm:?}"
        );
        let moved = ran
            .rows
            .iter()
            .any(|row| row.position.z.nm() < 10_000_000 && row.position.x.nm() == 20_000_000);
        assert!(!moved, "{stroke}");
    }
}
