//! A CANopen node for other people's programs to talk to: the core's own NMT, heartbeat, emergencies and SDO over a few
//! made-up objects, on a wire that is a TCP connection.
//!
//! Prints its port, serves one connection and ends with it. On the wire a frame is 13 bytes: identifier (32 bits, little-
//! endian), length, eight data bytes.
//!
//! | object | what |
//! |---|---|
//! | 1000h, 1001h, 1003h, 1008h, 1017h | as CiA 301 has them |
//! | 2000h | any bytes, up to a mebibyte |
//! | 2001h | 16 bits, 10 to 100 |
//! | 2002h | writing loses the frame that comes so many frames later |
//! | 2003h | writing raises that alarm, 0 clears it |
//! | 2004h | writing makes this node a client: it copies object 2010h of that node to its 2011h, by the protocol (0 short, 1 block) in the second byte |
//! | 2005h | how that ended: 0 under way, 1 well, else the abort code |

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use leadscrew_core::bus::{
    Abort, BlockSize, CobId, Emcy, EmcyProducer, Frame, HeartbeatProducer, NmtEvent, NmtSlave,
    NodeId, Object, Objects, Periods, SdoDownload, SdoError, SdoProtocol, SdoServer, SdoSink,
    SdoUpload, Service,
};

const NODE: NodeId = NodeId::BOARD;
const TICK_US: u32 = 1000;
/// How long an answer may take, of a computer that is busy.
const PATIENCE_MS: u32 = 60_000;
const ANY: Object = Object::new(0x2000, 0);
const RANGED: Object = Object::new(0x2001, 0);
const LOSE: Object = Object::new(0x2002, 0);
const ALARM: Object = Object::new(0x2003, 0);
const COPY: Object = Object::new(0x2004, 0);
const COPIED: Object = Object::new(0x2005, 0);
const HEARTBEAT: Object = Object::new(0x1017, 0);

fn main() -> ExitCode {
    match serve() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn serve() -> std::io::Result<()> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    println!("{}", listener.local_addr()?.port());
    let (stream, _) = listener.accept()?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(Duration::from_millis(1)))?;
    Node::new(stream).run()
}

/// What the objects are.
struct Dictionary {
    values: BTreeMap<Object, Vec<u8>>,
    /// What is being written.
    staged: Vec<u8>,
    emcy: EmcyProducer<8>,
    /// What was written since the node looked last.
    written: Option<Object>,
}

impl Dictionary {
    fn new() -> Self {
        let mut values = BTreeMap::new();
        values.insert(Object::new(0x1000, 0), 402_u32.to_le_bytes().to_vec());
        values.insert(Object::new(0x1008, 0), b"Leadscrew test node".to_vec());
        values.insert(HEARTBEAT, 0_u16.to_le_bytes().to_vec());
        values.insert(ANY, Vec::new());
        values.insert(RANGED, 50_u16.to_le_bytes().to_vec());
        for object in [LOSE, ALARM, COPY] {
            values.insert(object, vec![0, 0]);
        }
        values.insert(COPIED, vec![0; 4]);
        Self {
            values,
            staged: Vec::new(),
            emcy: EmcyProducer::new(NODE),
            written: None,
        }
    }

    fn value(&self, object: Object) -> Result<Vec<u8>, Abort> {
        match object.index {
            0x1001 if object.sub == 0 => Ok(vec![self.emcy.register()]),
            0x1003 if object.sub == 0 => Ok(vec![self.emcy.history(0)? as u8]),
            0x1003 => Ok(self.emcy.history(object.sub)?.to_le_bytes().to_vec()),
            _ => match self.values.get(&object) {
                Some(value) => Ok(value.clone()),
                None if self.values.keys().any(|known| known.index == object.index) => {
                    Err(Abort::NoSubIndex)
                }
                None => Err(Abort::NoObject),
            },
        }
    }

    fn word(&self, object: Object) -> u16 {
        match self.values.get(&object).map(Vec::as_slice) {
            Some([low, high]) => u16::from_le_bytes([*low, *high]),
            _ => 0,
        }
    }
}

