//! A cable that comes off and is put back: the board's, or a single drive's.

use leadscrew_board_sim::line::Faults;
use leadscrew_board_sim::plant::{Power, Trouble};
use leadscrew_core::alarm::Arg;
use leadscrew_core::board::State;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_tests::params::with;

use crate::bench::{AnyBench as _, Bench, TAP, WORK, calm, places, span};

/// Out for so long that it is noticed: nothing is pulled to where the board has braked to meanwhile.
#[test]
fn a_cable_out_anywhere_is_a_drive_that_is_silent_and_no_jump_when_it_is_back() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        for ticks in [20, 35, 60, 120, 1_000] {
            let what = format!("cable out at {tick} for {ticks}");
            let faults = Faults {
                cable_out: Some(span(tick, ticks)),
                ..Faults::NONE
            };
            let mut bench = Bench::at_work(&params, WORK, faults);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            let before = bench.stood.len();
            let alarm = bench.stops_with(&what, 4360, 20);
            // Twelve periods, of whichever drive was to be heard first.
            assert_eq!(alarm.args[2], Arg::Int(12), "{what}");
            bench.until(&what, 2_000, |bench| bench.ticks > tick + ticks);
            bench.ticks(50);
            bench.never_jumps(&what, before, 1);
            bench.drives_stand(&what, 100);
            for axis in Axis::ALL {
                assert_ne!(
                    bench.power(axis),
                    Power::Enabled,
                    "{what}: {axis:?} has torque"
                );
            }
            bench.reset(&what);
            bench.next(&what);
        }
    }
}

/// The cable is out for less time than that: positions are absolute, and nothing is lost but time.
#[test]
fn a_loose_contact_that_nobody_notices_loses_nothing() {
    let params = Params::sheets();
    for tick in places(&calm(&params, WORK)) {
        let what = format!("out for 8 at {tick}");
        let faults = Faults {
            cable_out: Some(span(tick, 8)),
            ..Faults::NONE
        };
        let mut bench = Bench::new(&params);
        bench.sim.spoil(faults);
        bench.load(WORK);
        while !bench.waiting.is_empty() || bench.sim.is_busy() {
            bench.tick();
        }
        assert_eq!(bench.alarm, None, "{what}");
        bench.ticks(5);
        bench.never_jumps(&what, 0, 9);
        assert_eq!(bench.drives(), [35_000_000, 8_000_000], "{what}");
        bench.next(&what);
    }
}

/// Three statuses that do not come are silence, and two are none, however seldom a drive sends them (9021); where it sends
/// them more often than at every fourth SYNC, twelve periods are.
#[test]
fn three_statuses_missing_are_silence_at_any_rate() {
    for syncs in [1, 2, 3, 4, 5, 8, 12, 13, 60, 240] {
        // Room on the bus for as many.
        let tick = if syncs < 4 { 2_000 } else { 1_000 };
        let params = with(&[("9021", i64::from(syncs)), ("9000", tick)]);
        let mut bench = Bench::new(&params);
        let silence = (3 * syncs).max(12);
        let silent = |bench: &mut Bench, periods: u32| {
            bench.sim.plant().drive(Axis::Z).trouble(Trouble::Silent);
            bench.ticks(periods.into());
            bench.sim.plant().drive(Axis::Z).trouble(Trouble::None);
            bench.ticks((2 * syncs).into());
        };
        // From any tick between two statuses.
        for start in 0..syncs.min(13) {
            let what = format!("{syncs} SYNCs, from {start} on");
            bench.ticks(1);
            silent(&mut bench, silence - syncs);
            assert_eq!(bench.alarm, None, "{what}");
        }
        let what = format!("{syncs} SYNCs");
        silent(&mut bench, silence + 1);
        let alarm = bench.stops_with(&what, 4360, 0);
        let figures = [Arg::Letter(b'Z'), Arg::Int(17), Arg::Int(silence.into())];
        assert_eq!(alarm.args[..3], figures, "{what}");
        bench.reset(&what);
        bench.next(&what);
    }
}

/// A drive that is silent and follows is braked with the others, as far as it is known where it is, and loses its torque
/// when all stand. From where it may be far from where it was last heard, it stops by itself.
#[test]
fn a_drive_that_is_silent_follows_until_all_stand() {
    let params = Params::sheets();
    let rows = calm(&params, WORK);
    let mut followed = 0;
    for tick in places(&rows) {
        let what = format!("Z silent at {tick}");
        let mut bench = Bench::at_work(&params, WORK, Faults::NONE);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.sim.plant().drive(Axis::Z).trouble(Trouble::Silent);
        let alarm = bench.stops_with(&what, 4360, 20);
        assert_eq!(
            alarm.args[..3],
            [Arg::Letter(b'Z'), Arg::Int(17), Arg::Int(12)]
        );
        let (at, drives) = (bench.at(), bench.drives());
        let apart = (at.z.nm() - drives[1]).abs();
        if apart <= 1_000 {
            assert_eq!(bench.power(Axis::Z), Power::Ready, "{what}");
            followed += 1;
        } else {
            assert_eq!(bench.power(Axis::Z), Power::QuickStop, "{what}");
        }
        assert_eq!(bench.power(Axis::X), Power::Enabled, "{what}");
        bench.sim.plant().drive(Axis::Z).trouble(Trouble::None);
        bench.ticks(10);
        bench.reset(&what);
        bench.next(&what);
    }
    // In the thread and in the groove.
    assert!(followed >= 4, "{followed}");
}

