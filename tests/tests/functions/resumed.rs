//! A program that was left, and its spindle that turns again before it goes on.

use super::*;

/// A program whose door was opened and closed once Z had gone past `z`, in nanometres: its spindle stands.
fn stopped_by_the_door(params: &Params, text: &str, z: i64) -> Bench {
    let mut bench = Bench::loaded(params, &calls(text, params));
    while bench.place().z.nm() > z {
        bench.run(1);
    }
    bench.sim.set_pins(inputs(WELL & !(1 << 4)));
    bench.run(4_000);
    bench.sim.set_pins(inputs(WELL));
    bench.run(100);
    bench
}

/// A thread that the door has stopped: the tool is at the start of its cycle.
fn left_by_the_door(params: &Params) -> Bench {
    let text = "G97 M3 S600\nG0 X-10 Z-2\nG92 X-21 Z-40 F1.5\nX-22\nM30\n";
    let bench = stopped_by_the_door(params, text, -12_000_000);
    assert_eq!(bench.place().z.nm(), -2_000_000);
    bench
}

/// No hold acts on the way back into the thread: the override does.
#[test]
fn a_rapid_override_of_0_stops_the_way_back_into_a_thread() {
    let params = guarded();
    let mut bench = left_by_the_door(&params);
    let here = bench.place();
    bench.sim.command(Command::RapidOverride(0));
    assert_eq!(bench.order(Order::Resume), 0);
    bench.run(6_000);
    assert_eq!((bench.place(), bench.is_at_speed()), (here, true));
    bench.sim.command(Command::RapidOverride(100));
    bench.run(15_000);
    assert_eq!(bench.sim.board().ticker().state(), State::Idle);
    assert_eq!(bench.codes, []);
}

/// Left in whichever tick, also in that in which the spindle is at its speed.
#[test]
fn a_thread_that_is_left_while_its_spindle_comes_to_its_speed_is_not_cut() {
    let params = guarded();
    let arrival = {
        let mut bench = left_by_the_door(&params);
        assert_eq!(bench.order(Order::Resume), 0);
        let (here, mut ticks) = (bench.place(), 0);
        while bench.place() == here {
            bench.run(1);
            ticks += 1;
        }
        ticks
    };
    // An order acts a tick or two after it was sent.
    let mut left = 0;
    for wait in arrival - 25..=arrival {
        let mut bench = left_by_the_door(&params);
        assert_eq!(bench.order(Order::Resume), 0);
        bench.run(wait);
        match bench.order(Order::Mode(OperatingMode::Manual)) {
            0 => left += 1,
            // It has gone on before.
            refused => assert_eq!((refused, wait >= arrival - 2), (4502, true), "{wait}"),
        }
        if bench.gateway.beat.refused != 0 {
            continue;
        }
        for _ in 0..6_500 {
            bench.run(1);
            assert_eq!(bench.place().z.nm(), -2_000_000, "{wait} of {arrival}");
        }
    }
    assert!(left > 20, "{left} were left");
}

/// A press, and the door that opens within it, while the spindle turns for a typed line, or for a program that was left.
fn door_opened_by_hand(params: &Params, text: &str, is_typed: bool) -> Bench {
    let program = match is_typed {
        true => calls_of_line(text, params),
        false => calls(text, params),
    };
    let mut bench = Bench::loaded(params, &program);
    bench.run(1_500);
    if !is_typed {
        assert_eq!(bench.order(Order::Hold), 0);
        bench.run(500);
    }
    assert_eq!(bench.order(Order::Mode(OperatingMode::Manual)), 0);
    for _ in 0..20 {
        bench.press();
        bench.run(20);
    }
    assert_eq!(bench.sim.board().ticker().state(), State::ByHand);
    assert_eq!(bench.sim.spindle_command().get(), 300);
    bench.sim.set_pins(inputs(WELL & !(1 << 4)));
    bench.run(3_000);
    assert_eq!(bench.sim.spindle_command().get(), 0);
    // Closing it starts nothing.
    bench.sim.set_pins(inputs(WELL));
    bench.run(3_000);
    assert_eq!(bench.sim.spindle_command().get(), 0);
    bench
}

