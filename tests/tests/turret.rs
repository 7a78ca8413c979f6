//! Tool changes on the simulated machine: a turret that indexes, what keeps it from its station, and a change by hand.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim, TurretFault};
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::params::Params;
use leadscrew_core::units::Length;
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

/// Eight stations; output 1 unclamps, output 2 turns; inputs 3 to 6 are the code, input 7 the clamp.
fn turret() -> Params {
    with(&[
        ("9451", 2),
        ("9452", 8),
        ("9453", 1),
        ("9454", 2),
        ("9455", 3),
        ("9456", 7),
        ("9457", 3000),
    ])
}

/// The same where turning unclamps it.
fn with_one_output() -> Params {
    let mut params = turret();
    leadscrew_tests::params::set(&mut params, "9453", 0);
    params
}

/// A machine, and what it has told.
struct Bench {
    sim: Sim,
    params: Params,
    rows: Vec<Row>,
    outputs: Vec<u32>,
    warnings: Vec<Alarm>,
}

impl Bench {
    fn new(params: Params) -> Self {
        Self {
            sim: machine(&params, &PlantOptions::default()),
            params,
            rows: Vec::new(),
            outputs: Vec::new(),
            warnings: Vec::new(),
        }
    }

    fn step(&mut self) -> Option<Alarm> {
        self.rows.extend(self.sim.step());
        self.outputs
            .push(self.sim.board().ticker().machine_outputs());
        while let Some(event) = self.sim.event() {
            if let Event::Warning(alarm) = event {
                self.warnings.push(alarm);
            }
        }
        match self.sim.board().ticker().state() {
            State::Alarm(alarm) => Some(alarm),
            _ => None,
        }
    }

    /// Until it is over, or stands on an alarm.
    fn run(&mut self, text: &str) -> Option<Alarm> {
        self.operate(text, |_, _| {})
    }

    fn operate(&mut self, text: &str, mut operate: impl FnMut(&mut Self, u64)) -> Option<Alarm> {
        let mut calls = calls(text, &self.params).into_iter().peekable();
        for tick in 0..60_000 {
            while calls.peek().is_some_and(|call| self.sim.offer(call)) {
                calls.next();
            }
            operate(self, tick);
            let alarm = self.step();
            let ended = calls.peek().is_none() && !self.sim.board().ticker().in_program();
            if alarm.is_some() || (tick > 100 && ended) {
                return alarm;
            }
        }
        panic!(
            "neither an end nor an alarm: {:?}",
            self.sim.board().ticker().state()
        );
    }

    /// A reset, until the machine is ready again.
    fn reset(&mut self) {
        self.sim.command(Command::Reset);
        for _ in 0..3000 {
            self.step();
            if matches!(self.sim.board().ticker().state(), State::Idle) {
                return;
            }
        }
        panic!("{:?}", self.sim.board().ticker().state());
    }

    fn changes(&self) -> Vec<u32> {
        let mut outputs = self.outputs.clone();
        outputs.dedup();
        outputs
    }

    fn waits(&self) -> usize {
        self.rows
            .iter()
            .filter(|row| row.doing == Doing::Wait)
            .count()
    }
}

const TO_5: &str = "T0500\nG0 X10\nM30\n";

#[test]
fn a_turret_is_unclamped_turned_and_clamped_before_anything_moves() {
    let mut bench = Bench::new(turret());
    assert_eq!(bench.run(TO_5), None);
    // Unclamped; turned, too; both off again.
    assert_eq!(bench.changes(), [1, 3, 0]);
    // Four stations of 200 ticks, and 50 ms at the end.
    let waits = bench.waits();
    assert!((850..=860).contains(&waits), "{waits}");
    let before = bench.rows.iter().filter(|row| row.doing == Doing::Wait);
    assert!(before.into_iter().all(|row| row.position.x == Length::ZERO));
    assert_eq!(bench.sim.board().ticker().machine_outputs(), 0);
    let mut bench = Bench::new(with_one_output());
    assert_eq!(bench.run(TO_5), None);
    assert_eq!(bench.changes(), [0, 2, 0]);
    // It is there already, and stays clamped; T00 leaves it as it is.
    bench.outputs.clear();
    assert_eq!(bench.run("T0505\nT0005\nM30\n"), None);
    assert_eq!(bench.changes(), [0]);
}