impl Objects for Dictionary {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        Ok(self.value(object)?.len() as u32)
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        let value = self.value(object)?;
        let rest = value.get(offset as usize..).unwrap_or_default();
        let len = rest.len().min(into.len());
        into[..len].copy_from_slice(&rest[..len]);
        Ok(len)
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        let now = self.value(object)?.len() as u32;
        self.staged.clear();
        match (object, size) {
            (ANY, Some(size)) if size > 1 << 20 => Err(Abort::OutOfMemory),
            (ANY, _) => Ok(()),
            (Object { index: 0x1003, .. }, _) => Ok(()),
            (RANGED | LOSE | ALARM | COPY | HEARTBEAT, Some(size)) if size > now => {
                Err(Abort::TooLong)
            }
            (RANGED | LOSE | ALARM | COPY | HEARTBEAT, Some(size)) if size < now => {
                Err(Abort::TooShort)
            }
            (RANGED | LOSE | ALARM | COPY | HEARTBEAT, _) => Ok(()),
            _ => Err(Abort::ReadOnly),
        }
    }

    fn write(&mut self, _: Object, _: u32, bytes: &[u8]) -> Result<(), Abort> {
        self.staged.extend_from_slice(bytes);
        Ok(())
    }

    fn end_write(&mut self, object: Object, _: u32) -> Result<(), Abort> {
        let value = std::mem::take(&mut self.staged);
        if object.index == 0x1003 {
            let [value] = value[..] else {
                return Err(Abort::Length);
            };
            return self.emcy.write_history(object.sub, value.into());
        }
        if let (RANGED, [low, high]) = (object, &value[..]) {
            match u16::from_le_bytes([*low, *high]) {
                0..10 => return Err(Abort::TooLow),
                10..=100 => {}
                _ => return Err(Abort::TooHigh),
            }
        }
        self.values.insert(object, value);
        self.written = Some(object);
        Ok(())
    }

    fn abandon(&mut self, _: Object) {
        self.staged.clear();
    }
}

#[derive(Default)]
struct Collected(Vec<u8>);

impl SdoSink for Collected {
    fn begin(&mut self, _: Option<u32>) -> Result<(), Abort> {
        self.0.clear();
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), Abort> {
        self.0.extend_from_slice(bytes);
        Ok(())
    }
}

struct Node {
    stream: TcpStream,
    heard: Vec<u8>,
    slave: NmtSlave,
    server: SdoServer,
    heartbeat: HeartbeatProducer,
    objects: Dictionary,
    /// Requests to this node that came while it was a client.
    later: Vec<Frame>,
    /// Frames until one is lost; 0: none.
    lose: u16,
    started: Instant,
    ticked: Instant,
}

impl Node {
    fn new(stream: TcpStream) -> Self {
        let now = Instant::now();
        Self {
            stream,
            heard: Vec::new(),
            slave: NmtSlave::new(NODE),
            server: SdoServer::new(NODE, Periods::new(PATIENCE_MS), BlockSize::MAX),
            heartbeat: HeartbeatProducer::default(),
            objects: Dictionary::new(),
            later: Vec::new(),
            lose: 0,
            started: now,
            ticked: now,
        }
    }

    fn run(mut self) -> std::io::Result<()> {
        let boot = self.slave.boot();
        self.send(&boot)?;
        while let Some(frame) = self.next()? {
            if let Some(frame) = frame {
                self.handle(&frame)?;
            }
            self.tick()?;
            if self
                .objects
                .written
                .take_if(|object| *object == COPY)
                .is_some()
            {
                self.copy()?;
                for frame in std::mem::take(&mut self.later) {
                    self.handle(&frame)?;
                }
            }
        }
        Ok(())
    }

    fn handle(&mut self, frame: &Frame) -> std::io::Result<()> {
        match self.slave.receive(frame) {
            Some(NmtEvent::ResetNode | NmtEvent::ResetCommunication) => {
                self.server.reset(&mut self.objects);
                let boot = self.slave.boot();
                self.send(&boot)?;
            }
            Some(NmtEvent::Entered(_)) | None => {}
        }
        if !self.slave.state().allows_sdo() {
            return Ok(());
        }
        if let Some(answer) = self.server.receive(frame, &mut self.objects) {
            self.send(&answer)?;
        }
        while let Some(segment) = self.server.poll(&mut self.objects) {
            self.send(&segment)?;
        }
        match self.objects.written {
            Some(LOSE) => self.lose = self.objects.word(LOSE),
            Some(HEARTBEAT) => {
                self.heartbeat = HeartbeatProducer::new(self.objects.word(HEARTBEAT), TICK_US);
            }
            Some(ALARM) => match self.objects.word(ALARM) {
                0 => self.objects.emcy.clear(),
                number => self.objects.emcy.raise(Emcy::of_alarm(number)),
            },
            // The rest is not acted on, and the copy waits until the answer is out.
            _ => return Ok(()),
        }
        self.objects.written = None;
        Ok(())
    }

