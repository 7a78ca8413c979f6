//! Signals on the whole machine: hand and spindle latched when a hole begins, RGTAP when rigid mode ends.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::call::{Call, Selection, SpindleChoice, TapCall, TapRepeat, TapSpindle};
use leadscrew_core::params::Params;
use leadscrew_core::signals::{Signal, Signals};
use leadscrew_tests::machine::{Ran, machine as power_up, run_calls_on};
use leadscrew_tests::params::with;

use super::hole::{bottom, program, sheet};
use super::watch::{depth, locked, set};

fn on(signals: &[Signal]) -> Signals {
    let mut all = Signals::default();
    for signal in signals {
        all.set(*signal, true);
    }
    all
}

/// Signals from power-up, and others from a tick on.
fn run_with(
    params: &Params,
    calls: Vec<Call>,
    before: Signals,
    then: impl Fn(u64) -> Option<Signals>,
) -> Ran {
    let mut sim = power_up(params, &PlantOptions::default());
    sim.signals(before);
    run_calls_on(sim, calls, |sim, tick| {
        if let Some(signals) = then(tick) {
            sim.signals(signals);
        }
    })
}

/// The way the spindle has turned at the deepest place: +1 right, −1 left.
fn hand(ran: &Ran, line: u32, hole: &TapCall) -> i64 {
    let rows: Vec<_> = locked(ran).filter(|row| row.line == line).collect();
    let deepest = rows
        .iter()
        .max_by_key(|row| depth(row, hole))
        .expect("a tap");
    (set(deepest) - set(rows[0])).raw().signum()
}

#[test]
fn g61_2_makes_a_left_hand_tap_and_counts_from_the_next_hole_on() {
    let hole = bottom(sheet(), -9_000);
    let params = with(&[]);
    let left = on(&[Signal::G61Dot2]);
    let off = Signals::default();
    let calls = || program(&[hole, hole]);
    let plain = run_with(&params, calls(), off, |_| None);
    assert_eq!([2, 3].map(|line| hand(&plain, line, &hole)), [1, 1]);
    let signal = run_with(&params, calls(), left, |_| None);
    assert_eq!([2, 3].map(|line| hand(&signal, line, &hole)), [-1, -1]);
    // The first hole takes about two seconds.
    let middle = locked(&plain)
        .find(|row| depth(row, &hole) > 4_000_000)
        .expect("a tap")
        .tick;
    let changed = run_with(&params, calls(), off, |tick| {
        (tick == middle).then_some(left)
    });
    assert_eq!([2, 3].map(|line| hand(&changed, line, &hole)), [1, -1]);
    // Nothing else is different: the same ticks on the axis.
    let path = |ran: &Ran| -> Vec<_> { ran.rows.iter().map(|row| row.position).collect() };
    assert_eq!(path(&plain), path(&signal));
    assert_eq!(path(&plain), path(&changed));
}

#[test]
fn a_hole_that_goes_on_keeps_the_signals_of_its_beginning() {
    let stays = TapCall {
        repeat: TapRepeat::Stay,
        ..bottom(sheet(), -4_000)
    };
    let goes_on = TapCall {
        start: stays.axis.with(stays.start, stays.bottom.value),
        continues: true,
        ..bottom(sheet(), -9_000)
    };
    let before = on(&[Signal::G61Dot2, Signal::Sws(TapSpindle::Second)]);
    let later = on(&[Signal::Sws(TapSpindle::Fourth)]);
    let calls = program(&[stays, goes_on]);
    let ran = run_with(&with(&[]), calls, before, |tick| {
        (tick == 500).then_some(later)
    });
    assert_eq!(ran.alarm, None);
    assert_eq!([2, 3].map(|line| hand(&ran, line, &stays)), [-1, -1]);
    for row in locked(&ran) {
        assert!(row.angle(TapSpindle::Second).set.is_some());
        assert!(row.error.expect("locked").nm().abs() <= 1, "{row:?}");
    }
}

#[test]
fn selection_signals_choose_the_spindle() {
    let hole = bottom(sheet(), -4_000);
    let by = |by, otherwise| TapCall {
        spindle: SpindleChoice::Signals { by, otherwise },
        ..hole
    };
    let taps_with = |hole: TapCall, signals| {
        let ran = run_with(&with(&[]), program(&[hole]), signals, |_| None);
        assert_eq!(ran.alarm, None);
        let row = locked(&ran).next().expect("a tap");
        TapSpindle::ALL
            .into_iter()
            .find(|spindle| row.angle(*spindle).set.is_some())
    };
    let both = on(&[
        Signal::Sws(TapSpindle::Second),
        Signal::Rgtsp(TapSpindle::Third),
    ]);
    let (sws, rgtsp) = (Selection::Sws, Selection::Rgtsp);
    let cases = [
        (by(sws, TapSpindle::First), both, TapSpindle::Second),
        (by(rgtsp, TapSpindle::First), both, TapSpindle::Third),
        (
            by(sws, TapSpindle::Fourth),
            Signals::default(),
            TapSpindle::Fourth,
        ),
    ];
    for (hole, signals, expected) in cases {
        assert_eq!(taps_with(hole, signals), Some(expected));
    }
}

