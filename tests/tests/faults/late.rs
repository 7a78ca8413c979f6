//! Setpoints that leave the board after the SYNC that was to latch them.

use leadscrew_board_sim::line::Faults;
use leadscrew_core::alarm::Arg;
use leadscrew_core::bus::{Object, SdoProtocol};
use leadscrew_core::params::Params;

use crate::bench::{AnyBench as _, Bench, WORK, calm, places, span};
use leadscrew_tests::params::with;

fn late(tick: u64, ticks: u64) -> Faults {
    Faults {
        late: Some(span(tick, ticks)),
        ..Faults::NONE
    }
}

#[test]
fn as_many_as_may_be_late_are_counted_and_told() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        let what = format!("ten late from {tick} on");
        let mut bench = Bench::at_work(&params, WORK, late(tick, 10));
        while !bench.waiting.is_empty() || bench.sim.is_busy() {
            bench.tick();
        }
        assert_eq!(bench.alarm, None, "{what}");
        assert_eq!(bench.sim.harm().late, 10);
        bench.ticks(20);
        assert_eq!(bench.gateway.status.late, 10, "{what}");
        let object = Object::new(0x5001, 6);
        let told = bench
            .gateway
            .read(&mut bench.lathe.sim, object, SdoProtocol::Short);
        assert_eq!(told, Ok(vec![10]), "{what}");
        // Held for one period, then two steps at once; where it ends is exact.
        bench.never_jumps(&what, 0, 2);
        assert_eq!(bench.drives(), [35_000_000, 8_000_000], "{what}");
    }
}

#[test]
fn one_more_within_a_second_is_an_alarm_with_the_figures() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        let what = format!("eleven late from {tick} on");
        let mut bench = Bench::at_work(&params, WORK, late(tick, 11));
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.ticks(10);
        assert_eq!(bench.alarm, None, "{what}");
        let alarm = bench.stops_with(&what, 4372, 3);
        assert_eq!(alarm.args[..2], [Arg::Int(11), Arg::Int(10)], "{what}");
        bench.ticks(1_200);
        bench.reset(&what);
        bench.next(&what);
    }
}

#[test]
fn the_limit_is_a_parameter_and_a_second_is_a_second() {
    let tick = places(&calm(&Params::sheets(), WORK))[2];
    // Twenty in a row: too many for 15, not for 20, and with 0 they are only counted.
    for (limit, alarm) in [(15, true), (20, false), (0, false)] {
        let params = with(&[("9027", limit)]);
        let mut bench = Bench::at_work(&params, WORK, late(tick, 20));
        bench.until("late", tick, |bench| bench.ticks == tick);
        bench.ticks(100);
        assert_eq!(
            bench.alarm.map(|alarm| alarm.number()),
            alarm.then_some(4372),
            "{limit}"
        );
    }
    // Slowly, one after another: six in each second.
    let params = with(&[("9027", 10)]);
    let mut bench = Bench::new(&params);
    bench.load("G98 G1 X200 Z-100 F400\nM30\n");
    for _ in 0..20 {
        let now = bench.ticks;
        bench.sim.spoil(late(now, 6));
        let told = bench.sim.harm().late;
        assert_eq!(told, 0);
        bench.ticks(1_100);
    }
    assert_eq!(bench.alarm, None);
}

#[test]
fn a_machine_at_rest_only_counts_them() {
    let mut bench = Bench::at_work(&Params::sheets(), "", late(10, 400));
    bench.ticks(500);
    assert_eq!(bench.alarm, None);
    assert_eq!(bench.gateway.status.late, 255);
    bench.next("counted");
}
