//! A board that loses its power in the middle of its work, and starts again; drives and spindle keep theirs.

use leadscrew_core::board::{Event, State};
use leadscrew_core::bus::NmtState;
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::Gateway;

use crate::bench::{AnyBench as _, Bench, TAP, WORK, calm, places};

/// The power goes after this tick and comes back.
fn restarted(params: &Params, text: &str, tick: u64, off: u32) -> Bench {
    let mut bench = Bench::new(params);
    bench.load(text);
    bench.until("work", tick, |bench| bench.ticks == tick);
    let before = bench.drives();
    bench.waiting.clear();
    bench
        .sim
        .restart_board(params, off)
        .expect("it starts again");
    bench.judge_from_here();
    bench.gateway = Gateway::connect(&mut bench.lathe.sim);
    assert_eq!(
        bench.gateway.heartbeats,
        [NmtState::BootUp],
        "it says that it begins anew"
    );
    // Whatever it was told last and latches with the first SYNC: less than the way of one period.
    let after = bench.drives();
    let rapid = 300_000;
    for (before, after) in before.into_iter().zip(after) {
        assert!(
            (before - after).abs() < rapid,
            "at {tick}: {before}, {after}"
        );
    }
    bench
}

#[test]
fn a_board_that_starts_again_anywhere_has_forgotten_the_program_and_moves_nothing() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        for off in [0, 7, 900] {
            let what = format!("restarted at {tick} after {off}");
            let mut bench = restarted(&params, WORK, tick, off);
            assert_eq!(bench.state(), State::Idle, "{what}");
            bench.drives_stand(&what, 300);
            assert!(!bench.sim.is_busy(), "{what}");
            let at = bench.at();
            for (said, is) in [at.x.nm(), at.z.nm()].into_iter().zip(bench.drives()) {
                assert!((said - is).abs() <= 1_000, "{what}: at {is}, says {said}");
            }
            bench.next(&what);
        }
    }
}

#[test]
fn a_board_that_starts_again_in_a_tap_knows_that_it_is_in_its_hole() {
    let params = Params::sheets();
    let rows = calm(&params, TAP);
    let inside: Vec<u64> = rows
        .iter()
        .filter(|row| row.tap.is_some_and(|tap| tap.depth.nm() > 100_000))
        .map(|row| row.tick)
        .collect();
    for tick in inside.iter().copied().step_by(inside.len() / 7) {
        let what = format!("restarted in a tap at {tick}");
        let mut bench = restarted(&params, TAP, tick, 100);
        bench.drives_stand(&what, 50);
        bench.load("G0 X60\nM30\n");
        bench.stops_with(&what, 4310, 100);
        bench.clear(&what);
        bench.load("G30 P99\nM30\n");
        bench.until(&what, 10_000, |bench| {
            bench.waiting.is_empty() && !bench.sim.is_busy()
        });
        assert_eq!(bench.alarm, None, "{what}");
        assert!(bench.events.contains(&Event::Finished), "{what}");
        assert!(
            bench
                .sim
                .board()
                .tap_record()
                .is_some_and(|tap| !tap.in_hole),
            "{what}"
        );
    }
}
