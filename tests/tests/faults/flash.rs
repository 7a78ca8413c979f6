//! Flash that can no longer be written: from a certain write on, or because its pages are worn.

use leadscrew_board_sim::line::Faults;
use leadscrew_board_sim::plant::Flash;
use leadscrew_core::board::State;
use leadscrew_core::params::Params;

use crate::bench::{AnyBench as _, Bench, TAP};

/// Deepest point of the tap axis so far, in nm: 0 is R, below it is the hole.
fn deepest(bench: &Bench, from: usize) -> i64 {
    let positions = bench.rows[from..].iter().map(|row| row.position.z.nm());
    positions.min().unwrap_or(0)
}

#[test]
fn a_hole_is_not_begun_where_its_entry_cannot_be_written() {
    let params = Params::sheets();
    for writes in [0, 1] {
        let what = format!("{writes} writes are possible");
        let mut bench = Bench::at_work(&params, TAP, Faults::NONE);
        bench.sim.flash_mut().fail_after(writes);
        bench.stops_with(&what, 4311, 5_000);
        assert!(deepest(&bench, 0) >= 0, "{what}: in the hole");
        // Whatever is done: no hole without its entry.
        bench.reset(&what);
        let from = bench.rows.len();
        bench.load(TAP);
        bench.stops_with(&what, 4311, 5_000);
        assert!(deepest(&bench, from) >= 0, "{what}: in the hole");
        // Work that needs no entry goes on as before.
        bench.reset(&what);
        bench.next(&what);
    }
}

#[test]
fn worn_pages_are_an_alarm_before_the_hole_that_needs_one_more() {
    let params = Params::sheets();
    let mut bench = Bench::new(&params);
    *bench.sim.flash_mut() = Flash::with_pages(8);
    bench.sim.flash_mut().wear_out_after(1);
    let mut holes = 0;
    loop {
        let from = bench.rows.len();
        bench.load(TAP);
        bench.until("a hole", 20_000, |bench| {
            matches!(bench.state(), State::Alarm(_))
                || bench.waiting.is_empty() && !bench.sim.is_busy()
        });
        if let Some(alarm) = bench.alarm {
            assert_eq!(alarm.number(), 4311);
            assert!(deepest(&bench, from) >= 0, "in the hole");
            break;
        }
        assert!(deepest(&bench, from) < -11_000_000);
        holes += 1;
        assert!(holes < 1_000, "it never wears out");
    }
    // As many as fit into the pages that were there.
    assert!(holes > 20, "{holes}");
    let tap = bench.sim.board().tap_record();
    assert!(
        tap.is_none_or(|tap| !tap.in_hole),
        "none is in a hole: {tap:?}"
    );
}
