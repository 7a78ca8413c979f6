//! Strokes of G32 and G34 on a whole board: limits, and what hold and reset do to a stroke that has no way back.

use leadscrew_board_sim::Doing;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::{Command, State};
use leadscrew_core::params::Params;
use leadscrew_tests::limits::first_excess;
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
