//! A side that hangs, and the start of a board after a failure.

use leadscrew_app::{Failure, FailureKind, ResetCause, VERSION};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::State;
use leadscrew_core::bus::{NmtCommand, NodeId, Order};
use leadscrew_core::params::{Entry, Params};

use crate::board::Apart;
use crate::setpoints::{sim, whole};

/// Reports that find room while nobody takes them.
const REPORTS: u32 = 3;

#[test]
fn a_background_that_hangs_is_not_covered_up() {
    let params = Params::sheets();
    let mut apart = Apart::new(&params);
    apart.steps(1000);
    let before = apart.bench.fed;
    for _ in 0..1000 {
        apart.tick();
    }
    let fed = apart.bench.fed - before;
    assert_eq!(fed, REPORTS + 250, "a quarter of a second");
    // The background runs again: the tick after that feeds the watchdog.
    apart.step();
    apart.tick();
    assert_eq!(apart.bench.fed, before + fed + 1);
}

#[test]
fn the_patience_with_the_background_is_a_time_whatever_the_tick() {
    for (tick_us, periods) in [(1000, 250), (2000, 125), (4000, 62), (10_000, 25)] {
        let mut params = Params::sheets();
        let entry = Entry::find_text("9000").expect("a parameter");
        params.set(entry, tick_us).expect("in its range");
        let mut apart = Apart::off(&params);
        apart.steps(10);
        let before = apart.bench.fed;
        for _ in 0..2000 {
            apart.tick();
        }
        let fed = apart.bench.fed - before;
        assert_eq!(fed, REPORTS + periods, "at {tick_us} µs");
    }
}

#[test]
fn behind_a_failure_nothing_moves_before_a_reset() {
    let params = Params::sheets();
    let failure = Failure {
        kind: FailureKind::Fault,
        place: 0x0800_1234,
        within: 0x0800_2345,
        ticks: 4711,
        version: VERSION,
        in_a_row: 1,
    };
    for (failure, code) in [
        (failure, Code::FirmwareFault),
        (
            Failure {
                kind: FailureKind::Hung,
                ..failure
            },
            Code::FirmwareHung,
        ),
        (
            Failure {
                kind: FailureKind::PowerDropped,
                ..failure
            },
            Code::PowerDropped,
        ),
    ] {
        let mut apart = Apart::behind(&params, Some(failure));
        apart.steps(500);
        assert_eq!(apart.snapshot().state, State::Alarm(failure.alarm()));
        assert_eq!(failure.alarm().code, code);
        let number = failure.alarm().number();
        let emergency = match code {
            Code::PowerDropped => 0x3200,
            _ => 0x6100,
        };
        assert!(apart.has_told(emergency, number));
        assert!(apart.bench.events.is_empty());
        apart.order(Order::Reset);
        apart.steps(500);
        assert_eq!(apart.snapshot().state, State::Idle);
        assert_eq!(
            apart.run("G0 X60 Z5\nM30\n", &params),
            whole(&mut sim(&params), "G0 X60 Z5\nM30\n", &params)
        );
    }
}

#[test]
fn behind_too_many_failures_nothing_lets_it_move() {
    let params = Params::sheets();
    let failure = Failure {
        kind: FailureKind::Panic,
        place: 0x0800_1234,
        within: 0x0800_2345,
        ticks: 4711,
        version: VERSION,
        in_a_row: Failure::LIMIT,
    };
    let mut apart = Apart::behind(&params, Some(failure));
    let at_rest = State::Alarm(failure.alarm());
    assert_eq!(failure.alarm().code, Code::FailsAgain);
    for number in 0..4 {
        match number {
            1 => apart.order(Order::Reset),
            // The application begins anew; it does so with other parameters too.
            2 => {
                let anew = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
                apart.bench.others.push_back(anew);
            }
            3 => apart.order(Order::Reset),
            _ => {}
        }
        apart.steps(500);
        assert_eq!(apart.snapshot().state, at_rest);
    }
    assert!(apart.has_told(0x6100, Code::FailsAgain.number()));
    assert!(apart.bench.events.is_empty());
}

#[test]
fn a_reset_from_outside_is_in_the_event_log() {
    let params = Params::sheets();
    for (cause, newest) in [
        (ResetCause::Power, 0),
        (ResetCause::Pin, 1),
        (ResetCause::Software, 1),
    ] {
        let mut apart = Apart::started(&params, None, cause);
        // The number of the newest event.
        assert_eq!(apart.object(0x5040, 1), newest);
    }
}
