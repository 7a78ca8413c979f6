//! Runs a program that is never in memory as a whole, from its text to the machine: handed over directly, or over the wire
//! in the batches and transfers of a gateway.

use std::collections::VecDeque;
use std::io::Read;

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::board::Event;
use leadscrew_core::bus::{Object, Order, SdoProtocol};
use leadscrew_core::call::{Call, Position, TapSpindle};
use leadscrew_core::link::{Certificate, SetpointHash};
use leadscrew_core::params::Params;
use leadscrew_core::program::{self, Options, Reader};

use crate::gateway::{Gateway, Upload};
use crate::machine::{STANDING_TICKS, machine};

/// Bytes of text read at a time.
const CHUNK: usize = 1 << 14;
/// Calls that wait to be sent.
const WAITING: usize = 64;

/// The calls of a text while it is read.
struct Calls<'p, R> {
    text: R,
    reader: Reader<'p>,
    chunk: Vec<u8>,
    ready: VecDeque<Call>,
    over: bool,
}

impl<'p, R: Read> Calls<'p, R> {
    fn new(text: R, params: &'p Params) -> Self {
        Self {
            text,
            reader: Reader::new(params, Options::default()),
            chunk: vec![0; CHUNK],
            ready: VecDeque::new(),
            over: false,
        }
    }
}

impl<R: Read> Iterator for Calls<'_, R> {
    type Item = Call;

    fn next(&mut self) -> Option<Call> {
        while self.ready.is_empty() && !self.over {
            let count = self.text.read(&mut self.chunk).expect("a text");
            let ready = &mut self.ready;
            let mut take = |event| {
                if let program::Event::Call(call) = event {
                    ready.push_back(call);
                }
            };
            let read = match count {
                0 => self.reader.finish(&mut take),
                _ => self.reader.push(&self.chunk[..count], &mut take),
            };
            read.expect("the program is right");
            self.over = count == 0 || self.reader.interpreter().is_ended();
        }
        self.ready.pop_front()
    }
}

/// The result of a run, with a hash of its setpoints and no list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ran {
    /// Calls handed over.
    pub calls: u64,
    /// Segments begun.
    pub started: u64,
    /// The last move.
    pub moves: u32,
    /// The last line with any action.
    pub line: u32,
    /// Ticks, with the ticks at rest at the end.
    pub ticks: u64,
    /// The last position.
    pub position: Position,
    /// Hash of its setpoints, as `setpoint_hash`.
    pub hash: u64,
    /// True where the end of the program was reached.
    pub finished: bool,
}

/// The observer of a run.
#[derive(Debug)]
struct Watch {
    ran: Ran,
    hash: SetpointHash,
}

impl Watch {
    const fn new(ran: Ran) -> Self {
        Self {
            ran,
            hash: SetpointHash::new(),
        }
    }

    fn row(&mut self, row: &Row) {
        let spindle = row.spindle_set.map(|angle| (TapSpindle::First, angle));
        self.hash
            .push(row.position, spindle, row.doing == Doing::Run);
        self.ran.ticks += 1;
        self.ran.moves = self.ran.moves.max(row.number);
        self.ran.position = row.position;
    }

    fn step(&mut self, sim: &mut Sim) {
        if let Some(row) = sim.step() {
            self.row(&row);
        }
        while let Some(event) = sim.event() {
            match event {
                Event::Started { line, .. } => {
                    self.ran.started += 1;
                    self.ran.line = line;
                }
                Event::Finished => self.ran.finished = true,
                Event::Alarm(alarm) => panic!("{alarm:?}"),
                _ => {}
            }
        }
    }

    fn conclude(mut self, sim: &mut Sim) -> Ran {
        for _ in 0..STANDING_TICKS {
            self.step(sim);
        }
        sim.last_rows(|row| self.row(&row));
        self.ran.hash = self.hash.value();
        self.ran
    }
}

/// Runs a text on a machine that gets its calls directly.
///
/// # Panics
/// For a text that is refused, and at an alarm.
pub fn directly(text: impl Read) -> Ran {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let mut calls = Calls::new(text, &params).peekable();
    let mut watch = Watch::new(Ran::default());
    while calls.peek().is_some() || sim.is_busy() {
        while calls.peek().is_some_and(|call| sim.offer(call)) {
            calls.next();
            watch.ran.calls += 1;
        }
        watch.step(&mut sim);
    }
    watch.conclude(&mut sim)
}

/// Runs a text on a board on the bus. Returns the observed result and the board's own certificate. The calls travel in
/// encoded batches, as much as the board has room for, in block transfers with CRC. A tick waits for the calls that it
/// needs.
///
/// # Panics
/// For a text that is refused, at an alarm, and where a transfer fails.
pub fn over_the_wire(text: impl Read) -> (Ran, Certificate) {
    let params = Params::sheets();
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    let mut calls = Calls::new(text, &params).peekable();
    let mut upload = Upload::new(7, &[]);
    let mut watch = Watch::new(Ran::default());
    let mut feed = |sim: &mut Sim, gateway: &mut Gateway, watch: &mut Watch| {
        loop {
            while upload.waiting() < WAITING
                && let Some(call) = calls.next()
            {
                upload.push(&call);
                watch.ran.calls += 1;
            }
            let fed = upload.feed(gateway, sim);
            // Other frames of the board are not needed.
            gateway.heard.clear();
            gateway.heartbeats.clear();
            if !fed || !sim.awaits_program() {
                return upload.is_done();
            }
        }
    };
    feed(&mut sim, &mut gateway, &mut watch);
    gateway.order(&mut sim, Order::Run);
    sim.settle();
    let mut sent = false;
    while !sent || sim.is_busy() {
        if sim.awaits_program() {
            sent = feed(&mut sim, &mut gateway, &mut watch);
        }
        watch.step(&mut sim);
        gateway.listen(&mut sim);
    }
    let taken = gateway.number(&mut sim, 0x5020, 4).expect("a number");
    assert_eq!(taken, watch.ran.calls, "calls on the board");
    let ran = watch.conclude(&mut sim);
    let bytes = gateway
        .read(&mut sim, Object::new(0x5041, 0), SdoProtocol::Block)
        .expect("a certificate");
    let certificate = Certificate::decode(&bytes)
        .expect("a certificate")
        .expect("of this version");
    (ran, certificate)
}
