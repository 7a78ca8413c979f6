//! A board in two sides on its bench.

use std::collections::VecDeque;

use leadscrew_app::{Failure, Memory, PowerUp, ResetCause, Sides, step, tick};
use leadscrew_board_sim::plant::{Plant, PlantOptions};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{
    self, BackgroundSide, Event, Inputs, Output, Snapshot, State, TickSide,
};
use leadscrew_core::bus::{
    BoardCommand, BoardState, CobId, Controller, DataRates, Frame, NmtCommand, NodeId, Order,
    Service,
};
use leadscrew_core::call::Call;
use leadscrew_core::link::{
    SetpointHash, ThreadCertificate, ThreadKind, ThreadReader, ThreadRecord, ThreadState,
};
use leadscrew_core::params::Params;
use leadscrew_core::program::{self, Options};

use crate::bench::Bench;

/// A board on its bench.
pub struct Apart {
    tick: TickSide<'static>,
    pub output: &'static mut Output,
    pub background: BackgroundSide<'static>,
    pub bench: Bench,
    hash: SetpointHash,
    /// The number of the last order.
    count: u8,
}

impl Apart {
    /// Begins the application anew, as an NMT master can. Its events are recorded from there on.
    pub fn restart(&mut self) {
        self.bench.events.clear();
        let anew = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
        self.bench.others.push_back(anew);
        self.rest();
    }

    /// A board that has come up and then run tick 0.
    pub fn new(params: &Params) -> Self {
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

    pub fn off(params: &Params) -> Self {
        Self::behind(params, None)
    }

    /// A number of four bytes in the object dictionary, read within three ticks.
    pub fn object(&mut self, index: u16, sub: u8) -> u32 {
        let [low, high] = index.to_le_bytes();
        let request = CobId::of(Service::SdoRequest, NodeId::BOARD);
        let request = Frame::new(request, &[0x40, low, high, sub, 0, 0, 0, 0]);
        self.bench.others.push_back(request.expect("a frame"));
        self.steps(3);
        let reply = CobId::of(Service::SdoReply, NodeId::BOARD);
        let told = self.bench.sent.iter().find(|frame| frame.id() == reply);
        let value = told.expect("an answer").payload().last_chunk();
        u32::from_le_bytes(*value.expect("eight bytes"))
    }

    /// Reads the records of the last threads (5041h), the newest first: number, line, kind, state, passes. Read in
    /// segments.
    pub fn threads(&mut self) -> Vec<(u32, u32, ThreadKind, ThreadState, u16)> {
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
                ..
            } = thread.record;
            (thread.number, line, kind, state, tally.passes)
        };
        let threads = ThreadReader::new(&bytes).expect("the certificates");
        threads.map(|thread| told(thread.expect("one"))).collect()
    }

    /// True where an emergency message with this code and the number of this alarm was sent.
    pub fn has_told(&self, emergency: u16, number: u16) -> bool {
        self.bench.sent.iter().any(|frame| {
            let payload = frame.payload();
            frame.id().service() == Some((Service::Emcy, NodeId::BOARD))
                && payload[..2] == emergency.to_le_bytes()
                && payload[3..5] == number.to_le_bytes()
        })
    }

    /// A board that is switched on after a failure.
    pub fn behind(params: &Params, failure: Option<Failure>) -> Self {
        Self::started(params, failure, ResetCause::Power)
    }

    pub fn started(params: &Params, failure: Option<Failure>, cause: ResetCause) -> Self {
        // Leaked, so that it lives for ever, as in an image.
        let memory = Box::leak(Box::new(Memory::new()));
        let options = PlantOptions::default();
        let up = PowerUp {
            set: &board::PowerUp::given(params),
            remembered: Some(options.at),
            tap: None,
            node: NodeId::BOARD,
            serial: 0x1234_5678,
            data_rates: DataRates::ALL,
            failure,
            cause,
        };
        let Sides {
            tick,
            output,
            background,
        } = memory.power_up(&up).expect("the parameters work");
        Self {
            tick,
            output,
            background,
            bench: Bench {
                plant: Plant::new(params, &options).expect("the plant works"),
                answers: VecDeque::new(),
                others: VecDeque::new(),
                sent: Vec::new(),
                syncs: 0,
                given: None,
                inputs: Inputs::default(),
                switched: Vec::new(),
                turned: None,
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
    pub fn order(&mut self, order: Order) {
        self.count += 1;
        let command = BoardCommand {
            count: self.count,
            order: Some(order),
            echo: Some(self.background.state().device().beat()),
            ..BoardCommand::default()
        };
        let start = NmtCommand::Start.frame(None);
        self.bench
            .others
            .extend([start, command.frame(NodeId::BOARD)]);
    }

    /// Runs a tick; the background does nothing.
    pub fn tick(&mut self) {
        tick(&mut self.tick, self.output, &mut self.bench);
    }

    /// The tick side, as the background knows it.
    pub fn snapshot(&self) -> &Snapshot {
        self.background.state().snapshot()
    }

    /// Runs a tick, and then all work that the background can do.
    pub fn step(&mut self) {
        self.tick();
        self.rest();
        let (setpoint, snapshot) = (&self.output.setpoint, self.snapshot());
        let spindle = setpoint
            .spindle
            .map(|angle| (snapshot.spindle_in_use, angle));
        let runs = snapshot.board_state() == BoardState::Run;
        self.hash.push(setpoint.position, spindle, runs);
    }

    /// Runs this number of steps.
    pub fn steps(&mut self, count: u32) {
        for _ in 0..count {
            self.step();
        }
    }

    pub fn rest(&mut self) {
        while step(&mut self.background, &mut self.bench) {}
    }

    /// Runs a program to its end, or to an alarm.
    pub fn run(&mut self, text: &str, params: &Params) -> u64 {
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
            if over || matches!(self.snapshot().state, State::Alarm(_)) {
                return self.hash.value();
            }
        }
        panic!("the program does not come to an end");
    }
}

pub fn calls(text: &str, params: &Params) -> Vec<Call> {
    program::Events::new(text.as_bytes(), params, Options::default())
        .filter_map(|event| match event.expect("a good program") {
            program::Event::Call(call) => Some(call),
            _ => None,
        })
        .collect()
}

/// The alarm on which the machine stands, after this number of ticks.
pub fn alarm(apart: &mut Apart, ticks: u32) -> Option<Code> {
    apart.steps(ticks);
    match apart.snapshot().state {
        State::Alarm(alarm) => Some(alarm.code),
        _ => None,
    }
}
