//! Machine functions and interlocks on the simulated machine: the program's order, answers, and the truth table of
//! `docs/functions.md`, cell by cell.

#![expect(
    clippy::inconsistent_digit_grouping,
    reason = "a row is written by its fields: CCC H OO A II TTTT"
)]

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::{Command, Event, Inputs, State};
use leadscrew_core::bus::{BoardState, JogRequest, Order};
use leadscrew_core::call::{Aux, Call, CallKind, Position};
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

    /// The alarm for which an order is refused; 0 for none.
    fn order(&mut self, order: Order) -> u16 {
        self.gateway.order(&mut self.sim, order);
        self.run(20);
        self.gateway.beat.refused
    }
}

#[test]
fn no_program_starts_with_a_door_or_a_chuck_open_or_without_pressure() {
    let params = guarded();
    for (interlock, pin) in PINS {
        let mut bench = Bench::new(&params, WELL);
        assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
        // Output 4 demands the tailstock.
        let program = calls("M12\n", &params);
        for call in &program {
            assert!(bench.sim.offer(call));
        }
        bench.run(50);
        bench.sim.command(Command::Reset);
        bench.run(50);
        bench.sim.set_pins(inputs(WELL & !pin));
        bench.run(5);
        assert_eq!(bench.order(Order::Run), 4506, "{interlock:?}");
        bench.sim.set_pins(inputs(WELL));
        bench.run(5);
        // Nothing has been loaded: the interlock is not what refuses it now.
        assert_ne!(bench.order(Order::Run), 4506, "{interlock:?}");
    }
}

