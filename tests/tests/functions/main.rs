//! Machine functions and interlocks on the simulated machine: the program's order, answers, and the truth table of
//! `docs/functions.md`, cell by cell.

#![expect(
    clippy::inconsistent_digit_grouping,
    reason = "a row is written by its fields: CCC H OO A II TTTT"
)]

mod door;
mod interlocks;
mod resumed;

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::{Command, Event, Inputs, State};
use leadscrew_core::bus::{BoardState, JogRequest, Order};
use leadscrew_core::call::{Aux, Call, Position};
use leadscrew_core::operating::{Interlock, OperatingMode, Towards};
use leadscrew_core::params::{Contact, Params};
use leadscrew_core::units::Length;
use leadscrew_tests::gateway::{Gateway, NODE};
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::{Ran, calls, calls_of_line, machine, run};
use leadscrew_tests::params::with;

/// M8 switches output 1 on, and input 1 answers within 2 s, M9 turns it off. M60 pulses output 2 for 200 ms. M61 switches
/// output 5 on until input 2 is off, within a second. M62 waits for input 3. M10 closes the chuck (output 3, input 4), M11
/// opens it.
fn rows() -> Vec<(&'static str, i64)> {
    vec![
        ("9401", 8_1_01_1_01_0200),
        ("9402", 9_2_01_0_00_0000),
        ("9403", 60_3_02_0_00_0020),
        ("9404", 61_8_05_2_02_0100),
        ("9405", 62_0_00_1_03_0100),
        ("9406", 10_1_03_1_04_0100),
        ("9407", 11_2_03_2_04_0100),
    ]
}

/// Inputs 5 to 8 are door, chuck, its pressure and that of the tailstock, which is demanded while output 4 is on.
fn guarded() -> Params {
    let mut values = rows();
    values.extend([
        ("9408", 12_1_04_0_00_0000),
        ("9422", 0b0001),
        ("9423", 5),
        ("9424", 6),
        ("9425", 7),
        ("9426", 8),
        ("9427", 4),
        ("9428", 11),
    ]);
    with(&values)
}

/// All of the guarded machine's inputs as they ought to be.
const WELL: u16 = 0b1111_0000;

const PINS: [(Interlock, u16); 4] = [
    (Interlock::Door, 1 << 4),
    (Interlock::Chuck, 1 << 5),
    (Interlock::ChuckPressure, 1 << 6),
    (Interlock::TailstockPressure, 1 << 7),
];

fn inputs(levels: u16) -> Inputs {
    Inputs {
        machine: Some(levels),
        ..Inputs::default()
    }
}

/// Runs `text` with the machine's inputs as `levels` says for each tick.
fn with_inputs(text: &str, params: &Params, levels: impl Fn(u64) -> u16) -> Ran {
    run(text, params, &PlantOptions::default(), |sim, tick| {
        sim.set_pins(inputs(levels(tick)));
    })
}

/// Runs `text` as [`with_inputs`] until it stands on its alarm; the rows, and the alarm.
fn until_alarm(text: &str, params: &Params, levels: impl Fn(u64) -> u16) -> (Vec<Row>, Alarm) {
    let sim = machine(params, &PlantOptions::default());
    until_alarm_on(sim, text, params, levels)
}

fn until_alarm_on(
    mut sim: Sim,
    text: &str,
    params: &Params,
    levels: impl Fn(u64) -> u16,
) -> (Vec<Row>, Alarm) {
    let mut calls = calls(text, params).into_iter().peekable();
    let mut rows = Vec::new();
    for tick in 0..60_000 {
        while calls.peek().is_some_and(|call| sim.offer(call)) {
            calls.next();
        }
        sim.set_pins(inputs(levels(tick)));
        rows.extend(sim.step());
        if let State::Alarm(alarm) = sim.board().ticker().state() {
            return (rows, alarm);
        }
    }
    panic!("no alarm: {:?}", sim.board().ticker().state());
}

fn alarm(ran: &Ran) -> (u16, [Arg; 4]) {
    let alarm = ran.alarm.expect("an alarm");
    (alarm.code.number(), alarm.args)
}

/// The tick of the first row in which an axis is not where it was.
fn first_motion(rows: &[Row]) -> u64 {
    let moved = rows
        .windows(2)
        .find(|two| two[0].position != two[1].position);
    moved.expect("something moves")[1].tick
}

#[test]
fn the_next_block_begins_in_the_tick_of_the_answer() {
    let params = with(&rows());
    let text = "M8\nG0 X10\nM30\n";
    let at = |answer: u64| {
        let ran = with_inputs(text, &params, |tick| u16::from(tick >= answer));
        assert_eq!(ran.alarm, None);
        first_motion(&ran.rows)
    };
    let first = at(0);
    for answer in [100, 101, 731, 1_900] {
        // From the second tick on: in the first, M8 itself begins.
        assert_eq!(at(answer), first + answer - 1, "{answer}");
    }
}

