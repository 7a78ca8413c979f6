//! A wire with a board and four drives, sound until something is changed.

use leadscrew_can::{ErrorFrame, Packet, Stamp};
use leadscrew_core::bus::{CobId, Frame, NodeId};
use leadscrew_core::params::{Entry, Params};

use crate::doctor::machine::{Clock, Machine};
use crate::doctor::{Doctor, Report};

/// X, Z, C and spindle 1, and the SYNC in four at which each answers.
const DRIVES: [(u8, u64); 4] = [(16, 1), (17, 0), (18, 3), (32, 2)];

type Of<T> = Box<dyn Fn(u64) -> T>;
type Keep = Box<dyn Fn(u64, &Packet) -> bool>;
type Position = Box<dyn Fn(&dyn Fn(i64) -> i32, i64) -> i32>;

/// A wire.
pub struct Scene {
    pub machine: Machine,
    pub ms: u64,
    /// µs from SYNC to SYNC.
    pub period: u64,
    pub every: u64,
    pub same_place: bool,
    pub moves: bool,
    /// Its target is a thousand counts off within two periods.
    pub steep: bool,
    actual: Position,
    word: Of<u16>,
    control: Of<u16>,
    keep: Keep,
    extra: Vec<(u64, Packet)>,
}

/// A frame.
pub fn frame(id: u16, payload: &[u8]) -> Packet {
    Packet::Frame(Frame::new(CobId::new(id).unwrap(), payload).unwrap())
}

/// An error frame: class, and counters for sending and receiving.
pub fn error(class: u32, tx: u8, rx: u8) -> Packet {
    Packet::Error(ErrorFrame {
        class,
        data: [0, 0, 0, 0, 0, 0, tx, rx],
    })
}

impl Scene {
    pub fn new() -> Self {
        let params = Params::slant_bed();
        let mut machine = Machine::new(params, true, NodeId::BOARD, Clock::Kernel);
        machine
            .drives
            .retain(|drive| DRIVES.iter().any(|(node, _)| *node == drive.node.get()));
        Self {
            machine,
            ms: 4000,
            period: 1000,
            every: 4,
            same_place: false,
            moves: false,
            steep: false,
            actual: Box::new(|target, k| target(k)),
            word: Box::new(|_| 0x1237),
            control: Box::new(|_| 0x000F),
            keep: Box::new(|_, _| true),
            extra: Vec::new(),
        }
    }

    /// X goes 20000 counts there and back; where it is follows from its targets by number of the period.
    pub fn moving(actual: impl Fn(&dyn Fn(i64) -> i32, i64) -> i32 + 'static) -> Self {
        let mut scene = Self::new();
        scene.moves = true;
        scene.actual = Box::new(actual);
        scene
    }

    /// The statusword of X at a ms.
    pub fn word(mut self, word: impl Fn(u64) -> u16 + 'static) -> Self {
        self.word = Box::new(word);
        self
    }

    /// The controlword of X at a ms.
    pub fn control(mut self, control: impl Fn(u64) -> u16 + 'static) -> Self {
        self.control = Box::new(control);
        self
    }

    /// What is on the wire at a µs.
    pub fn keep(mut self, keep: impl Fn(u64, &Packet) -> bool + 'static) -> Self {
        self.keep = Box::new(keep);
        self
    }

    pub fn packet(&mut self, us: u64, packet: Packet) {
        self.extra.push((us, packet));
    }

    /// At a ms, behind all of its period.
    pub fn frame(&mut self, ms: u64, id: u16, payload: &[u8]) {
        self.packet(ms * 1000 + 900, frame(id, payload));
    }

    /// The machine has a block of inputs and outputs at node 70.
    pub fn with_block() -> Self {
        let mut scene = Self::new();
        let entry = Entry::find_text("9461").unwrap();
        scene.machine.params.set(entry, 70).unwrap();
        scene.machine.block = NodeId::new(70);
        scene
    }

    /// The board gives X and Z their setpoints in this mode.
    pub fn streams_in(&mut self, mode: i64) {
        for key in ["9076.X", "9076.Z"] {
            let entry = Entry::find_text(key).unwrap();
            self.machine.params.set(entry, mode).unwrap();
        }
    }