#[test]
fn the_door_stops_a_spindle_while_an_axis_is_moved_by_hand() {
    let params = guarded();
    let mut bench = door_opened_by_hand(&params, "M3 S300\n", true);
    assert_eq!(bench.sim.board().ticker().state(), State::Idle);
    // No program was left that it would turn for.
    bench.order(Order::Mode(OperatingMode::Automatic));
    bench.order(Order::Resume);
    bench.run(3_000);
    assert_eq!(bench.sim.spindle_command().get(), 0);
}

#[test]
fn the_spindle_of_a_program_that_was_left_turns_again_when_that_goes_on() {
    let params = guarded();
    let text = "M3 S300\nG98 G1 Z-40 F300\nG4 P500\nM30\n";
    let mut bench = door_opened_by_hand(&params, text, false);
    assert_eq!(bench.sim.board().ticker().state(), State::Held);
    assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
    // Back to where it was held.
    assert_eq!(bench.order(Order::Resume), 0);
    bench.run(5_000);
    assert_eq!(bench.sim.spindle_command().get(), 0);
    // And on from there: the axis waits until the spindle is at its speed.
    assert_eq!(bench.order(Order::Resume), 0);
    bench.run(2_000);
    assert_eq!(bench.sim.spindle_command().get(), 300);
    bench.run(10_000);
    let ticker = bench.sim.board().ticker();
    assert_eq!(ticker.state(), State::Idle);
    assert_eq!(ticker.executor().position().z, Length::from_nm(-40_000_000));
    assert_eq!(bench.codes, []);
}

/// A program that the door has stopped in its first cut, resumed: its spindle is on its way to its speed.
fn resumed_in_a_cut(params: &Params, text: &str) -> Bench {
    let mut bench = stopped_by_the_door(params, text, -5_000_000);
    assert_eq!(bench.sim.board().ticker().state(), State::Held);
    assert_eq!(bench.order(Order::Resume), 0);
    assert!(!bench.is_at_speed());
    bench
}

/// A joined cut, a cut with an exact stop, and a pause between two cuts.
const CUTS: [&str; 3] = [
    "M3 S1500\nG98 G64\nG1 Z-40 F300\nG1 X-1 Z-50\nM30\n",
    "M3 S1500\nG98 G61\nG1 Z-40 F300\nG1 X-1 Z-50\nM30\n",
    "M3 S1500\nG98 G61\nG1 Z-5 F300\nG1 X-1 Z-50\nM30\n",
];

#[test]
fn a_program_that_is_left_while_its_spindle_comes_to_its_speed_stays_left() {
    let params = guarded();
    for text in CUTS {
        for jogs in [false, true] {
            let mut bench = resumed_in_a_cut(&params, text);
            assert_eq!(bench.order(Order::Mode(OperatingMode::Manual)), 0);
            if jogs {
                for _ in 0..10 {
                    bench.press();
                    bench.run(20);
                }
                bench.run(500);
            }
            let here = bench.place();
            bench.run(6_000);
            assert_eq!((bench.place(), bench.is_at_speed()), (here, true), "{text}");
            assert_eq!(bench.sim.board().ticker().state(), State::Held, "{text}");
            // Back, where it was left, and on from there.
            assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
            assert_eq!(bench.order(Order::Resume), 0);
            bench.run(6_000);
            if jogs {
                assert_eq!(bench.order(Order::Resume), 0);
            }
            bench.run(15_000);
            assert_eq!(bench.sim.board().ticker().state(), State::Idle, "{text}");
            let end = bench.place();
            assert_eq!((end.x.nm(), end.z.nm()), (-500_000, -50_000_000), "{text}");
            assert_eq!(bench.codes, []);
        }
    }
}

#[test]
fn however_often_a_program_is_resumed_it_waits_for_its_spindle() {
    let params = guarded();
    for text in CUTS {
        for orders in [
            [Order::Resume].as_slice(),
            &[Order::Hold, Order::Resume],
            &[
                Order::Mode(OperatingMode::Manual),
                Order::Mode(OperatingMode::Automatic),
                Order::Resume,
                Order::Resume,
            ],
        ] {
            let mut bench = resumed_in_a_cut(&params, text);
            let here = bench.place();
            for order in orders {
                bench.order(*order);
            }
            while bench.place() == here {
                bench.run(1);
                let moves = bench.place() != here;
                assert!(!moves || bench.is_at_speed(), "{text} {orders:?}");
            }
            bench.run(15_000);
            assert_eq!(bench.sim.board().ticker().state(), State::Idle, "{text}");
            assert_eq!(bench.place().z.nm(), -50_000_000, "{text}");
        }
    }
}
