//! A board with its machine, reachable as a Lawicel adapter on a TCP port: what `--bus slcan:tcp:…` needs, without
//! devices and without privileges. Every client hears the board and the other clients, as on a wire.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU16, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use leadscrew::trace::{Setpoint, SetpointHash};
use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_board_sim::{Row, Sim};
use leadscrew_core::bus::{CobId, Frame, NodeId, Service};
use leadscrew_core::params::{Entry, Params};
use leadscrew_slcan::{Adapter, BitRate, Heard, Lines, SlcanFrame};

/// Ticks taken in one go at most, before clients are heard again.
const BURST: u32 = 20;

/// A client that is silent in a transfer for so long is not waited for any more.
const GONE: Duration = Duration::from_secs(1);

/// Virtual time for a second of real time, where nothing has to happen in between.
const HURRY: u32 = 1000;

/// What stands behind the port.
#[derive(Clone, Debug)]
pub struct Options {
    /// Numbers of the boards.
    pub nodes: Vec<u8>,
    /// Parameters other than the built-in machine's.
    pub set: Vec<(&'static str, i64)>,
    /// Virtual time for a second of real time.
    pub speed: u32,
    /// The key of the link that the boards claim to speak, instead of their own.
    pub key: Option<u32>,
    /// The boards' flash refuses every write.
    pub flash_fails: bool,
    /// So long passes between two looks at what clients send.
    pub lag: Duration,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            nodes: vec![1],
            // Heartbeats come in real time, and the machine runs faster; its time waits for them.
            set: vec![("9024", 20_000)],
            speed: 20,
            key: None,
            flash_fails: false,
            lag: Duration::ZERO,
        }
    }
}

/// What came out of the first board.
#[derive(Debug, Default)]
pub struct Seen {
    /// Hash of its setpoints.
    pub hash: SetpointHash,
    /// The bit rate that the last client has set its adapter to.
    pub bit_rate: Option<BitRate>,
    /// What clients have sent, and what the SDO servers have answered.
    pub dialogue: Vec<Frame>,
    /// Clients that are there.
    pub clients: usize,
}

/// What is turned while it serves.
struct Knobs {
    ends: AtomicBool,
    unplugged: AtomicBool,
    speed: AtomicU32,
    /// 0: it stays.
    power_goes_at: AtomicU16,
}

