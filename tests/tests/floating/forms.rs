//! The hole and its forms: bottom, R and pecks, the law, both hands, both axes.

use leadscrew_board_sim::Doing;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::Event;
use leadscrew_core::units::Turns;
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::{Ran, run};
use leadscrew_tests::params::with;

use super::hole::{Hole, plain};
use super::watch::{depth, locked, rippling, tap, worst};

fn forms() -> [Hole; 3] {
    let hole = Hole {
        dwell: 60,
        ..plain()
    };
    [hole, hole.pecked(2_500, 700), hole.pecked(5_000, 1_000)]
}

/// The depths at which the tap turns round, in nanometres.
fn turning_points(ran: &Ran, hole: &Hole) -> Vec<i64> {
    let mut depths: Vec<i64> = ran.rows.iter().map(|row| depth(row, hole)).collect();
    depths.dedup();
    depths
        .windows(3)
        .filter(|d| (d[1] - d[0]).signum() != (d[2] - d[1]).signum())
        // The sample noise of a standing spindle turns round too.
        .filter(|d| (d[1] - d[0]).abs() + (d[2] - d[1]).abs() > 0)
        .map(|d| d[1])
        .collect()
}

/// Depths at turning points more than 100 µm from the one before.
fn turns(ran: &Ran, hole: &Hole) -> Vec<i64> {
    let mut kept: Vec<i64> = Vec::new();
    for depth in turning_points(ran, hole) {
        if kept
            .last()
            .is_none_or(|last| (last - depth).abs() > 100_000)
        {
            kept.push(depth);
        }
    }
    kept
}

#[test]
fn the_setpoint_is_on_the_measured_law() {
    // Edge times, then counts alone; ripple of 0 and ±10 %. Nanometres at lead 1.25, 500 rpm, 4096 counts: a hole at once,
    // and in pecks, whose spindle is always on a ramp.
    for (edge, percent, once, pecked) in [
        (1, 0, 300, 800),
        (1, 10, 400, 800),
        (0, 0, 400, 750),
        (0, 10, 600, 900),
    ] {
        let params = with(&[("9006.0", edge)]);
        for deep in [0, 1] {
            let params = if deep == 1 {
                with(&[("9006.0", edge), ("5200.5", 1)])
            } else {
                params.clone()
            };
            for hole in forms() {
                let ran = tap(&hole, &params, &rippling(percent));
                assert!(locked(&ran).count() > 2_500, "{hole:?}");
                let worst = worst(&ran);
                let most = if hole.peck.0 == 0 { once } else { pecked };
                assert!(
                    worst <= most,
                    "{worst} nm: edges {edge}, {percent} %, {hole:?}"
                );
            }
        }
    }
}

/// With a steady spindle whose edges are timed, everything keeps speed, acceleration and jerk where the spindle does not
/// lead, the way onto the lead and off it too.
#[test]
fn joining_and_leaving_keep_the_jerk() {
    let params = with(&[]);
    let ran = tap(&plain(), &params, &PlantOptions::default());
    assert_eq!(first_excess(&ran.rows, &params), None);
}

#[test]
fn the_spindle_turns_in_stops_and_turns_out() {
    let params = with(&[]);
    let ran = tap(&plain(), &params, &PlantOptions::default());
    let rows: Vec<_> = locked(&ran).collect();
    let speed = |a: usize| {
        (rows[a + 1].spindle.raw() - rows[a].spindle.raw()) as f64 / 2f64.powi(64) * 60_000.0
    };
    assert!((speed(0) - 500.0).abs() < 1.0, "{}", speed(0));
    assert!((speed(rows.len() - 2) + 500.0).abs() < 1.0);
    // The spindle stands within a hundredth of a turn of where the bottom is: 12 mm / 1.25 mm behind R.
    let line = rows[0];
    let before = line.spindle.turns()
        - Turns::from_raw((i128::from(depth(line, &plain())) * (1 << 32) / 1_250_000) as i64);
    let furthest = ran
        .rows
        .iter()
        .map(|row| row.spindle.turns())
        .max()
        .expect("rows");
    let past = (furthest - before).raw() as f64 / 2f64.powi(32) - 9.6;
    assert!((0.0..0.01).contains(&past), "{past}");
    // And goes on as M03 says when the tap is out.
    let last = ran
        .rows
        .iter()
        .rev()
        .find(|row| row.doing == Doing::Run)
        .expect("rows");
    let end = ran.rows.last().expect("rows");
    assert!(end.spindle.raw() > last.spindle.raw() - (1 << 64));
    assert!(ran.events.contains(&Event::Finished));
}

#[test]
fn pecks_turn_round_where_the_moves_say() {
    // 12 mm in pecks of 5 with a return of 1: 5, 4, 10, 9, 12.
    let hole = plain().pecked(5_000, 1_000);
    let close = |seen: &[i64], wanted: &[i64]| {
        assert_eq!(seen.len(), wanted.len(), "{seen:?}");
        for (seen, wanted) in seen.iter().zip(wanted) {
            assert!(
                (seen - wanted * 1_000_000).abs() < 20_000,
                "{seen} {wanted}"
            );
        }
    };
    let fast = tap(&hole, &with(&[]), &PlantOptions::default());
    close(&turns(&fast, &hole), &[5, 4, 10, 9, 12]);
    let deep = tap(&hole, &with(&[("5200.5", 1)]), &PlantOptions::default());
    close(&turns(&deep, &hole), &[5, 0, 10, 0, 12]);
    // Between two deep pecks the tap is at R exactly.
    let at_r = turns(&deep, &hole);
    assert_eq!((at_r[1], at_r[3]), (0, 0));
}

