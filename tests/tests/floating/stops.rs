//! Reset and emergency stop at any tick: the spindle comes to rest and the axis with it, in the thread it has cut; nothing
//! comes later.

use leadscrew_board_sim::Doing;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::Command;
use leadscrew_core::params::Params;
use leadscrew_tests::machine::{Ran, run};
use leadscrew_tests::params::{set, with};

use super::hole::{Hole, plain};
use super::watch::{depth, judge, locked, tap};

/// Ticks between two that are tried.
fn stride() -> usize {
    leadscrew_seed::amount(23, 5)
}

fn forms() -> [(Hole, i64); 3] {
    let hole = Hole {
        depth: 6_000,
        approach: 1_000,
        dwell: 20,
        ..plain()
    };
    [
        (hole, 0),
        (hole.pecked(2_500, 700), 0),
        (hole.pecked(2_500, 700), 1),
    ]
}

/// The ticks from where the spindle is waited for at R to where the tap is out, and a little beyond.
pub fn ticks_of(hole: &Hole, params: &Params) -> std::ops::Range<u64> {
    let ran = tap(hole, params, &PlantOptions::default());
    let first = locked(&ran).next().expect("a tap").tick;
    let last = locked(&ran).last().expect("a tap").tick;
    first - 100..last + 60
}

/// At rest with the spindle, and for good.
pub fn rests(ran: &Ran, hole: &Hole, params: &Params, tick: u64) {
    judge(ran, hole, params);
    let last = ran.rows.last().expect("rows");
    for row in ran.rows.iter().rev().take(15) {
        assert_eq!(row.position, last.position, "stop at {tick}");
        // Outside the hole the spindle stops by itself.
        let out = depth(last, hole) <= 0;
        assert!(out || row.spindle == last.spindle, "stop at {tick}");
    }
    for row in locked(ran) {
        let error = row.error.expect("locked").nm();
        assert!(
            error.abs() <= 900,
            "stop at {tick}: {error} nm at {}",
            row.tick
        );
    }
}

fn at_any_tick(command: Command, params: &Params) {
    for (hole, deep) in forms() {
        let mut params = params.clone();
        set(&mut params, "5200.5", deep);
        let mut in_the_hole = 0;
        for tick in ticks_of(&hole, &params).step_by(stride()) {
            let ran = run(
                &hole.program(),
                &params,
                &PlantOptions::default(),
                |sim, ticks| {
                    if ticks == tick {
                        sim.command(command);
                    }
                },
            );
            rests(&ran, &hole, &params, tick);
            let last = ran.rows.last().expect("rows");
            let doing = match command {
                Command::Stop => Doing::Alarm,
                _ => Doing::Idle,
            };
            assert_eq!(last.doing, doing, "stop at {tick}");
            if depth(last, &hole) > 0 && last.position.z.nm() < hole.level() - 500_000 {
                in_the_hole += 1;
                // Where the spindle has come to rest: the axis is on the line through the locked part.
                let cut = locked(&ran).last().expect("a tap");
                let lead = hole.lead as f64 * 1000.0;
                let law = |row: &leadscrew_board_sim::Row| {
                    depth(row, &hole) as f64 - row.spindle.raw() as f64 / 2f64.powi(64) * lead
                };
                let bottom = depth(last, &hole) > hole.total() - 50_000;
                assert!(
                    bottom || (law(last) - law(cut)).abs() < 1_800.0,
                    "stop at {tick}"
                );
            }
            // From 500 rpm in 250 ms, and what the tap had left to do is not done.
            let moving = ran
                .rows
                .iter()
                .rposition(|row| row.position != last.position);
            assert!(moving.expect("rows") as u64 <= tick + 420, "stop at {tick}");
        }
        assert!(in_the_hole > 20, "{in_the_hole}");
    }
}

#[test]
fn a_reset_at_any_tick_rests_with_the_spindle() {
    at_any_tick(Command::Reset, &with(&[]));
}

#[test]
fn an_emergency_stop_at_any_tick_rests_with_the_spindle() {
    at_any_tick(Command::Stop, &with(&[]));
}

#[test]
fn a_reset_in_a_feed_hold_leaves_it_where_it_stands() {
    let params = with(&[("5200.6", 1)]);
    let (hole, _) = forms()[1];
    for tick in ticks_of(&hole, &params).step_by(97) {
        let ran = run(
            &hole.program(),
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
