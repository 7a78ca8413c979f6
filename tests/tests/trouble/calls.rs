//! Calls that come slowly, or to a machine that takes none.

use leadscrew_board_sim::{Doing, Row};
use leadscrew_core::board::Command;
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_tests::bench::{Bench, Lathe, WORK};
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::calls;

use crate::bench::{Recovers, calm};

/// Nobody is in a hurry to hand over: the machine waits, never in the thread, and does the same.
#[test]
fn calls_that_come_slowly_change_nothing_but_the_time() {
    let params = Params::sheets();
    let swift = calm(&params);
    let mut bench = Lathe::new(&params);
    for call in calls(WORK, &params) {
        bench.ticks(700);
        while !bench.sim.offer(&call) {
            bench.tick();
        }
    }
    bench.finish("slow");
    assert_eq!(bench.alarm, None);
    assert_eq!(first_excess(&bench.rows, &params), None);
    let ends = |rows: &[Row]| {
        let mut ends: Vec<(u32, Position)> = Vec::new();
        for row in rows.iter().filter(|row| row.number != 0) {
            match ends.last_mut() {
                Some(last) if last.0 == row.number => last.1 = row.position,
                _ => ends.push((row.number, row.position)),
            }
        }
        ends
    };
    assert_eq!(ends(&swift), ends(&bench.rows));
    let starved: Vec<&Row> = bench
        .rows
        .iter()
        .filter(|row| row.number == 0 && row.doing != Doing::Idle)
        .collect();
    assert!(starved.len() > 100, "{}", starved.len());
    for row in starved {
        assert_eq!(row.doing, Doing::Wait, "at {}", row.tick);
        assert!(row.position.x.nm() == 0 || row.position.x.nm() > 30_000_000);
    }
}

/// Calls that come while the machine is stopping, stands on an alarm, or comes up again are not taken, so that nothing of
/// them is carried out when the alarm is cleared.
#[test]
fn calls_for_a_machine_on_alarm_are_not_taken() {
    let params = Params::sheets();
    let mut bench = Lathe::new(&params);
    bench.load(WORK);
    bench.ticks(100);
    bench.sim.command(Command::Stop);
    bench.tick();
    let offered = calls("G0 X90 Z3\nG0 X91\nM3 S500\nM30\n", &params);
    bench.until_on_alarm("stop", 500);
    for call in &offered {
        assert!(!bench.sim.offer(call), "a call on alarm is taken");
        bench.tick();
    }
    bench.stands("alarm");
    bench.reset("alarm");
    bench.stands("reset");
    bench.next("reset");
}
