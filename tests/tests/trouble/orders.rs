//! Resets, stops, holds and overrides, anywhere and in any order.

use leadscrew_board_sim::Row;
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::params::Params;
use leadscrew_seed::amount;
use leadscrew_tests::bench::{Bench, Lathe, NEXT, PATIENCE, WORK};
use leadscrew_tests::limits::{first_excess, first_excess_with};
use leadscrew_tests::params::with;

use crate::bench::{Recovers, calm, drawn_places, places};

#[test]
fn a_reset_anywhere_and_the_next_program() {
    let params = Params::sheets();
    let calm = calm(&params);
    // The thread's crest is at X60 + 2 · 0.8 mm.
    let crest = 30_000_000 + 800_000;
    for tick in drawn_places(&calm, amount(61, 5)) {
        let what = format!("reset at {tick}");
        let mut bench = Lathe::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let in_thread = calm[tick as usize].line == 4 && bench.at().z.nm() < 5_000_000;
        bench.waiting.clear();
        bench.sim.command(Command::Reset);
        bench.tick();
        bench.until(&what, PATIENCE, |bench| bench.state() == State::Idle);
        bench.stands(&what);
        assert!(
            !in_thread || bench.at().x.nm() >= crest,
            "{what}: X stays in the thread at {}",
            bench.at().x.nm()
        );
        assert_eq!(first_excess(&bench.rows, &params), None, "{what}");
        bench.next(&what);
    }
}

#[test]
fn an_emergency_stop_anywhere_and_the_next_program() {
    let params = Params::sheets();
    let calm = calm(&params);
    for tick in drawn_places(&calm, amount(61, 5)) {
        let what = format!("stop at {tick}");
        let mut bench = Lathe::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.sim.command(Command::Stop);
        bench.tick();
        assert_eq!(
            bench.alarm.map(|alarm| alarm.number()),
            Some(4300),
            "{what}"
        );
        bench.until_on_alarm(&what, PATIENCE);
        bench.stands(&what);
        let stood = bench.at();
        bench.reset(&what);
        bench.stands(&what);
        assert_eq!(bench.at(), stood, "{what}: the position is not kept");
        assert_eq!(first_excess_with(&bench.rows, &params, 2.0), None, "{what}");
        bench.next(&what);
    }
}

fn retracting() -> Params {
    with(&[("9008.0", 1)])
}

#[test]
fn commands_one_after_another_in_any_order() {
    let orders: [&[Command]; 10] = [
        &[Command::Hold, Command::Reset],
        &[Command::Hold, Command::Stop],
        &[Command::Reset, Command::Reset],
        &[Command::Reset, Command::Stop],
        &[Command::Stop, Command::Reset],
        &[Command::Resume, Command::Reset],
        &[Command::Reset, Command::Hold],
        &[Command::Reset, Command::Resume],
        &[Command::Hold, Command::Resume, Command::Reset],
        &[Command::Hold, Command::Resume, Command::Stop],
    ];
    for params in [Params::sheets(), retracting()] {
        let calm = calm(&params);
        for (index, tick) in places(&calm, amount(401, 13)).enumerate() {
            let order = orders[index % orders.len()];
            let gap = [0, 1, 3, 17, 60, 250][index / orders.len() % 6];
            let what = format!("{order:?} from {tick} on, {gap} ticks apart");
            let mut bench = Lathe::new(&params);
            bench.load(WORK);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            let stopped = order.contains(&Command::Stop);
            for command in order {
                if *command == Command::Reset {
                    bench.waiting.clear();
                    bench.alarm = None;
                }
                bench.sim.command(*command);
                bench.ticks(gap);
            }
            bench.waiting.clear();
            bench.tick();
            bench.until(&what, PATIENCE, |bench| {
                matches!(bench.state(), State::Idle | State::Alarm(_))
            });
            if order.last() == Some(&Command::Stop) {
                assert!(matches!(bench.state(), State::Alarm(_)), "{what}");
            }
            if stopped && matches!(bench.state(), State::Alarm(_)) {
                let at = bench.at();
                bench.stands(&what);
                assert_eq!(bench.at(), at);
                bench.reset(&what);
            }
            bench.stands(&what);
            assert_eq!(first_excess_with(&bench.rows, &params, 2.0), None, "{what}");
            bench.sim.command(Command::Resume);
            bench.tick();
            bench.stands(&what);
            bench.next(&what);
        }
    }
}

#[test]
fn a_stop_while_a_reset_retracts_leaves_the_tool_where_it_stops() {
    let params = Params::sheets();
    let calm = calm(&params);
    let strokes: Vec<u64> = calm
        .iter()
        .filter(|row| row.error.is_some())
        .map(|row| row.tick)
        .collect();
    for tick in strokes.iter().step_by(amount(31, 7)).copied() {
        for later in [1, 5, 20, 60, 120] {
            let what = format!("reset at {tick}, stop {later} later");
            let mut bench = Lathe::new(&params);
            bench.load(WORK);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            bench.waiting.clear();
            bench.sim.command(Command::Reset);
            bench.ticks(later);
            bench.sim.command(Command::Stop);
            bench.tick();
            // A stop takes 0.2 s at most here; whoever moves then sets out anew.
            let mut still = 0;
            let mut at = bench.at();
            while still < 2 {
                bench.tick();
                still = if bench.at() == at { still + 1 } else { 0 };
                at = bench.at();
            }
            for _ in 0..500 {
                bench.tick();
                assert_eq!(bench.at(), at, "{what}: sets out again");
            }
        }
    }
}