    /// The node is asked for an object and tells it, or is told it.
    pub fn object(&mut self, ms: u64, node: u16, [index, sub]: [u16; 2], value: u32, write: bool) {
        let [low, high] = index.to_le_bytes();
        let [a, b, c, d] = value.to_le_bytes();
        let (ask, told) = if write { (0x23, 0x60) } else { (0x40, 0x43) };
        let request = [ask, low, high, sub as u8, a, b, c, d];
        self.frame(ms, 0x600 + node, &request);
        let reply = [told, low, high, sub as u8, a, b, c, d];
        self.frame(ms, 0x580 + node, &reply);
    }

    /// Something is written, and refused.
    pub fn refused(&mut self, ms: u64, node: u16, [index, sub]: [u16; 2], code: u32) {
        let [low, high] = index.to_le_bytes();
        let [a, b, c, d] = code.to_le_bytes();
        self.frame(ms, 0x600 + node, &[0x23, low, high, sub as u8, 1, 0, 0, 0]);
        self.frame(ms, 0x580 + node, &[0x80, low, high, sub as u8, a, b, c, d]);
    }

    fn target(&self, k: i64) -> i32 {
        if !self.moves {
            return 0;
        }
        if self.steep {
            return i32::try_from(((k - 500).clamp(0, 12)) * 500).unwrap();
        }
        // A ramp up, a steady part, a ramp down; back again after a second of rest.
        let way = |t: i64| -> i64 {
            let t = t.clamp(0, 600);
            match t {
                0..=200 => t * t / 8,
                201..=400 => 5000 + (t - 200) * 50,
                _ => 20_000 - (600 - t) * (600 - t) / 8,
            }
        };
        i32::try_from(way(k - 500) - way(k - 2200)).unwrap()
    }

    pub fn report(self) -> Report {
        let mut all: Vec<(u64, Packet)> = Vec::new();
        for k in 0..self.ms * 1000 / self.period {
            let (at, ms) = (k * self.period, k * self.period / 1000);
            let signed = i64::try_from(k).unwrap();
            let counter = u8::try_from(k % 240 + 1).unwrap();
            all.push((at, frame(0x080, &[counter])));
            for (place, (node, turn)) in DRIVES.into_iter().enumerate() {
                let place = u64::try_from(place).unwrap();
                let x = node == 16;
                let told = if x { self.target(signed) } else { 0 };
                let control = if x { (self.control)(ms) } else { 0x000F };
                let [a, b] = control.to_le_bytes();
                let [c, d, e, f] = told.to_le_bytes();
                let id = 0x200 + u16::from(node);
                all.push((at + 100 + 50 * place, frame(id, &[a, b, c, d, e, f])));
                let turn = if self.same_place { 0 } else { turn };
                if u64::from(counter) % self.every == turn % self.every {
                    let target = |k| self.target(k);
                    // At this SYNC the drive latches what was told in the period before.
                    let is = if x {
                        (self.actual)(&target, signed - 1)
                    } else {
                        0
                    };
                    let word = if x { (self.word)(ms) } else { 0x1237 };
                    let [a, b] = word.to_le_bytes();
                    let [c, d, e, f] = is.to_le_bytes();
                    let id = 0x180 + u16::from(node);
                    all.push((at + 50 + 10 * place, frame(id, &[a, b, c, d, e, f])));
                }
            }
            if ms.is_multiple_of(10) && (k * self.period).is_multiple_of(1000) {
                all.push((at + 400, frame(0x181, &[1, 0, 0, 0, 0, 0, 0, 8])));
                let [a, b] = u16::try_from(ms % 65536).unwrap().to_le_bytes();
                all.push((at + 450, frame(0x681, &[a, b, 0, 0, 0, 0, 0, 0])));
            }
            if ms.is_multiple_of(500) && (k * self.period).is_multiple_of(1000) {
                all.push((at + 500, frame(0x701, &[5])));
            }
        }
        all.retain(|(at, packet)| (self.keep)(*at, packet));
        all.extend(self.extra);
        all.sort_by_key(|(at, _)| *at);
        let mut doctor = Doctor::new(self.machine);
        doctor.until(Stamp::from_micros(0));
        for (at, packet) in &all {
            doctor.push(Stamp::from_micros(*at), packet);
        }
        doctor.until(Stamp::from_micros(self.ms * 1000));
        doctor.report()
    }
}

/// Frames with this identifier.
pub fn is(packet: &Packet, id: u16) -> bool {
    packet.frame().is_some_and(|frame| frame.id().get() == id)
}