#[test]
fn an_answer_that_does_not_come_is_an_alarm_in_its_tick() {
    let params = with(&rows());
    let ran = with_inputs("G4 P10\nM8\nG0 X10\nM30\n", &params, |_| 0);
    let (code, args) = alarm(&ran);
    assert_eq!(code, 4551);
    assert_eq!(args[..3], [Arg::Int(8), Arg::Int(1), Arg::Int(2000)]);
    assert_eq!(ran.alarm.map(|alarm| alarm.span.line), Some(2));
    let waits = ran
        .rows
        .iter()
        .filter(|row| row.doing == Doing::Wait && row.line == 2);
    // 2 s in ticks of a millisecond; the last one is that of the alarm.
    assert_eq!(waits.count(), 2000);
    assert!(ran.rows.iter().all(|row| row.position.x == Length::ZERO));
    // The level at which it does not answer is no answer either.
    let ran = with_inputs("M61\nM30\n", &params, |_| 0b10);
    assert_eq!(alarm(&ran).1[..2], [Arg::Int(61), Arg::Int(2)]);
}

#[test]
fn an_answer_that_goes_while_it_is_demanded_is_an_alarm() {
    let params = with(&rows());
    let text = "M8\nG4 P500\nM9\nG4 P500\nM30\n";
    let ran = with_inputs(text, &params, |tick| u16::from(tick < 300));
    assert_eq!(alarm(&ran).0, 4552);
    assert_eq!(alarm(&ran).1[..2], [Arg::Int(1), Arg::Int(1)]);
    // Behind M9 nobody demands it.
    let ran = with_inputs(text, &params, |tick| u16::from(tick < 700));
    assert_eq!(ran.alarm, None);
}

/// The outputs in each tick, and the position then.
fn outputs(text: &str, params: &Params) -> (Vec<u32>, Ran) {
    let mut told = Vec::new();
    let ran = run(text, params, &PlantOptions::default(), |sim, _| {
        told.push(sim.board().ticker().machine_outputs());
    });
    (told, ran)
}

#[test]
fn look_ahead_does_not_run_over_a_function() {
    let params = with(&rows());
    // Without the functions all four cuts are joined.
    let cuts = "G64 G98\nG1 X2 Z-1 F1000\nM8 X4 Z-3\nX6 Z-4\nM9\nX8 Z-6\nM30\n";
    let (told, ran) = outputs(cuts, &params);
    assert_eq!(ran.alarm, None);
    let row = |tick: usize| ran.rows[tick].position;
    let on = told.iter().position(|on| *on == 1).expect("M8");
    let off = on + told[on..].iter().position(|on| *on == 0).expect("M9");
    // Rows tell the setpoint of the tick in which the output is switched; what is told is that of the tick before.
    assert_eq!(
        (row(on - 1).x.nm(), row(on - 1).z.nm()),
        (1_000_000, -1_000_000)
    );
    // M09 has its place after the motion of its block; this one has none of its own.
    assert_eq!(
        (row(off - 1).x.nm(), row(off - 1).z.nm()),
        (3_000_000, -4_000_000)
    );
    assert_eq!(first_excess(&ran.rows, &params), None);
}

#[test]
fn a_pulse_lasts_its_time_or_until_it_is_answered() {
    let params = with(&rows());
    let (told, ran) = outputs("M60\nG0 X10\nM30\n", &params);
    assert_eq!(ran.alarm, None);
    assert_eq!(told.iter().filter(|on| **on == 2).count(), 200);
    let mut pulse = 0;
    let ran = run(
        "M61\nM30\n",
        &params,
        &PlantOptions::default(),
        |sim, tick| {
            sim.set_pins(inputs(if tick < 77 { 0b10 } else { 0 }));
            pulse += usize::from(sim.board().ticker().machine_outputs() == 16);
        },
    );
    assert_eq!(ran.alarm, None);
    assert_eq!(pulse, 77);
}

#[test]
fn a_row_behind_the_motion_waits_for_its_end() {
    let params = with(&rows());
    let (told, ran) = outputs("G98 G1 X2 F1000 M61\nM30\n", &params);
    let on = told.iter().position(|on| *on == 16).expect("M61");
    assert_eq!(ran.rows[on - 1].position.x.nm(), 1_000_000);
    assert_eq!(ran.alarm, None);
}