#[test]
fn a_tapered_thread_is_left_outwards() {
    let params = Params::sheets();
    let text = "M3 S600\nG0 X90 Z8\nG76 P010060 Q800 R0.1\nG76 X60 Z-12 R-8 P8000 Q7000 F1\nG0 X100 Z8\nM30\n";
    let mut calm = Lathe::new(&params);
    calm.runs("calm", text, 50_000_000, 8_000_000);
    let strokes: Vec<Row> = calm
        .rows
        .iter()
        .filter(|row| row.error.is_some())
        .copied()
        .collect();
    for row in strokes.iter().step_by(amount(97, 13)) {
        let what = format!("reset at {}", row.tick);
        let mut bench = Lathe::new(&params);
        bench.load(text);
        bench.until(&what, row.tick, |bench| bench.ticks == row.tick);
        bench.waiting.clear();
        bench.sim.command(Command::Reset);
        let mut x = bench.at().x.nm();
        bench.tick();
        while bench.state() != State::Idle {
            bench.tick();
            // The line itself rises: it never goes down.
            assert!(bench.at().x.nm() >= x, "{what}: into the work");
            x = bench.at().x.nm();
        }
        assert!(x >= 30_800_000, "{what}: X stays at {x}");
        assert_eq!(first_excess(&bench.rows, &params), None, "{what}");
    }
}

#[test]
fn the_spindle_override_is_frozen_in_a_thread() {
    let params = Params::sheets();
    let text = WORK.replace("Q7000", "Q2000");
    let mut calm = Lathe::new(&params);
    calm.runs("calm", &text, 35_000_000, 8_000_000);
    for tick in places(&calm.rows, amount(401, 83)) {
        for percent in [50, 80, 120] {
            let what = format!("{percent} % at {tick}");
            let mut bench = Lathe::new(&params);
            bench.load(&text);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            bench.sim.command(Command::SpindleOverride(percent));
            bench.finish(&what);
            assert_eq!(bench.alarm, None, "{what}");
            assert_eq!(first_excess(&bench.rows, &params), None, "{what}");
        }
    }
}

/// D58 freezes it from the first move of a thread cycle to its last. In a stop of the program after that the operator's
/// percentage holds again.
#[test]
fn the_spindle_override_acts_where_a_program_stops_after_a_thread() {
    let params = Params::sheets();
    let text = WORK.replace("Q7000", "Q2000");
    let stopped = text.replace("M30", "M0\nM30");
    assert_ne!(text, stopped);
    let mut bench = Lathe::new(&params);
    bench.load(&stopped);
    bench.until("M00", 60_000, |bench| bench.state() == State::Held);
    let commanded = |bench: &Lathe| bench.sim.spindle_command().get();
    let whole = commanded(&bench);
    bench.sim.command(Command::SpindleOverride(50));
    bench.ticks(10);
    assert_eq!((commanded(&bench), bench.state()), (whole / 2, State::Held));
}

/// A cycle of hundreds of moves is given up within as many ticks as it takes to stop.
#[test]
fn a_reset_does_not_wait_for_the_rest_of_the_cycle() {
    let params = Params::sheets();
    let mut bench = Lathe::new(&params);
    bench.load("M3 S600\nG0 X61 Z-3\nG98 G75 R0.2\nG75 X20 Z-30 P2000 Q10000 F600\nM30\n");
    bench.ticks(3_000);
    bench.waiting.clear();
    bench.sim.command(Command::Reset);
    bench.tick();
    bench.until("reset", 250, |bench| bench.state() == State::Idle);
    bench.stands("reset");
}

/// A hold that is there before the program: the machine says that it is held.
#[test]
fn a_program_under_hold_waits_and_says_so() {
    let params = Params::sheets();
    let mut bench = Lathe::new(&params);
    bench.sim.command(Command::Hold);
    bench.load(NEXT);
    bench.until("hold", 10, |bench| bench.state() == State::Held);
    bench.stands("hold");
    assert_eq!(
        bench
            .events
            .iter()
            .filter(|event| **event == Event::Held)
            .count(),
        1
    );
    // A hold that comes with a resume is a hold.
    bench.sim.command(Command::Resume);
    bench.sim.command(Command::Hold);
    bench.stands("hold again");
    bench.sim.command(Command::Resume);
    bench.finish("resumed");
    assert_eq!(
        (bench.at().x.nm(), bench.at().z.nm()),
        (40_000_000, 10_000_000)
    );
}
