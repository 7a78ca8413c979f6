//! Feed hold, single block, overrides, and a spindle that stands.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row};
use leadscrew_core::board::{Command, State};
use leadscrew_core::params::Params;
use leadscrew_tests::machine::{Pause, Ran, run};
use leadscrew_tests::params::with;

use super::hole::{Hole, plain};
use super::watch::{depth, judge, locked, tap};

fn forms() -> [(Hole, i64); 3] {
    let hole = Hole {
        dwell: 40,
        ..plain()
    };
    [
        (hole, 0),
        (hole.pecked(4_000, 700), 0),
        (hole.pecked(4_000, 700), 1),
    ]
}

/// Taps with a hold on the way. Gives the tick from which the machine stood, too.
fn paused(hole: &Hole, params: &Params, mut pause: Pause) -> (Ran, Option<u64>) {
    let options = PlantOptions::default();
    let ran = run(&hole.program(), params, &options, |sim, ticks| {
        pause.operate(sim, ticks);
    });
    (ran, pause.since())
}

/// Holds at `tick`, resumes 150 ticks after the machine says it is held. The row in the middle of the hold comes back.
fn held(hole: &Hole, params: &Params, tick: u64) -> (Ran, Row) {
    let (ran, since) = paused(hole, params, Pause::new(tick, 150));
    assert_eq!(ran.alarm, None, "hold at {tick}");
    judge(&ran, hole, params);
    let deepest = ran.rows.iter().map(|row| depth(row, hole)).max();
    assert_eq!(deepest, Some(hole.total()), "hold at {tick}");
    assert_eq!(ran.rows.last().expect("rows").position.z.nm(), 0);
    let rest = since.expect("the machine was held") + 100;
    let row = *ran.rows.iter().find(|row| row.tick == rest).expect("a row");
    (ran, row)
}

/// First and last tick of the hole.
fn span(hole: &Hole, params: &Params) -> (u64, u64) {
    let ran = tap(hole, params, &PlantOptions::default());
    let ticks: Vec<u64> = locked(&ran).map(|row| row.tick).collect();
    (ticks[0], ticks[ticks.len() - 1])
}

#[test]
fn feed_hold_not_allowed_rests_at_r() {
    for (hole, deep) in forms() {
        let params = with(&[("5200.5", deep)]);
        let (first, last) = span(&hole, &params);
        for tick in (first..last).step_by(211) {
            let (ran, rest) = held(&hole, &params, tick);
            assert_eq!(rest.doing, Doing::Hold, "hold at {tick}");
            assert_eq!(depth(&rest, &hole), 0, "hold at {tick}");
            assert!(super::watch::worst(&ran) <= 800);
        }
    }
}

#[test]
fn feed_hold_between_deep_pecks_goes_on_with_the_rest() {
    let params = with(&[("5200.5", 1)]);
    let hole = plain().pecked(4_000, 700);
    let (first, _) = span(&hole, &params);
    let (ran, rest) = held(&hole, &params, first + 5);
    assert_eq!(depth(&rest, &hole), 0);
    let before = ran.rows.iter().filter(|row| row.tick < rest.tick);
    let before = before.map(|row| depth(row, &hole)).max().expect("rows");
    assert!((before - 4_000_000).abs() < 20_000, "{before}");
}

#[test]
fn feed_hold_allowed_rests_with_the_spindle_and_stays_in_the_thread() {
    for (hole, deep) in forms() {
        let params = with(&[("5200.5", deep), ("5200.6", 1)]);
        let (first, last) = span(&hole, &params);
        for tick in (first..last).step_by(173) {
            let (ran, rest) = held(&hole, &params, tick);
            assert_eq!(rest.doing, Doing::Hold, "hold at {tick}");
            // 500 rpm at 500 ms for 1000, and a little.
            assert!(rest.tick < tick + 420, "hold at {tick}: {}", rest.tick);
            let standing = ran
                .rows
                .iter()
                .filter(|row| (rest.tick - 40..rest.tick + 40).contains(&row.tick));
            for row in standing {
                assert!(
                    (row.position.z.nm() - rest.position.z.nm()).abs() < 700,
                    "{row:?}"
                );
                assert_eq!(row.spindle, rest.spindle);
            }
            // The hold may be at the tick of a dwell or outside the locked part; what is locked is on the law.
            assert!(super::watch::worst(&ran) <= 800, "hold at {tick}");
        }
    }
}

