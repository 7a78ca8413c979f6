//! Which axes are referenced: how that is found, in which order, and how it is kept and lost.

use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axes, Axis};
use leadscrew_tests::params::set;

use crate::bench::{Bench, SWITCHES, both, params};

/// The axes in the order in which they became referenced.
fn order(params: &Params) -> Vec<Axis> {
    let mut bench = Bench::with(params, 290_000, SWITCHES, 24);
    let mut order = Vec::new();
    bench.home(Axes::ALL);
    bench.until("both", |bench| {
        for axis in bench.referenced().each().filter(|axis| *axis != Axis::C) {
            if !order.contains(&axis) {
                order.push(axis);
            }
        }
        bench.state() != State::Homing
    });
    assert_eq!(bench.state(), State::Idle, "{:?}", bench.events);
    order
}

#[test]
fn a_machine_without_methods_needs_nothing() {
    let bench = Bench::with(&Params::sheets(), 0, SWITCHES, 37);
    assert_eq!(bench.referenced(), Axes::ALL);
    assert_eq!(bench.sim.board().ticker().unreferenced(), Axes::NONE);
}

#[test]
fn x_first_and_by_9059() {
    assert_eq!(order(&params()), [Axis::X, Axis::Z]);
    let mut params = params();
    set(&mut params, "9059.X", 2);
    assert_eq!(order(&params), [Axis::Z, Axis::X]);
}

#[test]
fn an_axis_without_a_method_is_refused_alone() {
    let mut bench = Bench::new(290_000, SWITCHES, 24);
    bench.home(Axes::NONE.with(Axis::C));
    assert_eq!(bench.state(), State::Idle);
    let refused = bench.events.iter().any(|event| {
        matches!(event, Event::Warning(alarm) if alarm.code == Code::HomeMethodNone && alarm.args[0] == Arg::Letter(b'C'))
    });
    assert!(refused, "{:?}", bench.events);
}

#[test]
fn what_a_program_needs() {
    let mut params = params();
    let bench = Bench::with(&params, 0, SWITCHES, 37);
    assert_eq!(bench.sim.board().ticker().unreferenced(), both());
    assert_eq!(bench.referenced(), Axes::NONE.with(Axis::C));
    set(&mut params, "9060.Z", 0);
    let bench = Bench::with(&params, 0, SWITCHES, 37);
    assert_eq!(
        bench.sim.board().ticker().unreferenced(),
        Axes::NONE.with(Axis::X)
    );
}

/// A reset, an emergency stop and a fault of another kind change nothing; a switched-off drive has lost its count.
#[test]
fn kept_and_lost() {
    let mut bench = Bench::new(290_000, SWITCHES, 24);
    bench.home_x("first");
    let at = bench.at();
    for command in [Command::Reset, Command::Stop] {
        bench.sim.command(command);
        for _ in 0..50 {
            bench.tick();
        }
        bench.sim.command(Command::Reset);
        for _ in 0..200 {
            bench.tick();
        }
        assert_eq!(bench.state(), State::Idle);
        assert!(bench.referenced().contains(Axis::X), "{command:?}");
        assert_eq!(bench.at(), at);
    }
    bench.drive().restart();
    bench.until("lost", |bench| matches!(bench.state(), State::Alarm(_)));
    bench.tick();
    assert!(!bench.referenced().contains(Axis::X));
}
