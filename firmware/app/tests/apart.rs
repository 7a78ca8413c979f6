//! The two sides of a board, joined by their queues only, against the same board in one piece: the same setpoints, whatever
//! the program; and what only two sides can get wrong.

use std::collections::VecDeque;

use leadscrew_app::{
    BackgroundPlace, BackgroundSide, Failure, FailureKind, Inputs, Machine, PowerUp, Queues,
    ResetCause, TickMachine, TickPlace, TickSide, TickerPlace, VERSION,
};
use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_board_sim::{Doing, Sim};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{self, Event, Held, Region, State, StoreError, StoreRequest};
use leadscrew_core::bus::{
    BoardCommand, BoardState, BusState, CobId, Controller, ErrorCounts, Frame, NmtCommand, NodeId,
    Order, Service, SyncConsumer, SyncHeard, SyncProducer, is_sync,
};
use leadscrew_core::link::{
    SetpointHash, ThreadCertificate, ThreadKind, ThreadReader, ThreadRecord, ThreadState,
};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::program::{self, Call, Options};
use leadscrew_core::spindle::EncoderSample;

/// The plant and the pins, for both sides.
struct Bench {
    plant: Plant,
    answers: VecDeque<Frame>,
    /// Frames from others on the bus, for the background.
    others: VecDeque<Frame>,
    sent: Vec<Frame>,
    syncs: u32,
    /// The SYNC of the last tick.
    given: Option<Frame>,
    /// Somebody else who gives the beat, and what the board's timer says of it.
    beat: Option<(SyncProducer, SyncHeard)>,
    inputs: Inputs,
    events: Vec<Event>,
    fed: u32,
    writing: bool,
    controller: Controller,
    rejoined: u32,
    /// The time between two SYNCs, as told at each new beginning.
    periods: Vec<u32>,
}

impl TickMachine for Bench {
    fn sample(&mut self) -> EncoderSample {
        self.plant.advance()
    }

    fn heard(&mut self) -> Option<SyncHeard> {
        self.beat.map(|(_, heard)| heard)
    }

    fn inputs(&mut self) -> Inputs {
        self.inputs
    }

    fn receive(&mut self) -> Option<Frame> {
        self.answers.pop_front()
    }

    fn send(&mut self, frames: &[Frame]) -> bool {
        self.given = frames.iter().copied().find(is_sync);
        self.syncs += u32::from(self.given.is_some());
        let answers = &mut self.answers;
        let mut answer = |answer| answers.push_back(answer);
        if let Some((sync, SyncHeard { count: 1, .. })) = &mut self.beat {
            self.plant.exchange(&[sync.next()], &mut answer);
        }
        self.plant.exchange(frames, &mut answer);
        true
    }

    fn feed_watchdog(&mut self) {
        self.fed += 1;
    }
}

impl Machine for Bench {
    fn receive(&mut self) -> Option<Frame> {
        self.others.pop_front()
    }

    fn has_room(&self) -> bool {
        true
    }

    fn send(&mut self, frame: &Frame) {
        self.sent.push(*frame);
    }

    fn load(&mut self, _: Region, then: &mut dyn FnMut(Held<'_>)) {
        then(Ok(None));
    }

    fn store(&mut self, _: &StoreRequest<'_>) {
        assert!(!self.writing, "the one before is done");
        self.writing = true;
    }

    fn stored(&mut self) -> Option<Result<(), StoreError>> {
        std::mem::take(&mut self.writing).then_some(Ok(()))
    }

    fn event(&mut self, event: &Event) {
        self.events.push(*event);
    }

    fn controller(&mut self) -> Controller {
        self.controller
    }

    fn rejoin(&mut self) {
        self.controller = Controller::default();
        self.rejoined += 1;
    }

    fn begin_anew(&mut self, params: &Params) {
        self.periods.push(params.tick_us());
    }
}

/// A board on its bench.
struct Apart {
    tick: &'static mut TickSide,
    background: &'static mut BackgroundSide,
    bench: Bench,
    hash: SetpointHash,
    /// Of the last order.
    count: u8,
}

impl Apart {
    /// Begins the application anew, as an NMT master can; its events are told from there on.
    fn restart(&mut self) {
        self.bench.events.clear();
        let anew = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
        self.bench.others.push_back(anew);
        self.rest();
    }

