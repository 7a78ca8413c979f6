//! The board's CAN controller: bus-off and error passive.

use leadscrew_board_sim::line::Faults;
use leadscrew_board_sim::plant::Power;
use leadscrew_core::alarm::Arg;
use leadscrew_core::board::State;
use leadscrew_core::bus::{BusState, Emcy, NmtCommand, NmtState, Order};
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_tests::gateway::NODE;

use crate::bench::{AnyBench as _, Bench, TAP, WORK, calm, from, places, span};

fn bus_off(ticks: leadscrew_board_sim::line::Span) -> Faults {
    Faults {
        bus_off: Some(ticks),
        ..Faults::NONE
    }
}

#[test]
fn bus_off_anywhere_stops_lets_the_drives_go_and_comes_back_saying_so() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        // The line is well again while the machine still stops, or only long after.
        for ticks in [5, 40, 700] {
            let what = format!("bus-off at {tick} for {ticks}");
            let mut bench = Bench::at_work(&params, WORK, bus_off(span(tick, ticks)));
            bench.until(&what, tick, |bench| bench.ticks == tick - 1);
            assert_eq!(bench.alarm, None, "{what}");
            bench.gateway.heartbeats.clear();
            bench.until(&what, 3, |bench| bench.alarm.is_some());
            let mut off = 0;
            while bench.gateway.heartbeats.is_empty() {
                let standing = matches!(bench.state(), State::Alarm(_));
                bench.tick();
                off += 1;
                assert!(off < 2_000, "{what}: never back");
                // No silent rejoin: not before it stands.
                assert!(standing || bench.gateway.heartbeats.is_empty(), "{what}");
            }
            assert!(off >= ticks - 3, "{what}: back after {off}");
            let alarm = bench.stops_with(&what, 4370, 1);
            assert_eq!(alarm.args[..2], [Arg::Int(255), Arg::Int(96)]);
            // What it says then, and in this order.
            assert_eq!(bench.gateway.heartbeats[0], NmtState::BootUp, "{what}");
            let emcy = Emcy {
                code: 0x8140,
                register: 0x81,
                detail: [0x12, 0x11, 255, 96, 0],
            };
            assert_eq!(bench.gateway.emergencies, [emcy], "{what}");
            bench.drives_stand(&what, 300);
            for axis in Axis::ALL {
                assert_eq!(bench.power(axis), Power::Ready, "{what}: {axis:?}");
            }
            // It is to be started by somebody, then reset.
            bench.gateway.order(&mut bench.lathe.sim, Order::Reset);
            bench.ticks(20);
            assert!(
                matches!(bench.state(), State::Alarm(_)),
                "{what}: not started"
            );
            bench.sim.receive(&NmtCommand::Start.frame(Some(NODE)));
            bench.reset(&what);
            bench.next(&what);
        }
    }
}

#[test]
fn bus_off_that_stays_keeps_the_alarm_whatever_is_reset() {
    let params = Params::sheets();
    let tick = places(&calm(&params, WORK))[2];
    let mut bench = Bench::at_work(&params, WORK, bus_off(from(tick)));
    bench.until("bus-off", tick, |bench| bench.ticks == tick);
    bench.stops_with("bus-off", 4370, 3);
    bench.reset_is_in_vain("bus-off");
    bench.reset_is_in_vain("bus-off");
    assert_eq!(bench.gateway.emergencies, [], "nobody hears it");
}

#[test]
fn bus_off_in_a_tap_remembers_the_hole() {
    let params = Params::sheets();
    let rows = calm(&params, TAP);
    let deep = rows
        .iter()
        .filter(|row| row.tap.is_some_and(|tap| tap.depth.nm() > 4_000_000));
    let deep: Vec<u64> = deep.map(|row| row.tick).collect();
    for tick in [deep[0], deep[deep.len() / 3], deep[deep.len() * 3 / 4]] {
        let what = format!("bus-off in a tap at {tick}");
        let mut bench = Bench::at_work(&params, TAP, bus_off(span(tick, 400)));
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.stops_with(&what, 4370, 3);
        bench.ticks(500);
        bench.drives_stand(&what, 100);
        assert!(bench.has_tap_in_hole(), "{what}");
        bench.reset(&what);
        // Nothing else may move.
        bench.load("G0 X60\nM30\n");
        bench.stops_with(&what, 4310, 200);
    }
}

#[test]
fn error_passive_anywhere_is_a_controlled_stop_that_lasts_as_long_as_its_cause() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        let what = format!("error passive at {tick}");
        let faults = Faults {
            error_passive: Some(span(tick, 1_500)),
            ..Faults::NONE
        };
        let mut bench = Bench::at_work(&params, WORK, faults);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let before = bench.stood.len();
        let alarm = bench.stops_with(&what, 4371, 3);
        assert_eq!(alarm.args[..2], [Arg::Int(136), Arg::Int(40)]);
        let [emcy] = bench.gateway.emergencies[..] else {
            panic!("{what}: {:?}", bench.gateway.emergencies);
        };
        assert_eq!((emcy.code, emcy.detail), (0x8120, [0x13, 0x11, 136, 40, 0]));
        // The drives hear how they are braked, and stand where the board says.
        bench.never_jumps(&what, before, 1);
        let (at, drives) = (bench.at(), bench.drives());
        assert!((at.x.nm() - drives[0]).abs() <= 1_000 && (at.z.nm() - drives[1]).abs() <= 1_000);
        bench.reset_is_in_vain(&what);
        bench.until(&what, 2_000, |bench| bench.ticks > tick + 1_500);
        bench.reset(&what);
        assert_eq!(bench.at(), at, "{what}: to the nanometre where it stood");
        bench.next(&what);
    }
}

#[test]
fn an_idle_machine_whose_controller_fails_says_so_too() {
    let mut bench = Bench::at_work(&Params::sheets(), "", bus_off(span(50, 100)));
    bench.ticks(49);
    bench.stops_with("idle", 4370, 5);
    bench.ticks(200);
    assert_eq!(bench.sim.board().device().state(), NmtState::PreOperational);
    assert_eq!(BusState::default(), BusState::Active);
    bench.reset("idle");
    bench.next("idle");
}