#[test]
fn the_spindle_is_not_switched_on_with_a_door_or_a_chuck_open_or_without_pressure() {
    let params = guarded();
    for (interlock, pin) in PINS {
        let mut sim = machine(&params, &PlantOptions::default());
        sim.set_pins(inputs(WELL & !pin));
        sim.step();
        let (rows, alarm) = until_alarm_on(sim, "M12\nM3 S300\nM30\n", &params, |_| WELL & !pin);
        assert_eq!(alarm.code.number(), 4506, "{interlock:?}");
        assert_eq!(alarm.args[0], Arg::Interlock(interlock));
        assert_eq!(alarm.span.line, 2);
        // Nothing has turned.
        assert_eq!(
            rows.first().map(|row| row.spindle),
            rows.last().map(|row| row.spindle)
        );
    }
    // A tailstock that nobody demands keeps nothing.
    let ran = with_inputs("M3 S300\nM30\n", &params, |_| WELL & !(1 << 7));
    assert_eq!(ran.alarm, None);
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

#[test]
fn inputs_that_nobody_tells_are_the_worse_value() {
    let params = guarded();
    let mut bench = Bench::new(&params, WELL);
    assert!(
        bench
            .sim
            .board()
            .ticker()
            .interlocks()
            .against_start()
            .is_none()
    );
    bench.sim.around().open_door(false);
    bench.sim.set_pins(Inputs {
        machine: Some(0),
        ..Inputs::default()
    });
    bench.run(2);
    let interlocks = bench.sim.board().ticker().interlocks();
    assert_eq!(interlocks.against_start(), Some(Interlock::Door));
    assert!(interlocks.contains(Interlock::Chuck));
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

/// Opens the door at `tick`, closes it 4 s later, and resumes a second after that; the row just before it is closed, and
/// the spindle's speed then.
fn door(text: &str, params: &Params, tick: u64) -> (Ran, Row, i32, State) {
    let mut speed = None;
    let ran = run(text, params, &PlantOptions::default(), |sim, now| {
        let opened = now >= tick && now < tick + 4_000;
        sim.set_pins(inputs(if opened { WELL & !(1 << 4) } else { WELL }));
        if now == tick + 4_500 {
            let ticker = sim.board().ticker();
            speed = Some((ticker.observer().speed().rpm().get(), ticker.state()));
        }
        if now == tick + 5_000 {
            sim.command(Command::Resume);
        }
    });
    assert_eq!(ran.alarm, None, "{tick}");
    let row = *ran
        .rows
        .iter()
        .find(|row| row.tick == tick + 4_500)
        .expect("a row");
    let (speed, state) = speed.expect("it was looked at");
    (ran, row, speed, state)
}

#[test]
fn a_door_opened_in_a_thread_leaves_it_at_once_and_the_same_groove_is_cut_again() {
    let params = guarded();
    let strokes = locked_ticks(THREAD, &params);
    for tick in strokes.iter().step_by(97) {
        let (ran, rest, speed, state) = door(THREAD, &params, *tick);
        assert_eq!(state, State::Held, "{tick}");
        assert_eq!(speed, 0, "{tick}");
        // At the start of the cycle, or, where the stroke was all but over, after its retract.
        let at = (rest.position.x.nm(), rest.position.z.nm());
        let both = [(40_000_000, 10_000_000), (40_000_000, -30_000_000)];
        assert!(both.contains(&at), "{tick} {at:?}");
        assert_eq!(ran.alarm, None, "{tick}");
        assert_eq!(first_excess(&ran.rows, &params), None, "{tick}");
        let last = ran.rows.last().expect("rows").position;
        assert_eq!(
            (last.x.nm(), last.z.nm()),
            (50_000_000, 50_000_000),
            "{tick}"
        );
        let worst = ran
            .rows
            .iter()
            .filter_map(|row| row.error)
            .map(|error| error.nm().abs());
        assert!(worst.max() <= Some(1_000), "{tick}");
    }
}

#[test]
fn a_door_does_not_let_a_stroke_be_finished() {
    let params = guarded();
    let strokes = locked_ticks(THREAD, &params);
    let tick = strokes[strokes.len() / 8];
    let (ran, ..) = door(THREAD, &params, tick);
    // The stroke ends at Z-30; the tool is off the work long before.
    let deep = ran
        .rows
        .iter()
        .filter(|row| row.tick > tick && row.tick < tick + 4_000);
    let cut = deep.filter(|row| row.position.x.nm() < 40_000_000);
    let ticks = cut.count();
    assert!((1..400).contains(&ticks), "{ticks}");
}

#[test]
fn a_door_opened_in_a_stroke_that_has_no_way_out_stops_on_an_alarm() {
    let params = guarded();
    let text = "M3 S300\nG4 P500\nG0 X40 Z10\nG32 Z-60 F2\nG0 X60\nM30\n";
    let strokes = locked_ticks(text, &params);
    let tick = strokes[strokes.len() / 2];
    let ran = with_inputs(text, &params, |now| {
        if now < tick { WELL } else { WELL & !(1 << 4) }
    });
    assert_eq!(alarm(&ran).0, 4506);
    assert_eq!(alarm(&ran).1[0], Arg::Interlock(Interlock::Door));
    let last = ran.rows.last().expect("rows").position;
    assert!(last.z.nm() > -59_000_000, "{last:?}");
}

#[test]
fn a_door_opened_in_a_cut_holds_it_and_closing_it_starts_nothing() {
    let params = guarded();
    let text = "M3 S300\nG4 P500\nG98 G1 Z-40 F300\nM30\n";
    let (ran, rest, speed, state) = door(text, &params, 2_000);
    assert_eq!((state, speed), (State::Held, 0));
    assert_eq!(rest.doing, Doing::Hold);
    assert_eq!(ran.alarm, None);
    // The spindle is at its speed before the axis moves again.
    let stands = ran
        .rows
        .iter()
        .filter(|row| row.tick >= 7_000 && row.position.z == rest.position.z);
    assert!(stands.count() > 100);
    let last = ran.rows.last().expect("rows").position;
    assert_eq!(last.z.nm(), -40_000_000);
    assert_eq!(first_excess(&ran.rows, &params), None);
}

#[test]
fn nothing_is_resumed_with_the_door_open() {
    let params = guarded();
    let mut states = Vec::new();
    let ran = run(
        "M3 S300\nG4 P500\nG98 G1 Z-9 F300\nM30\n",
        &params,
        &PlantOptions::default(),
        |sim, now| {
            let opened = (1_000..3_000).contains(&now);
            sim.set_pins(inputs(if opened { WELL & !(1 << 4) } else { WELL }));
            if now == 2_000 || now == 4_000 {
                sim.command(Command::Resume);
            }
            if now == 2_900 || now == 3_900 {
                states.push(sim.board().ticker().state());
            }
        },
    );
    assert_eq!(states, [State::Held, State::Held]);
    let warned = |event: &&Event| {
        matches!(
            event,
            Event::Warning(Alarm {
                code: Code::Interlocked,
                ..
            })
        )
    };
    assert_eq!(ran.events.iter().filter(warned).count(), 1);
    assert_eq!(ran.alarm, None);
}

/// A rapid override of 0 holds no way out of a groove, and so no reset.
#[test]
fn a_rapid_override_of_0_leaves_no_tool_in_a_groove() {
    let params = with(&[("5130", 0)]);
    let text = "G97 M3 S600\nG0 X-50 Z-20\nG92 X-61 Z-40 F1.5\nX-62\nM30\n";
    let locked = locked_ticks(text, &params);
    let (first, last) = (locked[0], *locked.last().expect("a thread"));
    for tick in (first..last + 600).step_by(leadscrew_seed::amount(487, 97)) {
        let mut sim = machine(&params, &PlantOptions::default());
        let mut calls = calls(text, &params).into_iter().peekable();
        let mut stands = None;
        for now in 0..tick + 20_000 {
            while calls.peek().is_some_and(|call| sim.offer(call)) {
                calls.next();
            }
            if now == tick {
                sim.command(Command::RapidOverride(0));
            }
            if now == tick + 15_000 {
                stands = Some(sim.board().ticker().executor().position());
                sim.command(Command::Reset);
                calls = Vec::new().into_iter().peekable();
            }
            sim.step();
        }
        // Outside of the groove, or in front of it on the way to its depth.
        let at = stands.expect("it was looked at");
        let is_out = at.x.nm() > -30_000_000 || at.z.nm() == -20_000_000;
        assert!(is_out, "{tick}: {at:?}");
        assert_eq!(sim.board().ticker().state(), State::Idle, "{tick}");
    }
    // And where the reset comes within it.
    for tick in (first..last + 100).step_by(leadscrew_seed::amount(487, 97)) {
        for percent in [0, 1] {
            let mut sim = machine(&params, &PlantOptions::default());
            let mut calls = calls(text, &params).into_iter().peekable();
            for now in 0..tick + 6_000 {
                while calls.peek().is_some_and(|call| sim.offer(call)) {
                    calls.next();
                }
                if now == tick {
                    sim.command(Command::RapidOverride(percent));
                    sim.command(Command::Reset);
                    calls = Vec::new().into_iter().peekable();
                }
                sim.step();
            }
            assert_eq!(sim.board().ticker().state(), State::Idle, "{tick}");
        }
    }
}

/// A thread that the door has left, closed again: the tool is at the start of its cycle, and the spindle stands.
fn left_by_the_door(params: &Params) -> Bench {
    let mut bench = Bench::new(params, WELL);
    assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
    let text = "G97 M3 S600\nG0 X-10 Z-2\nG92 X-21 Z-40 F1.5\nX-22\nM30\n";
    for call in &calls(text, params) {
        assert!(bench.sim.offer(call));
    }
    while bench.place().z.nm() > -12_000_000 {
        bench.run(1);
    }
    bench.sim.set_pins(inputs(WELL & !(1 << 4)));
    bench.run(4_000);
    bench.sim.set_pins(inputs(WELL));
    bench.run(100);
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

#[test]
fn pressure_lost_in_a_thread_leaves_it_and_is_an_alarm() {
    let params = guarded();
    let text = &format!("M12\n{THREAD}");
    let strokes = locked_ticks(text, &params);
    for (interlock, pin) in &PINS[1..] {
        for tick in strokes.iter().step_by(411) {
            let levels = |now| if now < *tick { WELL } else { WELL & !pin };
            let (rows, alarm) = until_alarm(text, &params, levels);
            assert_eq!(alarm.code.number(), 4555, "{interlock:?} {tick}");
            assert_eq!(alarm.args[0], Arg::Interlock(*interlock));
            // A millimetre clear of the crests, which are at X76.4.
            let last = rows.last().expect("rows").position;
            assert!(last.x.nm() >= 39_200_000, "{interlock:?} {tick} {last:?}");
            assert_eq!(first_excess(&rows, &params), None, "{interlock:?} {tick}");
        }
    }
}

#[test]
fn pressure_lost_in_a_cut_stops_it() {
    let params = guarded();
    let text = "M3 S300\nG4 P500\nG98 G1 Z-40 F300\nM30\n";
    for (interlock, pin) in &PINS[1..3] {
        let mut commanded = None;
        let ran = run(text, &params, &PlantOptions::default(), |sim, now| {
            sim.set_pins(inputs(if now < 2_000 { WELL } else { WELL & !pin }));
            commanded = Some(sim.spindle_command().get());
        });
        assert_eq!(alarm(&ran).0, 4555, "{interlock:?}");
        assert_eq!(commanded, Some(0));
    }
    // While nothing turns nobody minds.
    let ran = with_inputs("G98 G1 Z-40 F300\nM30\n", &params, |now| {
        if now < 2_000 { WELL } else { WELL & !(1 << 6) }
    });
    assert_eq!(ran.alarm, None);
}

#[test]
fn the_chuck_opens_a_second_after_the_spindle_stands() {
    let params = guarded();
    // Told to turn: refused at once.
    let ran = with_inputs("M3 S300\nG4 P500\nM11\nM30\n", &params, |_| WELL);
    assert_eq!(alarm(&ran).0, 4506);
    assert_eq!(alarm(&ran).1[0], Arg::Interlock(Interlock::Spindle));
    // Told to stop: it waits until the spindle has stood for a second, in ticks of a millisecond.
    let (mut stood, mut opened) = (0, None);
    let text = "M10\nM3 S300\nG4 P500\nM5\nM11\nM30\n";
    let ran = run(text, &params, &PlantOptions::default(), |sim, tick| {
        let ticker = sim.board().ticker();
        let closed = ticker.machine_outputs() as u16 & 0b100;
        let turns = ticker.observer().is_turning();
        sim.set_pins(inputs(WELL | closed << 1));
        if tick > 500 && closed == 0 && opened.is_none() {
            opened = Some(stood);
        }
        stood = if turns { 0 } else { stood + 1 };
    });
    assert_eq!(ran.alarm, None);
    assert_eq!(opened, Some(1_000));
}

// -- The truth table: axes ----------------------------------------------------------------------------------------------

/// How far Z goes in a second of jogging at rapid.
fn jogged(levels: u16, params: &Params) -> (i64, u16) {
    let mut bench = Bench::new(params, levels);
    bench.order(Order::Mode(OperatingMode::Manual));
    for _ in 0..50 {
        bench.press();
        bench.run(20);
    }
    let z = bench.sim.board().ticker().executor().position().z.nm();
    (z, bench.gateway.beat.refused)
}

#[test]
fn axes_are_slow_with_the_door_open() {
    let params = guarded();
    let (free, refused) = jogged(WELL, &params);
    assert_eq!(refused, 0);
    let (slow, refused) = jogged(WELL & !(1 << 4), &params);
    assert_eq!(refused, 0);
    // 9043 is 1000 mm/min: 16.7 mm in a second.
    assert!((-16_700_000..-12_000_000).contains(&slow), "{slow}");
    assert!(free < 3 * slow, "{free} {slow}");
    // An open chuck and lost pressure do not matter to axes.
    let (other, refused) = jogged(WELL & 0b1_0000, &params);
    assert_eq!((other, refused), (free, 0));
}

#[test]
fn with_the_door_open_axes_need_the_enabling_switch_where_there_is_one() {
    let mut values: Vec<(&str, i64)> = vec![("9423", 5), ("9429", 9)];
    values.extend(rows());
    let params = with(&values);
    let (moved, refused) = jogged(0, &params);
    assert_eq!((moved, refused), (0, 4506));
    let (moved, refused) = jogged(1 << 8, &params);
    assert_eq!(refused, 0);
    assert!(moved < -12_000_000, "{moved}");
    let (moved, refused) = jogged(1 << 4, &params);
    assert_eq!(refused, 0);
    assert!(moved < -40_000_000, "{moved}");
}

#[test]
fn a_door_that_is_opened_ends_a_press() {
    let params = guarded();
    let mut bench = Bench::new(&params, WELL);
    bench.order(Order::Mode(OperatingMode::Manual));
    for turn in 0..60 {
        bench.press();
        bench
            .sim
            .set_pins(inputs(if turn < 20 { WELL } else { WELL & !(1 << 4) }));
        bench.run(20);
    }
    let ticker = bench.sim.board().ticker();
    assert_eq!(ticker.state(), State::Idle);
    let z = ticker.executor().position().z;
    bench.run(200);
    // The press is over: its renewals move nothing.
    assert_eq!(bench.sim.board().ticker().executor().position().z, z);
}

#[test]
fn the_door_stops_a_spindle_that_no_program_turns() {
    let params = guarded();
    let mut bench = Bench::new(&params, WELL);
    let program = calls("M3 S300\n", &params);
    for call in &program {
        assert!(bench.sim.offer(call));
    }
    bench.run(1_500);
    bench.sim.set_pins(inputs(WELL & !(1 << 4)));
    bench.run(3_000);
    bench.sim.set_pins(inputs(WELL));
    bench.run(3_000);
    assert_eq!(bench.sim.spindle_command().get(), 0);
}

/// A press, and the door that opens within it, while the spindle turns for a typed line, or for a program that was left.
fn door_opened_by_hand(params: &Params, text: &str, is_typed: bool) -> Bench {
    let mut bench = Bench::new(params, WELL);
    assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
    let mut program = calls(text, params);
    if is_typed {
        let over = Call {
            kind: CallKind::LineOver,
            ..program[0]
        };
        program.push(over);
    }
    for call in &program {
        assert!(bench.sim.offer(call));
    }
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

/// A program in its first cut, the door opened and closed there, and the program resumed: its spindle is on its way to its
/// speed.
fn resumed_in_a_cut(params: &Params, text: &str) -> Bench {
    let mut bench = Bench::new(params, WELL);
    assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
    for call in &calls(text, params) {
        assert!(bench.sim.offer(call));
    }
    while bench.place().z.nm() > -5_000_000 {
        bench.run(1);
    }
    bench.sim.set_pins(inputs(WELL & !(1 << 4)));
    bench.run(4_000);
    bench.sim.set_pins(inputs(WELL));
    bench.run(100);
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