    /// One that has come up, and then taken tick 0.
    fn new(params: &Params) -> Self {
        let mut apart = Self::off(params);
        for _ in 0..1000 {
            apart.step();
            if apart.bench.events.contains(&Event::Ready) {
                apart.step();
                return apart;
            }
        }
        panic!("the machine does not come up");
    }

    fn off(params: &Params) -> Self {
        Self::behind(params, None)
    }

    /// A number of four bytes in the object dictionary, read within three ticks.
    fn object(&mut self, index: u16, sub: u8) -> u32 {
        let [low, high] = index.to_le_bytes();
        let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
        let request = Frame::new(request, &[0x40, low, high, sub, 0, 0, 0, 0]);
        self.bench.others.push_back(request.expect("a frame"));
        for _ in 0..3 {
            self.step();
        }
        let reply = CobId::of(Service::SdoReply, NodeId::BOARD);
        let told = self.bench.sent.iter().find(|frame| frame.id() == reply);
        let value = told.expect("an answer").payload().last_chunk();
        u32::from_le_bytes(*value.expect("eight bytes"))
    }

    /// What 5041h says of the last threads, the newest first: number, line, kind, state, passes. Read in segments.
    fn threads(&mut self) -> Vec<(u32, u32, ThreadKind, ThreadState, u16)> {
        let (request, reply) = (Service::SdoRequest, Service::SdoReply);
        let (request, reply) = [request, reply]
            .map(|service| CobId::of(service, NodeId::BOARD))
            .into();
        let mut command = [0x40, 0x41, 0x50, 0, 0, 0, 0, 0];
        let mut bytes = Vec::new();
        loop {
            self.bench.sent.clear();
            let frame = Frame::new(request, &command).expect("a frame");
            self.bench.others.push_back(frame);
            self.rest();
            let told = self.bench.sent.iter().find(|frame| frame.id() == reply);
            let answer = told.expect("an answer").payload();
            let toggle = match command[0] {
                0x40 => 0x10,
                _ => {
                    let unused = usize::from(answer[0] >> 1 & 7);
                    bytes.extend_from_slice(&answer[1..8 - unused]);
                    if answer[0] & 1 == 1 {
                        break;
                    }
                    command[0] & 0x10
                }
            };
            command = [0x60 | (toggle ^ 0x10), 0, 0, 0, 0, 0, 0, 0];
        }
        let told = |thread: ThreadCertificate| {
            let ThreadRecord {
                line,
                kind,
                state,
                tally,
            } = thread.record;
            (thread.number, line, kind, state, tally.passes)
        };
        let threads = ThreadReader::new(&bytes).expect("the certificates");
        threads.map(|thread| told(thread.expect("one"))).collect()
    }

    /// An emergency message with this code and the number of this alarm has been sent.
    fn has_told(&self, emergency: u16, number: u16) -> bool {
        self.bench.sent.iter().any(|frame| {
            let payload = frame.payload();
            frame.id().service() == Some((Service::Emcy, NodeId::BOARD))
                && payload[..2] == emergency.to_le_bytes()
                && payload[3..5] == number.to_le_bytes()
        })
    }

    /// One that is switched on behind a failure.
    fn behind(params: &Params, failure: Option<Failure>) -> Self {
        Self::started(params, failure, ResetCause::Power)
    }

    fn started(params: &Params, failure: Option<Failure>, cause: ResetCause) -> Self {
        // For good, as in an image.
        let queues = Box::leak(Box::new(Queues::new()));
        let tick = Box::leak(Box::new(TickPlace::uninit()));
        let ticker = Box::leak(Box::new(TickerPlace::uninit()));
        let background = Box::leak(Box::new(BackgroundPlace::uninit()));
        let options = PlantOptions::default();
        let up = PowerUp {
            set: &board::PowerUp::given(params),
            remembered: Some(options.at),
            tap: None,
            node: NodeId::BOARD,
            serial: 0x1234_5678,
            failure,
            cause,
        };
        let (tick, background) = queues
            .power_up(tick, ticker, background, &up)
            .expect("the parameters work");
        Self {
            tick,
            background,
            bench: Bench {
                plant: Plant::new(params, &options).expect("the plant works"),
                answers: VecDeque::new(),
                others: VecDeque::new(),
                sent: Vec::new(),
                syncs: 0,
                given: None,
                beat: None,
                inputs: Inputs::default(),
                events: Vec::new(),
                fed: 0,
                writing: false,
                controller: Controller::default(),
                rejoined: 0,
                periods: Vec::new(),
            },
            hash: SetpointHash::new(),
            count: 0,
        }
    }

