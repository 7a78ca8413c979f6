//! Recordings in the format of `candump -l`: `(1700000000.123456) can0 190#2706AB`. `canplayer`, Wireshark and
//! python-can read this format.

use std::fmt;
use std::io::{self, BufRead, Write};

use leadscrew_core::bus::{CobId, Frame};

use crate::{Data, ErrorFrame, FdFrame, Id, Packet, Stamp};

/// The bit that marks an error frame in a log.
const ERROR: u32 = 1 << 29;

/// A line of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Time of the packet.
    pub time: Stamp,
    /// Interface of the packet.
    pub bus: String,
    /// The packet.
    pub packet: Packet,
}

/// Writes a recording.
#[derive(Debug)]
pub struct LogWriter<W: Write> {
    to: W,
    bus: String,
    line: Vec<u8>,
}

impl<W: Write> LogWriter<W> {
    /// An empty recording of the bus with this name; spaces in it become `_`.
    pub fn new(to: W, bus: &str) -> Self {
        Self {
            to,
            bus: bus.replace(char::is_whitespace, "_"),
            line: Vec::with_capacity(160),
        }
    }

    /// Appends a packet.
    ///
    /// # Errors
    /// The output refuses the bytes.
    pub fn push(&mut self, time: Stamp, packet: &Packet) -> io::Result<()> {
        self.line.clear();
        let us = time.nanos() / 1000;
        self.line.push(b'(');
        decimal(&mut self.line, us / 1_000_000, 10);
        self.line.push(b'.');
        decimal(&mut self.line, us % 1_000_000, 6);
        self.line.extend_from_slice(b") ");
        self.line.extend_from_slice(self.bus.as_bytes());
        self.line.push(b' ');
        match packet {
            Packet::Frame(frame) => {
                self.id(Id::Standard(frame.id()));
                self.line.push(b'#');
                self.bytes(frame.payload());
            }
            Packet::Extended(id, data) => {
                self.id(Id::Extended(*id));
                self.line.push(b'#');
                self.bytes(data.bytes());
            }
            Packet::Remote(id, len) => {
                self.id(*id);
                self.line.extend_from_slice(b"#R");
                if *len > 0 {
                    self.line.push(digit(*len));
                }
            }
            Packet::Fd(frame) => {
                self.id(frame.id);
                self.line.extend_from_slice(b"##");
                self.line.push(digit(
                    u8::from(frame.rate_switched) | u8::from(frame.sender_passive) << 1,
                ));
                self.bytes(frame.data.bytes());
            }
            Packet::Error(error) => {
                self.hex(error.class | ERROR, 8);
                self.line.push(b'#');
                self.bytes(&error.data);
            }
        }
        self.line.push(b'\n');
        self.to.write_all(&self.line)
    }

    /// Writes all packets so far to the output.
    ///
    /// # Errors
    /// The output refuses the bytes.
    pub fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }

    /// Writes the remaining packets and gives the output back.
    ///
    /// # Errors
    /// The output refuses the bytes.
    pub fn finish(mut self) -> io::Result<W> {
        self.to.flush()?;
        Ok(self.to)
    }

    fn id(&mut self, id: Id) {
        match id {
            Id::Standard(id) => self.hex(u32::from(id.get()), 3),
            Id::Extended(id) => self.hex(id, 8),
        }
    }

    fn hex(&mut self, value: u32, digits: u32) {
        for place in (0..digits).rev() {
            self.line.push(digit((value >> (4 * place) & 0xF) as u8));
        }
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.line.extend([digit(byte >> 4), digit(byte & 0xF)]);
        }
    }
}

/// The digit of a value below 16.
fn digit(value: u8) -> u8 {
    match value {
        0..=9 => b'0' + value,
        _ => b'A' - 10 + (value & 0xF),
    }
}

fn decimal(line: &mut Vec<u8>, mut value: u64, digits: usize) {
    let mut text = [b'0'; 20];
    let mut used = 0;
    for place in text.iter_mut().rev() {
        if value == 0 && used >= digits {
            break;
        }
        *place = b'0' + (value % 10) as u8;
        value /= 10;
        used += 1;
    }
    line.extend_from_slice(text.get(text.len() - used..).unwrap_or(&text));
}