/// The moves that the rows belong to are those of the list, in their order and without a gap.
#[test]
fn every_move_of_the_list_is_told() {
    for (deep, moves) in [(0, 11), (1, 13)] {
        let params = with(&[("5200.5", deep)]);
        let hole = Hole {
            dwell: 60,
            ..plain()
        }
        .pecked(5_000, 1_000);
        let ran = tap(&hole, &params, &PlantOptions::default());
        let mut numbers: Vec<u32> = ran.rows.iter().map(|row| row.number).collect();
        numbers.retain(|number| *number > 0);
        numbers.dedup();
        assert_eq!(numbers, (1..=moves).collect::<Vec<u32>>());
        let dwelling: Vec<_> = ran
            .rows
            .iter()
            .filter(|row| row.doing == Doing::Dwell)
            .collect();
        assert_eq!(dwelling.len(), 60);
        assert!(dwelling.iter().all(|row| depth(row, &hole) == hole.total()));
    }
}

/// A re-entry falls into the thread that is there: the law of a hole has one origin.
#[test]
fn every_peck_is_in_the_same_thread() {
    let params = with(&[("5200.5", 1)]);
    let hole = plain().pecked(3_000, 500);
    let ran = tap(&hole, &params, &rippling(10));
    let lead = hole.lead as f64 * 1000.0;
    let origin = |row: &leadscrew_board_sim::Row| {
        row.spindle.raw() as f64 / 2f64.powi(64) - depth(row, &hole) as f64 / lead
    };
    let first = origin(locked(&ran).next().expect("locked"));
    for row in locked(&ran) {
        let off = (origin(row) - first) * lead;
        assert!(off.abs() < 1_000.0, "{off} nm at {}", row.tick);
    }
}

#[test]
fn a_left_hand_tap_turns_the_other_way() {
    let params = with(&[]);
    let right = tap(&plain(), &params, &PlantOptions::default());
    let hole = Hole {
        rpm: -500,
        ..plain()
    };
    let left = tap(&hole, &params, &PlantOptions::default());
    assert!(worst(&left) <= 300);
    let way = |ran: &Ran| {
        let rows: Vec<_> = locked(ran).collect();
        (rows[100].spindle.raw() - rows[0].spindle.raw()) >> 50
    };
    assert!(way(&right) > 0 && way(&left) < 0);
    assert_eq!(locked(&right).count() / 20, locked(&left).count() / 20);
}

#[test]
fn a_side_tap_follows_on_x() {
    let params = with(&[]);
    let text = "M3 S400\nG0 X60\nG99 G88 X30 R-5 F1\nG80\nM30\n";
    let ran = run(text, &params, &PlantOptions::default(), |_, _| {});
    assert_eq!(ran.alarm, None);
    assert!(worst(&ran) <= 300);
    let deepest = ran
        .rows
        .iter()
        .map(|row| row.position.x.nm())
        .skip(400)
        .min();
    assert_eq!(deepest, Some(15_000_000));
    assert_eq!(ran.rows.last().expect("rows").position.x.nm(), 30_000_000);
}

/// Several holes in one program: each begins when the spindle turns at S again.
#[test]
fn hole_after_hole() {
    let params = with(&[]);
    let hole = plain();
    let text = format!("M3 S500\n{} K2\nX0 M4\nG80\nM30\n", hole.block(0));
    let ran = run(&text, &params, &PlantOptions::default(), |_, _| {});
    assert_eq!(ran.alarm, None);
    assert!(worst(&ran) <= 400);
    let bottoms = ran
        .rows
        .windows(2)
        .filter(|rows| {
            depth(&rows[0], &hole) < hole.total() && depth(&rows[1], &hole) == hole.total()
        })
        .count();
    assert_eq!(bottoms, 3);
    assert_eq!(ran.rows.last().expect("rows").position.z.nm(), 0);
}

/// 5275: the setpoint is that of so many cycles later.
#[test]
fn the_lag_of_the_axis_is_made_up_for() {
    let hole = plain();
    let at = |lag: i64| {
        let ran = tap(&hole, &with(&[("5275", lag)]), &PlantOptions::default());
        let rows: Vec<_> = locked(&ran).cloned().collect();
        // At S on the way in: how far the axis is ahead of where it is for the angle of its own instant.
        let (a, b) = (&rows[200], &rows[500]);
        let lead = hole.lead as f64 * 1000.0;
        let law = |row: &leadscrew_board_sim::Row| {
            depth(row, &hole) as f64 - row.spindle.raw() as f64 / 2f64.powi(64) * lead
        };
        // Judged by the angle it is meant for.
        assert!(b.error.expect("locked").nm().abs() < 300);
        assert!((law(a) - law(b)).abs() < 600.0);
        // The same hole, on the way out: it is ahead there too.
        let c = &rows[rows.len() - 100];
        law(b) - law(c)
    };
    // 500 rpm · 1.25 mm is 10.4167 µm a tick; twice, for in and out.
    assert!(at(0).abs() < 800.0, "{}", at(0));
    assert!((at(5) - 104_167.0).abs() < 800.0, "{}", at(5));
}