/// Ten targets that wait, at 2 ms a tick. A spindle that goes on from a hold in the hole, and brakes soon after that, was
/// foreseen to run past the bottom: the tap ended on 4270.
#[test]
fn a_hold_in_the_hole_does_no_harm_where_the_angle_is_foreseen_for_long() {
    let params = with(&[
        ("5200.6", 1),
        ("5261", 557),
        ("9000", 2_000),
        ("9003.Z", 19_750),
        ("1620.Z", 3_692_000_000),
        ("1622.Z", 70_000_000_000),
    ]);
    let hole = Hole {
        rpm: 660,
        lead: 2_438,
        depth: 2_659,
        ..plain()
    };
    let (first, last) = span(&hole, &params);
    for tick in (first..last).step_by(leadscrew_seed::amount(7, 1)) {
        let (ran, _) = paused(&hole, &params, Pause::new(tick, 50));
        assert_eq!(ran.alarm, None, "hold at {tick}");
        let deepest = ran.rows.iter().map(|row| depth(row, &hole)).max();
        assert_eq!(deepest, Some(hole.total()), "hold at {tick}");
    }
}

#[test]
fn single_block_stops_after_the_hole_only() {
    let params = with(&[]);
    let hole = plain();
    let mut stops = Vec::new();
    let ran = run(
        &hole.program(),
        &params,
        &PlantOptions::default(),
        |sim, ticks| {
            if ticks == 0 {
                sim.command(Command::SingleBlock(true));
            }
            if ticks % 50 == 0 && sim.board().ticker().state() == State::Held {
                stops.push(sim.board().ticker().executor().position().z.nm());
                sim.command(Command::Resume);
            }
        },
    );
    assert_eq!(ran.alarm, None);
    assert!(
        !stops.is_empty() && stops.iter().all(|z| *z == 0),
        "{stops:?}"
    );
}

#[test]
fn overrides_do_not_act_in_the_hole() {
    let params = with(&[]);
    let hole = plain();
    let with = |commands: &[Command], before: bool| {
        let ran = run(
            &hole.program(),
            &params,
            &PlantOptions::default(),
            |sim, _| {
                let inside = sim.board().ticker().executor().is_floating();
                if inside != before {
                    commands.iter().for_each(|command| sim.command(*command));
                }
            },
        );
        assert_eq!(ran.alarm, None);
        judge(&ran, &hole, &params);
        locked(&ran).count()
    };
    let plain = with(&[], false);
    let commands = [
        Command::FeedOverride(50),
        Command::SpindleOverride(50),
        Command::RapidOverride(25),
    ];
    let inside = with(&commands, false);
    let before = with(&commands, true);
    assert_eq!(inside, plain);
    assert!(before.abs_diff(plain) <= 2, "{before} {plain}");
}

/// The alarm comes before action 1: nothing has moved.
#[test]
fn a_standing_spindle_is_an_alarm_before_anything_moves() {
    let params = with(&[]);
    for text in [
        "S500\nG99 X10 G84 Z-20 R-5 F1\nM30\n",
        "M3 S500\nM5\nG99 X10 G84 Z-20 R-5 F1\nM30\n",
        "G99 X10 G84 Z-20 R-5 F1\nM30\n",
    ] {
        let ran = run(text, &params, &PlantOptions::default(), |_, _| {});
        assert_eq!(ran.alarm.map(|alarm| alarm.number()), Some(4060), "{text}");
        let start = ran.rows[0].position;
        assert!(ran.rows.iter().all(|row| row.position == start), "{text}");
    }
    // M05 between two holes.
    let hole = plain();
    let text = format!("M3 S500\n{}\nM5\nX0\nM30\n", hole.block(0));
    let ran = run(&text, &params, &PlantOptions::default(), |_, _| {});
    assert_eq!(ran.alarm.map(|alarm| alarm.number()), Some(4060));
    let bottoms = ran
        .rows
        .iter()
        .filter(|row| depth(row, &hole) == hole.total());
    assert!(bottoms.count() > 1);
    assert_eq!(ran.rows.last().expect("rows").position.z.nm(), 0);
}