/// A line that does not belong in a recording.
#[derive(Debug)]
pub struct WrongLine {
    /// Number of the line, from 1.
    pub number: u64,
    /// The error in the line.
    pub reason: String,
}

impl fmt::Display for WrongLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "line {} of the recording: {}; expected `(1700000000.123456) can0 190#2706AB`",
            self.number, self.reason
        )
    }
}

impl std::error::Error for WrongLine {}

/// Reads a recording, line by line.
#[derive(Debug)]
pub struct LogReader<R: BufRead> {
    from: R,
    number: u64,
    text: String,
}

impl<R: BufRead> LogReader<R> {
    /// Reads from `from`.
    pub fn new(from: R) -> Self {
        Self {
            from,
            number: 0,
            text: String::new(),
        }
    }

    fn wrong(&self, reason: impl Into<String>) -> WrongLine {
        WrongLine {
            number: self.number,
            reason: reason.into(),
        }
    }
}

impl<R: BufRead> Iterator for LogReader<R> {
    type Item = Result<Entry, WrongLine>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            self.text.clear();
            self.number += 1;
            match self.from.read_line(&mut self.text) {
                Ok(0) => return None,
                Ok(_) if self.text.trim().is_empty() => {}
                Ok(_) => return Some(entry(&self.text).map_err(|reason| self.wrong(reason))),
                Err(error) => return Some(Err(self.wrong(error.to_string()))),
            }
        }
    }
}

fn entry(text: &str) -> Result<Entry, &'static str> {
    // Newer versions of candump write a direction after the frame.
    let mut words = text.split_ascii_whitespace();
    let (Some(time), Some(bus), Some(frame)) = (words.next(), words.next(), words.next()) else {
        return Err("it has less than three words");
    };
    let time = time
        .strip_prefix('(')
        .and_then(|time| time.strip_suffix(')'))
        .and_then(|time| time.split_once('.'))
        .filter(|(_, fraction)| fraction.len() == 6)
        .and_then(|(seconds, us)| {
            let seconds: u64 = seconds.parse().ok()?;
            let us: u64 = us.parse().ok()?;
            seconds.checked_mul(1_000_000)?.checked_add(us)
        })
        .ok_or("its time is none")?;
    Ok(Entry {
        time: Stamp::from_micros(time),
        bus: bus.to_owned(),
        packet: packet(frame).ok_or("its frame is none")?,
    })
}

fn packet(text: &str) -> Option<Packet> {
    let (id, rest) = text.split_once('#')?;
    let word = u32::from_str_radix(id, 16).ok()?;
    if id.len() == 8 && word & ERROR != 0 {
        return Some(Packet::Error(ErrorFrame {
            class: word & !ERROR,
            data: contents::<8>(rest)?.bytes().try_into().ok()?,
        }));
    }
    let id = match id.len() {
        3 => Id::Standard(CobId::new(u16::try_from(word).ok()?)?),
        8 if word < ERROR => Id::Extended(word),
        _ => return None,
    };
    if let Some(fd) = rest.strip_prefix('#') {
        let (flags, data) = fd.split_at_checked(1)?;
        let flags = u8::from_str_radix(flags, 16).ok()?;
        return Some(Packet::Fd(FdFrame {
            id,
            data: contents(data)?,
            rate_switched: flags & 1 != 0,
            sender_passive: flags & 2 != 0,
        }));
    }
    if let Some(len) = rest.strip_prefix('R') {
        let len = match len {
            "" => 0,
            len => len.parse().ok().filter(|len| *len <= 8)?,
        };
        return Some(Packet::Remote(id, len));
    }
    Some(match id {
        Id::Standard(id) => Packet::Frame(Frame::new(id, contents::<8>(rest)?.bytes())?),
        Id::Extended(id) => Packet::Extended(id, contents(rest)?),
    })
}

fn contents<const N: usize>(text: &str) -> Option<Data<N>> {
    let digits = text.as_bytes();
    let (pairs, rest) = digits.as_chunks::<2>();
    if !rest.is_empty() {
        return None;
    }
    let bytes = pairs
        .iter()
        .map(|[high, low]| {
            let value = |digit: u8| char::from(digit).to_digit(16);
            u8::try_from(value(*high)? << 4 | value(*low)?).ok()
        })
        .collect::<Option<Vec<u8>>>()?;
    Data::new(&bytes)
}