#[test]
fn several_functions_of_a_block_act_in_its_order() {
    let params = with(&rows());
    let (_, ran) = outputs("M10 M62 M60 G0 X10 M8 M61\nM30\n", &params);
    let codes: Vec<u16> = ran
        .events
        .iter()
        .filter_map(|event| match event {
            Event::Aux(Aux::M(code)) => Some(*code),
            _ => None,
        })
        .collect();
    assert_eq!(codes, [8, 10, 62, 60, 61, 30]);
    assert_eq!(ran.alarm, None);
}

#[test]
fn a_reset_switches_off_what_the_parameter_names() {
    let mut values = rows();
    values.push(("9422", 1));
    let params = with(&values);
    let mut after = None;
    run(
        "M8\nM10\nG4 P9000\nM30\n",
        &params,
        &PlantOptions::default(),
        |sim, tick| {
            if tick == 500 {
                assert_eq!(sim.board().ticker().machine_outputs(), 0b101);
                sim.command(Command::Reset);
            }
            after = Some(sim.board().ticker().machine_outputs());
        },
    );
    assert_eq!(after, Some(0b100));
}

// -- The truth table: start and spindle on ------------------------------------------------------------------------------

struct Bench {
    sim: Sim,
    gateway: Gateway,
    codes: Vec<(Code, Arg)>,
    events: Vec<Event>,
}

impl Bench {
    fn new(params: &Params, levels: u16) -> Self {
        let mut sim = machine(params, &PlantOptions::default());
        sim.set_pins(inputs(levels));
        let gateway = Gateway::connect(&mut sim);
        let mut bench = Self {
            sim,
            gateway,
            codes: Vec::new(),
            events: Vec::new(),
        };
        for _ in 0..2_000 {
            if bench.gateway.status.state == BoardState::Idle {
                break;
            }
            bench.run(1);
        }
        bench
    }

    fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.sim.step();
            while let Some(event) = self.sim.event() {
                if let Event::Warning(alarm) | Event::Alarm(alarm) | Event::Refused(alarm) = event {
                    self.codes.push((alarm.code, alarm.args[0]));
                }
                self.events.push(event);
            }
            self.gateway.listen(&mut self.sim);
        }
    }

    fn place(&self) -> Position {
        self.sim.board().ticker().executor().position()
    }

    /// The spindle is within 15 % of the speed that is commanded (9007).
    fn is_at_speed(&self) -> bool {
        let speed = self.sim.board().ticker().observer().speed().rpm().get();
        let wanted = self.sim.spindle_command().get();
        wanted != 0 && (speed - wanted).abs() * 100 <= wanted.abs() * 15
    }

    /// Z towards the chuck at rapid: a press, or its renewal.
    fn press(&mut self) {
        let frame = JogRequest {
            session: 1,
            press: 1,
            x: None,
            z: Some(Towards::Minus),
            spindle: None,
            rapid: true,
            speed: 0,
            echo: self.gateway.beat.beat,
        }
        .frame(NODE);
        self.sim.receive(&frame);
    }

    /// In mode automatic, with these calls.
    fn loaded(params: &Params, calls: &[Call]) -> Self {
        let mut bench = Self::new(params, WELL);
        assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
        for call in calls {
            assert!(bench.sim.offer(call));
        }
        bench
    }

    /// The alarm for which an order is refused; 0 for none.
    fn order(&mut self, order: Order) -> u16 {
        self.gateway.order(&mut self.sim, order);
        self.run(20);
        self.gateway.beat.refused
    }
}

/// Carries out a line that was typed: the machine's state after it, and what it was told.
fn typed(bench: &mut Bench, line: &str, params: &Params) -> (State, Vec<u16>) {
    bench.codes.clear();
    for call in &calls_of_line(line, params) {
        while !bench.sim.offer(call) {
            bench.run(1);
        }
    }
    bench.run(2_000);
    let told = bench.codes.iter().map(|(code, _)| code.number());
    (bench.sim.board().ticker().state(), told.collect())
}