    /// An order of the operator, over the bus.
    fn order(&mut self, order: Order) {
        self.count += 1;
        let command = BoardCommand {
            count: self.count,
            order: Some(order),
            ..BoardCommand::default()
        };
        let start = NmtCommand::Start.frame(None);
        self.bench
            .others
            .extend([start, command.frame(NodeId::BOARD)]);
    }

    /// A tick, and all the background can do behind it.
    fn step(&mut self) {
        self.tick.tick(&mut self.bench);
        self.rest();
        let (setpoint, snapshot) = (&self.tick.output().setpoint, self.background.snapshot());
        let spindle = setpoint
            .spindle
            .map(|angle| (snapshot.spindle_in_use, angle));
        let runs = snapshot.board_state() == BoardState::Run;
        self.hash.push(setpoint.position, spindle, runs);
    }

    fn rest(&mut self) {
        while self.background.step(&mut self.bench) {}
    }

    /// Runs a program to its end, or to an alarm.
    fn run(&mut self, text: &str, params: &Params) -> u64 {
        self.hash = SetpointHash::new();
        let mut calls: VecDeque<Call> = calls(text, params).into();
        for _ in 0..1_000_000 {
            while calls
                .front()
                .is_some_and(|call| self.background.offer(call))
            {
                calls.pop_front();
                self.rest();
            }
            self.step();
            let over = calls.is_empty() && !self.background.is_busy();
            if over || matches!(self.background.snapshot().state, State::Alarm(_)) {
                return self.hash.value();
            }
        }
        panic!("the program does not come to an end");
    }
}

fn calls(text: &str, params: &Params) -> Vec<Call> {
    program::Events::new(text.as_bytes(), params, Options::default())
        .filter_map(|event| match event.expect("a good program") {
            program::Event::Call(call) => Some(call),
            _ => None,
        })
        .collect()
}

/// The board in one piece.
fn whole(sim: &mut Sim, text: &str, params: &Params) -> u64 {
    let mut calls: VecDeque<Call> = calls(text, params).into();
    let mut hash = SetpointHash::new();
    let push = |hash: &mut SetpointHash, row: leadscrew_board_sim::Row| {
        let spindle = program::TapSpindle::ALL
            .iter()
            .find_map(|spindle| Some((*spindle, row.angle(*spindle).set?)));
        hash.push(row.position, spindle, row.doing == Doing::Run);
    };
    while !calls.is_empty() || sim.is_busy() {
        while calls.front().is_some_and(|call| sim.offer(call)) {
            calls.pop_front();
        }
        if let Some(row) = sim.step() {
            push(&mut hash, row);
        }
        while sim.event().is_some() {}
    }
    sim.last_rows(|row| push(&mut hash, row));
    hash.value()
}

fn sim(params: &Params) -> Sim {
    Sim::new(params, &PlantOptions::default()).expect("the machine starts")
}

#[test]
fn programs_give_the_same_setpoints_as_on_a_board_in_one_piece() {
    let params = Params::slant_bed();
    for name in ["shaft", "o0008-g75-grooves", "g84-tap", "g84-floating"] {
        let (mut apart, mut sim) = (Apart::new(&params), sim(&params));
        let path = format!("{}/../../examples/{name}.nc", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let hash = apart.run(&text, &params);
        assert_ne!(hash, SetpointHash::new().value(), "{name} moves");
        assert_eq!(hash, whole(&mut sim, &text, &params), "{name}");
    }
}

/// The drives elsewhere, one of them where another is on the built-in machine.
fn moved() -> Params {
    let mut params = Params::slant_bed();
    let nodes = [("9015.X", 126), ("9015.Z", 16), ("9015.C", 2), ("9016", 99)];
    for (key, node) in nodes {
        let entry = Entry::find_text(key).expect("a parameter");
        params.set(entry, node).expect("in its range");
    }
    params
}

#[test]
fn programs_give_the_same_setpoints_wherever_the_drives_are() {
    for name in ["shaft", "g84-tap"] {
        let path = format!("{}/../../examples/{name}.nc", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let hashes = [Params::slant_bed(), moved()].map(|params| {
            let hash = Apart::new(&params).run(&text, &params);
            assert_eq!(hash, whole(&mut sim(&params), &text, &params), "{name}");
            hash
        });
        assert_eq!(hashes[0], hashes[1], "{name}");
    }
}

/// A board that follows, and one that gives the beat.
fn follower() -> Apart {
    let mut params = Params::slant_bed();
    let entry = Entry::find_text("9029").expect("a parameter");
    params.set(entry, 1).expect("in its range");
    Apart::off(&params)
}

#[test]
fn a_board_whose_timer_is_led_gives_the_same_setpoints_and_no_sync() {
    let params = Params::slant_bed();
    for name in ["shaft", "g84-tap"] {
        let (mut apart, mut sim) = (follower(), sim(&params));
        apart.bench.beat = Some((SyncProducer::new(), SyncHeard::ONE));
        while !apart.bench.events.contains(&Event::Ready) {
            apart.step();
        }
        apart.step();
        let path = format!("{}/../../examples/{name}.nc", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let hash = apart.run(&text, &params);
        assert_eq!(hash, whole(&mut sim, &text, &params), "{name}");
        assert_eq!(apart.bench.syncs, 0);
    }
}

#[test]
fn a_board_whose_timer_nobody_leads_says_that_it_hears_no_sync() {
    let mut apart = follower();
    let mut ticks = 0;
    while !matches!(apart.background.snapshot().state, State::Alarm(_)) {
        apart.step();
        ticks += 1;
        assert!(ticks < 10_000);
    }
    let State::Alarm(alarm) = apart.background.snapshot().state else {
        unreachable!("it stands on one");
    };
    assert_eq!(alarm.code, Code::SyncUnsteady);
    let figures = [Arg::Int(0), Arg::Int(2100), Arg::Int(1000)];
    assert_eq!(alarm.args[..3], figures);
}

#[test]
fn a_set_that_names_other_nodes_is_followed_from_its_restart_on() {
    let mut apart = Apart::new(&Params::slant_bed());
    // 2000h + 9015, X: a byte.
    let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
    let request = Frame::new(request, &[0x2F, 0x37, 0x43, 1, 50, 0, 0, 0]);
    apart.bench.others.push_back(request.expect("a frame"));
    // The drive has stayed where it was.
    let deadline = 3000;
    assert_eq!(alarm(&mut apart, deadline), Some(Code::DriveNoAnswer));
    let State::Alarm(alarm) = apart.background.snapshot().state else {
        panic!("it stands on it");
    };
    assert_eq!(alarm.args[..2], [Arg::Letter(b'X'), Arg::Int(50)]);
}

#[test]
fn the_emergency_stop_stops_by_itself_and_holds_until_it_is_released() {
    let params = Params::slant_bed();
    let mut apart = Apart::new(&params);
    let text = "G0 X60 Z5\nG98 G1 Z-50 F1000\nM30\n";
    let mut calls: VecDeque<Call> = calls(text, &params).into();
    for _ in 0..200 {
        while calls
            .front()
            .is_some_and(|call| apart.background.offer(call))
        {
            calls.pop_front();
        }
        apart.step();
    }
    assert_eq!(apart.background.snapshot().state, State::Running);
    apart.bench.inputs.stop = true;
    // The background does nothing meanwhile.
    for _ in 0..2000 {
        apart.tick.tick(&mut apart.bench);
    }
    let stopped = apart.tick.output().setpoint.position;
    apart.rest();
    apart.step();
    let State::Alarm(alarm) = apart.background.snapshot().state else {
        panic!("{:?}", apart.background.snapshot().state);
    };
    assert_eq!(alarm.code, Code::EmergencyStop);
    // A reset with the button still pressed does not help.
    for pressed in [true, false] {
        apart.bench.inputs.stop = pressed;
        apart.order(Order::Reset);
        for _ in 0..1000 {
            apart.step();
        }
        let up = apart.background.snapshot().state == State::Idle;
        assert_eq!(up, !pressed);
        assert_eq!(apart.tick.output().setpoint.position, stopped);
    }
}

/// Bits 12 and 14 of 5060h [D164].
#[test]
fn contacts_are_mirrored_while_they_are_pressed_and_while_what_they_did_acts() {
    let mut apart = Apart::new(&Params::slant_bed());
    let told = |apart: &mut Apart, hold, stop| {
        apart.bench.inputs = Inputs {
            hold,
            stop,
            ..Inputs::default()
        };
        // The background hears of it with the report of this tick.
        apart.step();
        apart.bench.sent.clear();
        apart.object(0x5060, 0)
    };
    assert_eq!(told(&mut apart, false, false), 0);
    assert_eq!(told(&mut apart, true, false), 0x1000);
    // Resumed with the contact still pressed: it is told what is pressed, and nothing is held.
    apart.order(Order::Resume);
    assert_eq!(told(&mut apart, true, false), 0x1000);
    assert!(!apart.background.snapshot().operator.hold);
    assert_eq!(told(&mut apart, false, false), 0);
    // Pressed once, it holds until it is resumed.
    assert_eq!(told(&mut apart, true, false), 0x1000);
    assert_eq!(told(&mut apart, false, false), 0x1000);
    assert!(apart.background.snapshot().operator.hold);
    // The emergency stop, until its alarm is reset.
    assert_eq!(told(&mut apart, false, true), 0x5000);
    assert_eq!(told(&mut apart, false, false), 0x5000);
    apart.order(Order::Reset);
    for _ in 0..1000 {
        apart.step();
    }
    assert_eq!(apart.background.snapshot().state, State::Idle);
    assert_eq!(told(&mut apart, false, false), 0);
    // Behind another alarm it raises none of its own, and is told all the same.
    apart.bench.inputs.trouble = Some(Code::NetworkStop);
    for _ in 0..1000 {
        apart.step();
    }
    assert_eq!(told(&mut apart, false, false), 0);
    assert_eq!(told(&mut apart, false, true), 0x4000);
    assert_eq!(told(&mut apart, false, false), 0);
    let alarm = apart.background.snapshot().alarm().map(|alarm| alarm.code);
    assert_eq!(alarm, Some(Code::NetworkStop));
}

#[test]
fn a_background_that_hangs_is_not_covered_up() {
    let params = Params::slant_bed();
    let mut apart = Apart::new(&params);
    for _ in 0..1000 {
        apart.step();
    }
    let before = apart.bench.fed;
    for _ in 0..1000 {
        apart.tick.tick(&mut apart.bench);
    }
    let fed = apart.bench.fed - before;
    // The last sign of life is read in the first of them.
    assert_eq!(fed, 1 + 250, "a quarter of a second");
    // Back again: the tick after it has said so feeds it.
    apart.step();
    apart.tick.tick(&mut apart.bench);
    assert_eq!(apart.bench.fed, before + fed + 1);
}

#[test]
fn a_restart_of_the_application_hands_the_ticker_over_and_back() {
    let params = Params::slant_bed();
    let mut apart = Apart::new(&params);
    let text = "G0 X60 Z5\nM30\n";
    let first = apart.run(text, &params);
    let syncs = apart.bench.syncs;
    apart.restart();
    apart.step();
    assert_eq!(apart.background.snapshot().state, State::Starting);
    assert_eq!(apart.bench.periods, [params.tick_us()]);
    for _ in 0..100 {
        apart.step();
    }
    assert_eq!(apart.bench.events, [Event::Ready]);
    assert_eq!(apart.bench.syncs - syncs, 101, "no period without a SYNC");
    // It stands where it stood, and goes on from there as if nothing had been.
    let mut sim = sim(&params);
    assert_eq!(whole(&mut sim, text, &params), first);
    for text in [text, "G0 X90 Z30\nM30\n"] {
        assert_eq!(apart.run(text, &params), whole(&mut sim, text, &params));
    }
}

/// Another board may be at work by its beat, which does not end and does not lose count meanwhile.
#[test]
fn a_board_that_is_made_anew_goes_on_giving_the_beat() {
    let params = Params::slant_bed();
    let (mut giver, mut other) = (Apart::new(&params), follower());
    let mut ear = SyncConsumer::new();
    let mut both = |giver: &mut Apart, other: &mut Apart| {
        giver.bench.given = None;
        giver.tick.tick(&mut giver.bench);
        let mut heard = SyncHeard::NONE;
        if let Some(beat) = giver.bench.given.and_then(|sync| ear.receive(&sync)) {
            heard.note(beat);
        }
        other.bench.beat = Some((SyncProducer::new(), heard));
        other.step();
    };
    while !other.bench.events.contains(&Event::Ready) {
        both(&mut giver, &mut other);
        giver.rest();
    }
    for call in &calls("M3 S600\nG0 X60 Z5\nG98 G1 Z-50 F1000\nM30\n", &params) {
        assert!(other.background.offer(call));
        other.rest();
    }
    for round in 0..3 {
        for _ in 0..100 {
            both(&mut giver, &mut other);
            giver.rest();
        }
        giver.restart();
        // Its background takes its time.
        for _ in 0..10 * round {
            both(&mut giver, &mut other);
        }
        for _ in 0..100 {
            both(&mut giver, &mut other);
            giver.rest();
        }
        assert_eq!(giver.bench.events, [Event::Ready]);
        let snapshot = other.background.snapshot();
        assert_eq!(snapshot.state, State::Running);
        assert_eq!(snapshot.sync_late, 0);
    }
}

/// Begun anew, the machine knows of no feed hold; a contact that is still pressed holds it again.
#[test]
fn a_feed_hold_that_stays_pressed_outlives_a_restart_of_the_application() {
    let mut apart = Apart::new(&Params::slant_bed());
    for pressed in [true, false] {
        apart.bench.inputs.hold = true;
        apart.step();
        apart.step();
        assert!(apart.background.snapshot().operator.hold);
        apart.bench.inputs.hold = pressed;
        apart.step();
        apart.restart();
        for _ in 0..100 {
            apart.step();
        }
        assert_eq!(apart.bench.events, [Event::Ready]);
        assert_eq!(apart.background.snapshot().operator.hold, pressed);
        apart.order(Order::Resume);
        apart.bench.inputs.hold = false;
        for _ in 0..4 {
            apart.step();
        }
        assert!(!apart.background.snapshot().operator.hold);
    }
}

/// The alarm the machine stands on, behind so many ticks.
fn alarm(apart: &mut Apart, ticks: u32) -> Option<Code> {
    for _ in 0..ticks {
        apart.step();
    }
    match apart.background.snapshot().state {
        State::Alarm(alarm) => Some(alarm.code),
        _ => None,
    }
}

#[test]
fn a_controller_that_leaves_the_bus_stops_the_machine_and_comes_back_once_it_stands() {
    let params = Params::slant_bed();
    let mut apart = Apart::new(&params);
    let calls = calls("G0 X60 Z5\nG98 G1 Z-50 F1000\nM30\n", &params);
    let mut calls = calls.iter();
    let mut next = calls.next();
    for _ in 0..200 {
        while next.is_some_and(|call| apart.background.offer(call)) {
            next = calls.next();
        }
        apart.step();
    }
    assert_eq!(apart.background.snapshot().state, State::Running);
    apart.bench.controller = Controller {
        state: BusState::Off,
        errors: ErrorCounts {
            sending: 248,
            receiving: 0,
        },
    };
    for _ in 0..3 {
        apart.step();
    }
    assert_eq!(apart.bench.rejoined, 0, "not while it moves");
    assert_eq!(alarm(&mut apart, 1000), Some(Code::BusOff));
    assert_eq!(apart.bench.rejoined, 1);
    let boot_up = CobId::of(Service::Heartbeat, NodeId::BOARD);
    assert!(
        apart
            .bench
            .sent
            .iter()
            .any(|frame| frame.id() == boot_up && frame.payload() == [0])
    );
}

#[test]
fn a_second_master_is_noticed_whichever_side_hears_it() {
    let params = Params::slant_bed();
    let setpoint = CobId::of(Service::Rpdo1, NodeId::DRIVE_X);
    let frame = Frame::new(setpoint, &[0x0F, 0, 0, 0, 0, 0, 0]).expect("a frame");
    for heard_by_tick in [true, false] {
        let mut apart = Apart::new(&params);
        if heard_by_tick {
            apart.bench.answers.push_back(frame);
        } else {
            apart.bench.others.push_back(frame);
        }
        assert_eq!(alarm(&mut apart, 1000), Some(Code::SecondSetpoints));
    }
}

#[test]
fn behind_a_failure_nothing_moves_before_a_reset() {
    let params = Params::slant_bed();
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
        for _ in 0..500 {
            apart.step();
        }
        assert_eq!(
            apart.background.snapshot().state,
            State::Alarm(failure.alarm())
        );
        assert_eq!(failure.alarm().code, code);
        let number = failure.alarm().number();
        let emergency = match code {
            Code::PowerDropped => 0x3200,
            _ => 0x6100,
        };
        assert!(apart.has_told(emergency, number));
        assert!(apart.bench.events.is_empty());
        apart.order(Order::Reset);
        for _ in 0..500 {
            apart.step();
        }
        assert_eq!(apart.background.snapshot().state, State::Idle);
        assert_eq!(
            apart.run("G0 X60 Z5\nM30\n", &params),
            whole(&mut sim(&params), "G0 X60 Z5\nM30\n", &params)
        );
    }
}

#[test]
fn behind_too_many_failures_nothing_lets_it_move() {
    let params = Params::slant_bed();
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
            // The application begins anew, and so it does with other parameters.
            2 => {
                let anew = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
                apart.bench.others.push_back(anew);
            }
            3 => apart.order(Order::Reset),
            _ => {}
        }
        for _ in 0..500 {
            apart.step();
        }
        assert_eq!(apart.background.snapshot().state, at_rest);
    }
    assert!(apart.has_told(0x6100, Code::FailsAgain.number()));
    assert!(apart.bench.events.is_empty());
}

#[test]
fn a_reset_from_outside_is_in_the_event_log() {
    let params = Params::slant_bed();
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

#[test]
fn the_serial_number_is_an_object() {
    let mut apart = Apart::started(&Params::slant_bed(), None, ResetCause::Power);
    assert_eq!(apart.object(0x1018, 4), 0x1234_5678);
}

/// Events come here before the report of their tick: the last error of a thread behind the reset that has ended it.
#[test]
fn a_reset_in_a_thread_or_a_tap_leaves_one_record_of_it() {
    let params = Params::slant_bed();
    let before = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\n";
    let thread = format!("{before}G76 X76 Z-30 P20000 Q15000 F3\nG0 X100 Z50\nM30\n");
    let rigid = "G98\nG0 X50 Z0\nM29 S1000\nG84 Z-50 P30 F2000\nG80\nM30\n";
    let ordinary = "G98\nG0 X50 Z0\nM3 S300\nG84 Z-20 P30 F300\nG80\nM30\n";
    for (text, line, kind) in [
        (&thread[..], 5, ThreadKind::Thread),
        (rigid, 4, ThreadKind::RigidTap),
        (ordinary, 4, ThreadKind::FloatingTap),
    ] {
        let mut apart = Apart::new(&params);
        let mut waiting: VecDeque<Call> = calls(text, &params).into();
        let (mut ticks, mut over) = (0, false);
        apart.bench.events.clear();
        while !over {
            while waiting
                .front()
                .is_some_and(|call| apart.background.offer(call))
            {
                waiting.pop_front();
                apart.rest();
            }
            apart.step();
            ticks += u32::from(apart.tick.output().setpoint.locked);
            if ticks == 300 {
                ticks += 1;
                waiting.clear();
                apart.order(Order::Reset);
            }
            over = apart.bench.events.contains(&Event::Reset);
        }
        for _ in 0..100 {
            apart.step();
        }
        let first = (1, line, kind, ThreadState::CutShort, 1);
        assert_eq!(apart.threads(), [first]);
        // Another one behind it.
        let (next, second) = if kind == ThreadKind::RigidTap {
            let way_out = (2, 1, kind, ThreadState::Finished, 1);
            ("G30 P99\nM30\n", way_out)
        } else {
            (
                &thread[..],
                (2, 5, ThreadKind::Thread, ThreadState::Finished, 3),
            )
        };
        if kind == ThreadKind::FloatingTap {
            // Out of the hole first.
            apart.run("G0 Z10\nM30\n", &params);
        }
        apart.run(next, &params);
        apart.step();
        assert_eq!(apart.threads(), [second, first]);
    }
}