    fn tick(&mut self) -> std::io::Result<()> {
        let ms = self.ticked.elapsed().as_millis() as u32;
        self.ticked += Duration::from_millis(ms.into());
        let by = Periods::new(ms);
        if let Some(abort) = self.server.elapse(by, &mut self.objects) {
            self.send(&abort)?;
        }
        if self.heartbeat.elapse(by) {
            let heartbeat = self.slave.heartbeat();
            self.send(&heartbeat)?;
        }
        self.objects.emcy.elapse(by);
        while self.slave.state().allows_emcy() {
            let Some(message) = self.objects.emcy.poll() else {
                break;
            };
            self.send(&message)?;
        }
        Ok(())
    }

    /// Reads an object of another node and writes it to another object of that node.
    fn copy(&mut self) -> std::io::Result<()> {
        let [number, protocol] = self.objects.word(COPY).to_le_bytes();
        let protocol = match protocol {
            0 => SdoProtocol::Short,
            _ => SdoProtocol::Block,
        };
        let Some(node) = NodeId::new(number) else {
            return Ok(());
        };
        self.objects.values.insert(COPIED, vec![0; 4]);
        let patience = Duration::from_millis(PATIENCE_MS.into());
        let mut data = Collected::default();
        let from = Object::new(0x2010, 0);
        let now = self.started.elapsed();
        let mut upload = SdoUpload::new(node, from, &mut data, protocol, patience, now);
        let outcome = loop {
            let now = self.started.elapsed();
            if let Some(frame) = upload.poll(now) {
                self.send(&frame)?;
            } else if let Some(outcome) = upload.outcome() {
                break outcome;
            } else if let Some(frame) = self.next_reply()? {
                upload.receive(&frame, self.started.elapsed());
            }
        };
        let outcome = outcome.and_then(|()| {
            let to = Object::new(0x2011, 0);
            let now = self.started.elapsed();
            let data = data.0.as_slice();
            let mut download = SdoDownload::new(node, to, data, protocol, patience, now);
            loop {
                let now = self.started.elapsed();
                if let Some(frame) = download.poll(now) {
                    self.send(&frame).map_err(|_| SdoError::TimedOut)?;
                } else if let Some(outcome) = download.outcome() {
                    break outcome;
                } else if let Ok(Some(frame)) = self.next_reply() {
                    download.receive(&frame, self.started.elapsed());
                }
            }
        });
        let code = match outcome {
            Ok(()) => 1,
            Err(SdoError::Refused(code)) => code,
            Err(SdoError::Broken(abort)) => abort.code(),
            Err(SdoError::TimedOut) => Abort::TimedOut.code(),
        };
        self.objects
            .values
            .insert(COPIED, code.to_le_bytes().to_vec());
        Ok(())
    }

    fn send(&mut self, frame: &Frame) -> std::io::Result<()> {
        let mut bytes = [0; 13];
        bytes[..4].copy_from_slice(&u32::from(frame.id().get()).to_le_bytes());
        bytes[4] = frame.payload().len() as u8;
        bytes[5..5 + frame.payload().len()].copy_from_slice(frame.payload());
        self.stream.write_all(&bytes)
    }

    /// The next frame that is no request to this node.
    fn next_reply(&mut self) -> std::io::Result<Option<Frame>> {
        let Some(Some(frame)) = self.next()? else {
            return Ok(None);
        };
        if frame.id() == CobId::of(Service::SdoRequest, NODE) {
            self.later.push(frame);
            return Ok(None);
        }
        Ok(Some(frame))
    }

    /// The next frame, `Some(None)` where none has come for a millisecond, `None` at the end of the connection.
    fn next(&mut self) -> std::io::Result<Option<Option<Frame>>> {
        let mut room = [0; 13 * 64];
        if self.heard.len() < 13 {
            match self.stream.read(&mut room) {
                Ok(0) => return Ok(None),
                Ok(len) => self.heard.extend_from_slice(&room[..len]),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => return Err(error),
            }
        }
        if self.heard.len() < 13 {
            return Ok(Some(None));
        }
        let bytes: Vec<u8> = self.heard.drain(..13).collect();
        if self.lose > 0 {
            self.lose -= 1;
            if self.lose == 0 {
                return Ok(Some(None));
            }
        }
        let id = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let frame = u16::try_from(id)
            .ok()
            .and_then(CobId::new)
            .and_then(|id| Frame::new(id, bytes[5..].get(..bytes[4].into())?));
        Ok(Some(frame))
    }
}