#[test]
fn a_typed_line_that_cannot_begin_is_refused_and_the_machine_stays_ready() {
    let params = guarded();
    for (interlock, pin) in &PINS[..3] {
        let mut bench = Bench::new(&params, WELL);
        assert_eq!(bench.order(Order::Mode(OperatingMode::Mdi)), 0);
        bench.sim.set_pins(inputs(WELL & !pin));
        bench.run(5);
        for _ in 0..2 {
            let done = typed(&mut bench, "M3 S300\nG98 G1 W-1 F600\n", &params);
            assert_eq!(done, (State::Idle, vec![4506]), "{interlock:?}");
            assert_eq!(bench.codes[0].1, Arg::Interlock(*interlock));
        }
        let ticker = bench.sim.board().ticker();
        assert_eq!(ticker.spindle_command().get(), 0);
        assert_eq!(ticker.executor().position().z.nm(), 0);
        // Once it can begin, the same line does, and nothing is left of the ones before.
        bench.sim.set_pins(inputs(WELL));
        bench.run(5);
        let done = typed(&mut bench, "M3 S300\nG98 G1 W-1 F600\n", &params);
        assert_eq!(done, (State::Idle, vec![]), "{interlock:?}");
        let ticker = bench.sim.board().ticker();
        assert_eq!(ticker.spindle_command().get(), 300);
        assert_eq!(ticker.executor().position().z.nm(), -1_000_000);
        // What turns goes on turning where a line is refused: here the chuck is not opened.
        let done = typed(&mut bench, "M11\n", &params);
        assert_eq!(done, (State::Idle, vec![4506]));
        assert_eq!(bench.sim.board().ticker().spindle_command().get(), 300);
    }
}

#[test]
fn a_refused_line_is_told_as_that_and_as_no_reset() {
    let params = guarded();
    let mut bench = Bench::new(&params, WELL & !PINS[0].1);
    assert_eq!(bench.order(Order::Mode(OperatingMode::Mdi)), 0);
    // By the tick, and by the planner: there is no way to where this goes.
    for (line, number) in [("M3 S300\n", 4506), ("G98 G1 Z-99999 F600\n", 4258)] {
        bench.events.clear();
        let done = typed(&mut bench, line, &params);
        assert_eq!(done, (State::Idle, vec![number]));
        let [Event::Refused(alarm)] = bench.events[..] else {
            panic!("{line}: {:?}", bench.events);
        };
        assert_eq!((alarm.number(), alarm.span.line), (number, 1));
    }
    // Behind a block that was carried out the planner's refusal is an alarm.
    let (state, told) = typed(&mut bench, "M60\nG98 G1 Z-99999 F600\n", &params);
    assert_eq!(told, [4258]);
    assert!(matches!(state, State::Alarm(_)), "{state:?}");
}

#[test]
fn m00_stops_a_program_and_a_line_until_they_are_resumed() {
    let params = guarded();
    for mode in [OperatingMode::Mdi, OperatingMode::Automatic] {
        let mut bench = Bench::new(&params, WELL);
        assert_eq!(bench.order(Order::Mode(mode)), 0);
        let text = "M3 S300\nG0 W-1\nM0\nG0 W-1\n";
        let (state, told) = typed(&mut bench, text, &params);
        assert_eq!((state, told), (State::Held, vec![]), "{mode:?}");
        let ticker = bench.sim.board().ticker();
        assert_eq!(ticker.executor().position().z.nm(), -1_000_000);
        assert_eq!(ticker.spindle_command().get(), 300);
        bench.sim.command(Command::Resume);
        bench.run(1_000);
        let ticker = bench.sim.board().ticker();
        assert_eq!(ticker.state(), State::Idle);
        assert_eq!(ticker.executor().position().z.nm(), -2_000_000);
    }
}

#[test]
fn a_typed_line_of_which_something_was_done_stops_on_an_alarm() {
    let params = guarded();
    let (_, pin) = PINS[0];
    let mut bench = Bench::new(&params, WELL & !pin);
    assert_eq!(bench.order(Order::Mode(OperatingMode::Mdi)), 0);
    let (state, told) = typed(&mut bench, "M60\nM3 S300\n", &params);
    assert_eq!(told, [4506]);
    assert_eq!(state.alarm().map(|alarm| alarm.code.number()), Some(4506));
}

// -- The truth table: goes while the spindle turns ----------------------------------------------------------------------

/// One coarse thread, three passes, with a run-out.
const THREAD: &str = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P2000 Q1500 F3\nG0 X100 Z50\nM30\n";

/// The ticks in which the tool is locked to the spindle in a calm run.
fn locked_ticks(text: &str, params: &Params) -> Vec<u64> {
    let calm = with_inputs(text, params, |_| WELL);
    assert_eq!(calm.alarm, None);
    let locked = calm.rows.iter().filter(|row| row.error.is_some());
    locked.map(|row| row.tick).collect()
}

// -- The truth table: axes ----------------------------------------------------------------------------------------------

#[test]
fn the_simulated_machine_answers_by_itself() {
    let params = guarded();
    let text = "M8\nM10\nM61\nM9\nM30\n";
    let ran = run(text, &params, &PlantOptions::default(), |_, _| {});
    assert_eq!(ran.alarm, None);
    let ran = run(text, &params, &PlantOptions::default(), |sim, _| {
        let input = Contact::new(1).expect("an input");
        sim.around().set(input, Some(false));
    });
    assert_eq!(alarm(&ran).0, 4551);
}