#[test]
fn what_keeps_a_turret_from_its_station_has_an_alarm_of_its_own() {
    for (fault, code, figures) in [
        (TurretFault::Stuck, Code::TurretLate, [5, 1]),
        (TurretFault::Slips, Code::WrongStation, [5, 6]),
        (TurretFault::Loose, Code::NotClamped, [5, 5]),
    ] {
        let mut bench = Bench::new(turret());
        bench.sim.around().spoil_turret(fault);
        let alarm = bench.run(TO_5).expect("an alarm");
        assert_eq!((alarm.code, alarm.span.line), (code, 1), "{fault:?}");
        assert_eq!(alarm.args[..2], figures.map(Arg::Int), "{fault:?}");
        assert_eq!(bench.sim.board().ticker().machine_outputs(), 0);
        // Nothing moves before T.
        bench.sim.around().spoil_turret(TurretFault::None);
        bench.reset();
        let moves = bench.run("G0 X10\nM30\n").map(|alarm| alarm.code);
        assert_eq!(moves, Some(Code::TurretBetween), "{fault:?}");
        bench.reset();
        assert_eq!(bench.run(TO_5), None, "{fault:?}");
    }
}

#[test]
fn a_reset_on_the_way_leaves_no_tool() {
    let mut bench = Bench::new(turret());
    bench.operate(TO_5, |bench, tick| {
        if tick == 400 {
            bench.sim.command(Command::Reset);
        }
    });
    assert_eq!(bench.sim.board().ticker().machine_outputs(), 0);
    bench.reset();
    let moves = bench.run("G0 X10\nM30\n").map(|alarm| alarm.code);
    assert_eq!(moves, Some(Code::TurretBetween));
    bench.reset();
    assert_eq!(bench.run(TO_5), None);
}

#[test]
fn a_turret_turns_clear_of_the_work_only() {
    let mut params = turret();
    leadscrew_tests::params::set(&mut params, "9458", 20_000_000);
    let mut bench = Bench::new(params);
    let alarm = bench.run(TO_5).expect("an alarm");
    assert_eq!(
        (alarm.code, alarm.args[0]),
        (Code::OutsideChange, Arg::Letter(b'X'))
    );
    bench.reset();
    assert_eq!(bench.run("G0 X40\nT0500\nM30\n"), None);
}

#[test]
fn a_change_by_hand_waits_for_start() {
    let mut bench = Bench::new(with(&[("9451", 1)]));
    let text = "T0101\nG0 X10\nT0102\nT0202\nG0 X20\nM30\n";
    let mut started = Vec::new();
    let alarm = bench.operate(text, |bench, tick| {
        if bench.warnings.len() > started.len() && tick % 500 == 0 {
            started.push(tick);
            bench.sim.command(Command::Resume);
        }
    });
    assert_eq!(alarm, None);
    let asked: Vec<_> = bench
        .warnings
        .iter()
        .map(|alarm| (alarm.code, alarm.args[0]))
        .collect();
    // Another offset of the same tool asks for nothing.
    assert_eq!(
        asked,
        [
            (Code::ToolByHand, Arg::Int(1)),
            (Code::ToolByHand, Arg::Int(2))
        ]
    );
    let moved = bench
        .rows
        .iter()
        .find(|row| row.position.x != Length::ZERO)
        .expect("a move");
    assert!(moved.tick >= started[0]);
    // The tool is in. Whoever resets instead of pressing start is asked again.
    assert_eq!(bench.run("T0202\nM30\n"), None);
    assert_eq!(bench.warnings.len(), 2);
    for _ in 0..2 {
        bench.operate("T0303\nM30\n", |bench, tick| {
            if tick == 300 {
                bench.sim.command(Command::Reset);
            }
        });
        bench.reset();
    }
    assert_eq!(bench.warnings.len(), 4);
}