/// A single drive's cable is out, and back before the others stand: it is not sent after them. Nothing but what was
/// missed before it was missed can be made up for, and that is a jump of no more than twelve periods.
#[test]
fn a_drive_that_was_cut_off_is_not_sent_after_the_others() {
    let params = Params::sheets();
    let limit = params.following_error_limit(Axis::Z);
    // The worst place is where Z is fastest.
    let rows = calm(&params, WORK);
    let fastest = rows
        .windows(2)
        .max_by_key(|pair| (pair[1].position.z.nm() - pair[0].position.z.nm()).abs())
        .map(|pair| pair[1].tick);
    let mut worst = 0;
    for tick in places(&rows).into_iter().chain(fastest) {
        for ticks in (9..40).chain([60, 90, 150]) {
            let what = format!("Z cut off at {tick} for {ticks}");
            let mut bench = Bench::at_work(&params, WORK, Faults::NONE);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            bench.sim.plant().drive(Axis::Z).trouble(Trouble::CutOff);
            bench.ticks(ticks);
            let from = bench.stood.len() - 1;
            bench.sim.plant().drive(Axis::Z).trouble(Trouble::None);
            if bench.alarm.is_none() {
                bench.ticks(8);
                bench.never_jumps(&what, from, 13);
            } else {
                bench.until_on_alarm(&what, 6_000);
                let stood = bench.stood[from..].windows(2);
                let steps = stood.map(|pair| (pair[1][1] - pair[0][1]).abs());
                worst = worst.max(steps.max().unwrap_or(0));
                bench.ticks(50);
                bench.drives_stand(&what, 100);
                bench.never_jumps(&what, from, 13);
                bench.reset(&what);
                bench.next(&what);
            }
        }
    }
    assert!(worst <= limit, "{worst} nm, following error {limit} nm");
}

/// The same of the spindle in a rigid tap, where it is told angles: it is not sent after its axis, farther than a quarter
/// of a turn from where it was last heard.
#[test]
fn a_spindle_that_was_cut_off_in_a_rigid_tap_is_not_sent_after_its_axis() {
    let params = Params::sheets();
    let rows = calm(&params, TAP);
    let moving: Vec<u64> = rows
        .windows(2)
        .filter(|pair| pair[1].line == 3 && pair[1].position.z != pair[0].position.z)
        .map(|pair| pair[1].tick)
        .collect();
    let places = (1..12).map(|place| moving[moving.len() * place / 12]);
    let (mut worst, mut unnoticed, mut stopped) = (0, 0, 0);
    for tick in places {
        for ticks in [9, 12, 13, 14, 15, 16, 17, 20, 25, 32, 45, 60, 90, 150, 300] {
            let what = format!("spindle cut off at {tick} for {ticks}");
            let mut bench = Bench::at_work(&params, TAP, Faults::NONE);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            bench.sim.plant().spindle_drive().trouble(Trouble::CutOff);
            bench.ticks(ticks);
            bench.sim.plant().spindle_drive().trouble(Trouble::None);
            let mut angle = turned(&mut bench);
            let mut step = |bench: &mut Bench| {
                bench.tick();
                let before = std::mem::replace(&mut angle, turned(bench));
                (angle - before).abs()
            };
            if bench.alarm.is_none() {
                // What was missed before it was missed is made up for.
                for _ in 0..8 {
                    unnoticed = unnoticed.max(step(&mut bench));
                }
                continue;
            }
            stopped += 1;
            while !matches!(bench.state(), State::Alarm(_)) {
                worst = worst.max(step(&mut bench));
                assert!(bench.ticks < tick + 6_000, "{what}: {:?}", bench.state());
            }
            assert_eq!(
                bench.alarm.map(|alarm| alarm.number()),
                Some(4360),
                "{what}"
            );
            // A spindle that has made up for something may coast on from there, without torque.
            for _ in 0..100 {
                worst = worst.max(step(&mut bench));
            }
            let power = bench.sim.plant().spindle_drive().power();
            assert!(!matches!(power, Power::Enabled), "{what}");
            assert!(bench.has_tap_in_hole(), "{what}");
            bench.reset(&what);
        }
    }
    assert!(stopped > 100, "{stopped}");
    assert!(worst <= 250_000, "{worst} millionths of a turn");
    // Thirteen periods at 1000 rpm, the fastest of this tap.
    assert!(unnoticed <= 217_000, "{unnoticed} millionths of a turn");
}

/// Where the spindle is, in millionths of a turn.
fn turned(bench: &mut Bench) -> i64 {
    bench.sim.plant().truth().angle.micro_turns()
}

/// A blocked axis does not go on pushing once all stand, and does not leap when what blocks it is gone.
#[test]
fn an_axis_that_is_blocked_loses_its_torque_when_all_stand() {
    let params = Params::sheets();
    let places = places(&calm(&params, WORK));
    for (tick, axis, letter, node) in [
        (places[0], Axis::Z, b'Z', 17),
        (places[2], Axis::Z, b'Z', 17),
        (places[4], Axis::X, b'X', 16),
    ] {
        let what = format!("{axis:?} blocked at {tick}");
        let mut bench = Bench::at_work(&params, WORK, Faults::NONE);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.sim.plant().drive(axis).trouble(Trouble::Stuck);
        let alarm = bench.stops_with(&what, 4361, 400);
        assert_eq!(
            alarm.args[..2],
            [Arg::Letter(letter), Arg::Int(node)],
            "{what}"
        );
        assert!(
            matches!(alarm.args[2], Arg::Length(error) if error.nm() > 0),
            "{what}: {alarm:?}"
        );
        bench.sim.plant().drive(axis).trouble(Trouble::None);
        bench.drives_stand(&what, 100);
        bench.reset(&what);
        bench.next(&what);
    }
}