#[test]
fn two_selection_signals_are_an_alarm_before_motion() {
    let two = on(&[
        Signal::Sws(TapSpindle::First),
        Signal::Sws(TapSpindle::Third),
    ]);
    let calls = program(&[bottom(sheet(), -4_000)]);
    let ran = run_with(&with(&[]), calls, two, |_| None);
    let alarm = ran.alarm.expect("two signals");
    assert_eq!(alarm.code, Code::TapSpindlesSelected);
    assert_eq!(alarm.args[..2], [Arg::Int(1), Arg::Int(3)]);
    assert!(ran.rows.iter().all(|row| !row.is_rigid()));
    let first = ran.rows[0].position;
    assert!(ran.rows.iter().all(|row| row.position == first));
}

/// RGTAP = 1 from power-up, and 0 from a tick on.
fn rgtap(level: bool) -> Signals {
    Signals {
        rgtap: Some(level),
        ..Signals::default()
    }
}

fn waiting(ran: &Ran) -> Vec<u64> {
    ran.rows
        .iter()
        .filter(|row| row.doing == Doing::Wait && row.line == 3)
        .map(|row| row.tick)
        .collect()
}

#[test]
fn leaving_rigid_mode_waits_for_rgtap() {
    let calls = || program(&[bottom(sheet(), -4_000)]);
    let waits = with(&[("5200.2", 1)]);
    let plain = run_with(&waits, calls(), Signals::default(), |_| None);
    assert_eq!((plain.alarm, waiting(&plain)), (None, vec![]));
    // Without the parameter nobody waits.
    let careless = run_with(&with(&[]), calls(), rgtap(true), |_| None);
    assert_eq!((careless.alarm, waiting(&careless)), (None, vec![]));
    let end = plain
        .rows
        .iter()
        .find(|row| row.line == 3)
        .expect("G80")
        .tick;

    // Half a second later it is gone.
    let ran = run_with(&waits, calls(), rgtap(true), |tick| {
        // The tick of the call before is that of the row behind.
        (tick + 1 == end + 500).then_some(rgtap(false))
    });
    assert_eq!(ran.alarm, None);
    assert_eq!(waiting(&ran), (end..end + 500).collect::<Vec<_>>());
    let rigid = |ran: &Ran, tick: u64| ran.rows[tick as usize].is_rigid();
    assert!(rigid(&ran, end + 499));
    assert!(ran.rows.last().is_some_and(|row| !row.is_rigid()));

    // It never goes.
    let ran = run_with(&waits, calls(), rgtap(true), |_| None);
    let alarm = ran.alarm.expect("a second is over");
    assert_eq!((alarm.code, alarm.span.line), (Code::RigidNotReleased, 3));
    assert_eq!(waiting(&ran).len(), 1000);
    assert!(ran.rows.last().is_some_and(Row::is_rigid));
}

#[test]
fn hold_and_reset_work_while_rgtap_is_waited_for() {
    let params = with(&[("5200.2", 1)]);
    let calls = || program(&[bottom(sheet(), -4_000)]);
    let plain = run_with(&params, calls(), Signals::default(), |_| None);
    let end = plain
        .rows
        .iter()
        .find(|row| row.line == 3)
        .expect("G80")
        .tick;
    let power = || {
        let mut sim = power_up(&params, &PlantOptions::default());
        sim.signals(rgtap(true));
        sim
    };

    // Three seconds of hold do not count.
    let ran = run_calls_on(power(), calls(), |sim, tick| {
        if tick + 1 == end + 600 {
            sim.command(Command::Hold);
        }
        if tick + 1 == end + 3600 {
            assert_eq!(sim.board().ticker().state(), State::Held);
            sim.command(Command::Resume);
        }
        if tick + 1 == end + 3900 {
            sim.signals(rgtap(false));
        }
    });
    assert_eq!(ran.alarm, None);
    assert!(ran.events.contains(&Event::Finished));
    assert_eq!(waiting(&ran).len(), 900);

    let ran = run_calls_on(power(), calls(), |sim, tick| {
        if tick == end + 600 {
            sim.command(Command::Reset);
        }
    });
    assert_eq!(ran.alarm, None);
    assert!(ran.events.contains(&Event::Reset));
    assert!(!ran.events.contains(&Event::Finished));
}