/// A server until it is dropped.
pub struct Server {
    port: u16,
    knobs: Arc<Knobs>,
    seen: Arc<Mutex<Seen>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Switches the machine on.
    pub fn start(options: &Options) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.set_nonblocking(true).unwrap();
        let port = listener.local_addr().unwrap().port();
        let knobs = Arc::new(Knobs {
            ends: AtomicBool::new(false),
            unplugged: AtomicBool::new(false),
            speed: AtomicU32::new(options.speed),
            power_goes_at: AtomicU16::new(0),
        });
        let seen = Arc::new(Mutex::new(Seen::default()));
        let (turned, told, options) = (knobs.clone(), seen.clone(), options.clone());
        let thread = std::thread::Builder::new()
            .stack_size(32 << 20)
            .spawn(move || serve(&listener, &options, &turned, &told))
            .unwrap();
        Self {
            port,
            knobs,
            seen,
            thread: Some(thread),
        }
    }

    /// The `--bus` to reach it.
    pub fn bus(&self) -> String {
        format!("slcan:tcp:127.0.0.1:{}", self.port)
    }

    /// Nothing has to happen at its time any more: what is left goes by fast.
    pub fn hurry(&self) {
        self.knobs.speed.store(HURRY, Ordering::Relaxed);
    }

    /// The power of the boards goes for a moment before they hear that this object is written to.
    pub fn cut_power_at(&self, index: u16) {
        self.knobs.power_goes_at.store(index, Ordering::Relaxed);
    }

    /// The boards answer nothing any more.
    pub fn unplug(&self) {
        self.knobs.unplugged.store(true, Ordering::Relaxed);
    }

    /// The bit rate that the last client has set its adapter to.
    pub fn bit_rate(&self) -> Option<BitRate> {
        self.seen.lock().unwrap().bit_rate
    }

    /// What clients have sent, and what the SDO servers have answered, since the last time somebody asked. Waits until the
    /// last client has been heard to its end and is gone.
    pub fn dialogue(&self) -> Vec<Frame> {
        loop {
            let mut seen = self.seen.lock().unwrap();
            if seen.clients == 0 {
                return std::mem::take(&mut seen.dialogue);
            }
            drop(seen);
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// True where somebody has asked for this object of a node, or written it.
    pub fn was_asked(&self, node: u8, object: [u8; 3]) -> bool {
        let request = CobId::of(Service::SdoRequest, NodeId::new(node).unwrap());
        let asked = |frame: &Frame| {
            frame.id() == request && frame.payload().get(1..4) == Some(object.as_slice())
        };
        self.seen.lock().unwrap().dialogue.iter().any(asked)
    }

    /// Hash of the first board's setpoints so far.
    pub fn hash(&self) -> String {
        self.seen.lock().unwrap().hash.text()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.knobs.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A client of the adapter.
struct Client {
    number: u64,
    line: TcpStream,
    adapter: Adapter,
    lines: Lines,
    out: Vec<u8>,
    /// The tick of its newest heartbeat.
    beat: Option<u64>,
}

impl Client {
    fn new(number: u64, line: TcpStream) -> Self {
        line.set_nonblocking(true).unwrap();
        line.set_nodelay(true).unwrap();
        Self {
            number,
            line,
            adapter: Adapter::new(0x10, 0x10, *b"TEST"),
            lines: Lines::new(),
            out: Vec::new(),
            beat: None,
        }
    }

    /// What it sends to the bus; false where it is gone behind that.
    fn hear(&mut self) -> (Vec<Frame>, bool) {
        let mut frames = Vec::new();
        let mut bytes = [0; 4096];
        loop {
            match self.line.read(&mut bytes) {
                Ok(0) => return (frames, false),
                Ok(count) => {
                    for byte in &bytes[..count] {
                        let Some(heard) = self.lines.push(*byte) else {
                            continue;
                        };
                        if heard == Heard::Bell {
                            continue;
                        }
                        let handled = self.adapter.handle(heard);
                        self.out.extend(handled.reply.line().bytes());
                        if let Some(SlcanFrame::Data(frame)) = handled.send {
                            frames.push(frame);
                        }
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return (frames, true),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return (frames, false),
            }
        }
    }

    fn tell(&mut self, frame: &Frame) {
        if let Some(reply) = self.adapter.received(&SlcanFrame::Data(*frame), 0) {
            self.out.extend(reply.line().bytes());
        }
    }

    /// False where it is gone.
    fn flush(&mut self) -> bool {
        while !self.out.is_empty() {
            match self.line.write(&self.out) {
                Ok(0) => return false,
                Ok(count) => drop(self.out.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return true,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        }
        true
    }
}

fn serve(listener: &TcpListener, options: &Options, knobs: &Knobs, seen: &Mutex<Seen>) {
    let mut params = Params::sheets();
    for (key, value) in &options.set {
        params.set(Entry::find_text(key).unwrap(), *value).unwrap();
    }
    let power_up = |node: &u8| {
        let mut flash = Flash::erased();
        if options.flash_fails {
            flash.fail_after(0);
        }
        let plant = PlantOptions::default();
        let mut sim = Box::new(Sim::with_flash(&params, &plant, flash).unwrap());
        sim.join(NodeId::new(*node).unwrap()).unwrap();
        sim
    };
    let mut boards: Vec<Box<Sim>> = options.nodes.iter().map(power_up).collect();
    let mut clients: Vec<Client> = Vec::new();
    // Ticks without a heartbeat after which a gateway counts as lost; 0: never.
    let silence = u64::from(params.gateway_silence_ms()) * 1000 / u64::from(params.tick_us());
    let mut looked = Instant::now();
    let mut gone_by_us = 0;
    let mut last_heard = looked;
    let mut came = 0;
    let mut next = false;
    let mut due = 0_u64;
    let mut ticks = 0_u64;
    while !knobs.ends.load(Ordering::Relaxed) {
        while let Ok((line, _)) = listener.accept() {
            came += 1;
            clients.push(Client::new(came, line));
            seen.lock().unwrap().clients = clients.len();
        }
        let plugged = !knobs.unplugged.load(Ordering::Relaxed);
        let mut busy = false;
        let mut heard = Vec::new();
        clients.retain_mut(|client| {
            let (frames, stays) = client.hear();
            let beats =
                |frame: &Frame| matches!(frame.id().service(), Some((Service::Heartbeat, _)));
            if frames.iter().any(beats) {
                client.beat = Some(ticks);
            }
            if let Some(rate) = client.adapter.bit_rate() {
                seen.lock().unwrap().bit_rate = Some(rate);
            }
            heard.extend(frames.into_iter().map(|frame| (client.number, frame)));
            stays
        });
        for (from, frame) in heard {
            busy = true;
            last_heard = Instant::now();
            seen.lock().unwrap().dialogue.push(frame);
            for client in &mut clients {
                if client.number != from {
                    client.tell(&frame);
                }
            }
            let index = knobs.power_goes_at.load(Ordering::Relaxed);
            if index != 0 && is_download(&frame, index) {
                knobs.power_goes_at.store(0, Ordering::Relaxed);
                boards = options.nodes.iter().map(power_up).collect();
                for sim in &mut boards {
                    say(sim, &mut clients, (options.key, &mut next), seen);
                }
            }
            if plugged {
                for sim in &mut boards {
                    sim.receive(&frame);
                    sim.settle();
                    say(sim, &mut clients, (options.key, &mut next), seen);
                }
            }
        }
        let last = std::mem::replace(&mut looked, Instant::now());
        let speed = u64::from(knobs.speed.load(Ordering::Relaxed));
        gone_by_us += u64::try_from((looked - last).as_micros()).unwrap() * speed;
        let now = gone_by_us / u64::from(params.tick_us());
        due = due.max(now.saturating_sub(1000));
        let mut burst = 0;
        // Lock-step: no tick while the program's next call has not come, nor in the middle of a transfer, nor as long
        // as the heartbeat of a gateway that is there would be missed: clients have real time only.
        let waits = |boards: &[Box<Sim>], clients: &[Client], ticks: u64| {
            let late = |client: &Client| client.beat.is_some_and(|at| ticks - at > silence / 2);
            if silence > 0 && clients.iter().any(late) {
                return true;
            }
            let transfers = last_heard.elapsed() < GONE;
            let waits = |sim: &Sim| sim.awaits_program() || transfers && sim.is_transferring();
            boards.iter().any(|sim| waits(sim))
        };
        while due < now && burst < BURST && !waits(&boards, &clients, ticks) {
            for (n, sim) in boards.iter_mut().enumerate() {
                let row = sim.step();
                while sim.event().is_some() {}
                if let (0, Some(row)) = (n, row) {
                    let mut seen = seen.lock().unwrap();
                    seen.hash.push(&setpoint(&row));
                }
                if plugged {
                    say(sim, &mut clients, (options.key, &mut next), seen);
                } else {
                    while sim.transmit().is_some() {}
                }
            }
            ticks += 1;
            due += 1;
            burst += 1;
        }
        if waits(&boards, &clients, ticks) {
            due = due.max(now);
            // A transfer goes on without time.
            for sim in &mut boards {
                sim.settle();
                if plugged {
                    say(sim, &mut clients, (options.key, &mut next), seen);
                }
            }
        }
        clients.retain_mut(Client::flush);
        std::thread::sleep(options.lag);
        seen.lock().unwrap().clients = clients.len();
        if !busy && burst == 0 {
            std::thread::sleep(Duration::from_micros(100));
        }
    }
}

/// Somebody begins to write this object, of whichever node.
fn is_download(frame: &Frame, index: u16) -> bool {
    let [low, high] = index.to_le_bytes();
    let request = matches!(frame.id().service(), Some((Service::SdoRequest, _)));
    request
        && matches!(frame.payload(), [command, l, h, ..] if command >> 5 == 1 && [*l, *h] == [low, high])
}

/// `key`: what the boards claim, and whether the frame that says it is the next one.
fn say(
    sim: &mut Sim,
    clients: &mut [Client],
    (key, next): (Option<u32>, &mut bool),
    seen: &Mutex<Seen>,
) {
    while let Some(mut frame) = sim.transmit() {
        if matches!(frame.id().service(), Some((Service::SdoReply, _))) {
            seen.lock().unwrap().dialogue.push(frame);
        }
        if let Some(key) = key
            && frame.id() == CobId::of(Service::SdoReply, NodeId::BOARD)
        {
            let mut payload = frame.payload().to_vec();
            if std::mem::take(next) {
                payload[1..5].copy_from_slice(&key.to_le_bytes());
                frame = Frame::new(frame.id(), &payload).unwrap();
            } else {
                // The answer to who asks for 5020h:02: the value follows.
                *next = payload.starts_with(&[0x41, 0x20, 0x50, 0x02]);
            }
        }
        for client in &mut *clients {
            client.tell(&frame);
        }
    }
}

fn setpoint(row: &Row) -> Setpoint {
    Setpoint {
        tick: row.tick,
        x_nm: row.position.x.nm(),
        z_nm: row.position.z.nm(),
        c_udeg: row.position.c.udeg(),
        s1_set_urev: row
            .spindle_set
            .map(|angle| leadscrew_board_sim::plant::FineTurns::from_turns(angle).micro_turns()),
        state: row.doing,
        ..Setpoint::default()
    }
}
