//! The bus: clients with an adapter each, and the frames between them and the machine.
//!
//! A frame goes to the machine and to all clients but its sender, each client's frames in the order of the bus. Commands of
//! an adapter (`S8`, `O`, `V`, …) concern its client alone. A client that does not read has its frames kept up to
//! [`WAITING`]; then it is dropped, and nobody waits for it. Must not know the meaning of a frame.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read as _, Write as _};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;

use leadscrew_can::{FD_LINE, fd_frame, fd_line, fd_rate};
use leadscrew_core::bus::{FdFrame, Frame};
use leadscrew_slcan::{Adapter, Heard, Lines, Reply, SlcanFrame};

/// The most lines that wait for a client.
pub const WAITING: usize = 32_768;

/// Bytes that are read from a client, or written to it, at a time.
const CHUNK: usize = 4096;

/// What goes over the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traffic {
    /// Anything with a classical frame.
    Classical(SlcanFrame),
    /// A frame of CAN FD.
    Fd(FdFrame),
}

impl From<&Frame> for Traffic {
    fn from(frame: &Frame) -> Self {
        Self::Classical(SlcanFrame::Data(*frame))
    }
}

/// A client.
#[derive(Debug)]
struct Client {
    number: u64,
    stream: UnixStream,
    adapter: Adapter,
    lines: Lines<FD_LINE>,
    /// It takes part in FD frames.
    fd: bool,
    /// Bytes that wait for it, and the lengths of their lines.
    bytes: VecDeque<u8>,
    lengths: VecDeque<u8>,
}

impl Client {
    fn new(number: u64, stream: UnixStream) -> Self {
        Self {
            number,
            stream,
            adapter: Adapter::new(0x10, 0x10, *b"DESK"),
            lines: Lines::with_room(),
            fd: false,
            bytes: VecDeque::new(),
            lengths: VecDeque::new(),
        }
    }

    fn put(&mut self, line: &[u8]) {
        // The longest line is shorter than 256 bytes.
        self.lengths.push_back(line.len() as u8);
        self.bytes.extend(line);
    }

    /// Takes what it has sent; false where it is gone behind that.
    fn hear(&mut self, to: &mut Vec<(u64, Traffic)>) -> bool {
        let mut bytes = [0; CHUNK];
        let count = match self.stream.read(&mut bytes) {
            Ok(0) => return false,
            Ok(count) => count,
            Err(error) => {
                return matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted);
            }
        };
        for byte in bytes.get(..count).unwrap_or_default() {
            let Some(heard) = self.lines.push(*byte) else {
                continue;
            };
            let (reply, sent) = match heard {
                Heard::Bell => continue,
                Heard::Line(line) => match answer_fd(line, &self.adapter, &mut self.fd) {
                    Some(answer) => answer,
                    None => answer(&mut self.adapter, heard),
                },
                Heard::TooLong => answer(&mut self.adapter, heard),
            };
            self.put(reply.line().bytes());
            to.extend(sent.map(|sent| (self.number, sent)));
        }
        true
    }

    fn tell(&mut self, traffic: &Traffic, ms: u64) {
        match traffic {
            Traffic::Classical(frame) => {
                if let Some(reply) = self.adapter.received(frame, ms) {
                    self.put(reply.line().bytes());
                }
            }
            Traffic::Fd(frame) => {
                if self.fd && self.adapter.is_open() {
                    self.put(&fd_line(frame));
                }
            }
        }
    }

    /// Writes as much as it takes; false where it is gone.
    fn flush(&mut self) -> bool {
        while !self.bytes.is_empty() {
            let (first, _) = self.bytes.as_slices();
            match self.stream.write(first) {
                Ok(0) => return false,
                Ok(count) => self.written(count),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return true,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        }
        true
    }

    fn written(&mut self, count: usize) {
        self.bytes.drain(..count);
        let mut left = count;
        while let Some(length) = self.lengths.front_mut() {
            let whole = usize::from(*length);
            if whole > left {
                // A line of less than 256 bytes.
                *length = (whole - left) as u8;
                return;
            }
            left -= whole;
            self.lengths.pop_front();
        }
    }
}

/// The answer to a line of the classical protocol.
fn answer(adapter: &mut Adapter, heard: Heard<'_>) -> (Reply, Option<Traffic>) {
    let handled = adapter.handle(heard);
    (handled.reply, handled.send.map(Traffic::Classical))
}

/// The answer to a line of the extension for FD frames; `None` where it is none.
fn answer_fd(line: &[u8], adapter: &Adapter, fd: &mut bool) -> Option<(Reply, Option<Traffic>)> {
    match line {
        [b'Y', rate] => {
            let kbit = u32::from(rate.wrapping_sub(b'0')) * 1000;
            let possible = !adapter.is_open() && fd_rate(kbit).is_some();
            *fd |= possible;
            let reply = if possible {
                Reply::Done
            } else {
                Reply::Refused
            };
            Some((reply, None))
        }
        [b'd' | b'b', ..] => {
            let frame = fd_frame(line).and_then(|frame| frame.frame());
            let sent = frame.filter(|_| *fd && adapter.is_open());
            let reply = sent.map_or(Reply::Refused, |_| Reply::Sent);
            Some((reply, sent.map(Traffic::Fd)))
        }
        _ => None,
    }
}

/// All clients.
#[derive(Debug, Default)]
pub struct Bus {
    clients: Vec<Client>,
    came: u64,
    dropped: u32,
}

impl Bus {
    /// A new client.
    ///
    /// # Errors
    /// The system refuses a socket that does not wait.
    pub fn join(&mut self, stream: UnixStream) -> std::io::Result<()> {
        stream.set_nonblocking(true)?;
        self.came += 1;
        self.clients.push(Client::new(self.came, stream));
        Ok(())
    }

    /// The number of clients, and of those that were dropped.
    #[must_use]
    pub fn counts(&self) -> (u32, u32) {
        (
            u32::try_from(self.clients.len()).unwrap_or(u32::MAX),
            self.dropped,
        )
    }

    /// Takes what clients have sent, at most a little of each. The number says who has sent it.
    pub fn hear(&mut self) -> Vec<(u64, Traffic)> {
        let mut sent = Vec::new();
        self.clients.retain_mut(|client| client.hear(&mut sent));
        sent
    }

    /// Tells all clients but the sender; `ms` is the time for their stamps.
    pub fn tell(&mut self, traffic: &Traffic, sender: Option<u64>, ms: u64) {
        for client in &mut self.clients {
            if Some(client.number) != sender {
                client.tell(traffic, ms);
            }
        }
    }

    /// Writes what waits. Gives the numbers of clients that were dropped because too much waits for them.
    pub fn flush(&mut self) -> Vec<u64> {
        let mut dropped = Vec::new();
        self.clients.retain_mut(|client| {
            if !client.flush() {
                return false;
            }
            let stays = client.lengths.len() <= WAITING;
            if !stays {
                dropped.push(client.number);
            }
            stays
        });
        self.dropped += u32::try_from(dropped.len()).unwrap_or(u32::MAX);
        dropped
    }

    /// The sockets, and whether something waits to be written to them.
    pub fn sockets(&self) -> impl Iterator<Item = (BorrowedFd<'_>, bool)> {
        self.clients
            .iter()
            .map(|client| (client.stream.as_fd(), !client.bytes.is_empty()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_core::bus::CobId;

    fn frame(number: u16) -> Frame {
        Frame::new(CobId::new(0x123).unwrap(), &number.to_be_bytes()).unwrap()
    }

    fn joined(bus: &mut Bus) -> UnixStream {
        let (ours, theirs) = UnixStream::pair().unwrap();
        bus.join(ours).unwrap();
        theirs.set_nonblocking(true).unwrap();
        theirs
    }

    fn open(bus: &mut Bus) -> UnixStream {
        let mut client = joined(bus);
        client.write_all(b"S8\rO\r").unwrap();
        assert_eq!(bus.hear(), []);
        bus.flush();
        assert_eq!(read(&mut client), "\r\r");
        client
    }

    fn read(client: &mut UnixStream) -> String {
        let mut text = Vec::new();
        let _ = client.read_to_end(&mut text);
        String::from_utf8(text).unwrap()
    }

    /// Passes on what was heard.
    fn pass(bus: &mut Bus) -> Vec<Traffic> {
        let sent = bus.hear();
        for (from, traffic) in &sent {
            bus.tell(traffic, Some(*from), 0);
        }
        bus.flush();
        sent.into_iter().map(|(_, traffic)| traffic).collect()
    }

    #[test]
    fn a_frame_reaches_all_but_its_sender_in_one_order() {
        let mut bus = Bus::default();
        let (mut a, mut b, mut c) = (open(&mut bus), open(&mut bus), open(&mut bus));
        a.write_all(b"t12320001\r").unwrap();
        b.write_all(b"t12320002\r").unwrap();
        let sent = pass(&mut bus);
        assert_eq!(sent, [Traffic::from(&frame(1)), Traffic::from(&frame(2))]);
        bus.tell(&Traffic::from(&frame(3)), None, 0);
        bus.flush();
        assert_eq!(read(&mut a), "z\rt12320002\rt12320003\r");
        assert_eq!(read(&mut b), "z\rt12320001\rt12320003\r");
        assert_eq!(read(&mut c), "t12320001\rt12320002\rt12320003\r");
        drop(b);
        assert_eq!(pass(&mut bus), []);
        assert_eq!(bus.counts(), (2, 0));
    }

    #[test]
    fn an_adapter_is_its_client_s_own() {
        let mut bus = Bus::default();
        let (mut a, mut b) = (open(&mut bus), joined(&mut bus));
        a.write_all(b"C\rV\rt1230\r").unwrap();
        b.write_all(b"t1230\rO\rS8\rL\r").unwrap();
        assert_eq!(pass(&mut bus), []);
        assert_eq!(read(&mut a), "\rV1010\r\u{7}");
        assert_eq!(read(&mut b), "\u{7}\u{7}\r\r");
        // A listens no more, and B now does.
        bus.tell(&Traffic::from(&frame(1)), None, 0);
        bus.flush();
        assert_eq!(read(&mut a), "");
        assert_eq!(read(&mut b), "t12320001\r");
    }

    #[test]
    fn fd_frames_go_to_those_who_know_them() {
        let mut bus = Bus::default();
        let (mut plain, mut b, mut c) = (open(&mut bus), joined(&mut bus), joined(&mut bus));
        for client in [&mut b, &mut c] {
            client.write_all(b"Y5\rS8\rO\rY5\r").unwrap();
        }
        assert_eq!(pass(&mut bus), []);
        assert_eq!(
            (read(&mut b), read(&mut c)),
            ("\r\r\r\u{7}".into(), "\r\r\r\u{7}".into())
        );
        b.write_all(b"b48129A\r").unwrap();
        plain.write_all(b"b4811AA\r").unwrap();
        let sent = pass(&mut bus);
        assert_eq!(sent, []);
        b.write_all(b"b4812AABB\r").unwrap();
        let fd = FdFrame::new(CobId::new(0x481).unwrap(), &[0xAA, 0xBB], true).unwrap();
        assert_eq!(pass(&mut bus), [Traffic::Fd(fd)]);
        assert_eq!(read(&mut plain), "\u{7}");
        assert_eq!(read(&mut b), "\u{7}z\r");
        assert_eq!(read(&mut c), "b4812AABB\r");
    }

    #[test]
    fn who_does_not_read_is_dropped_and_the_others_miss_nothing() {
        let mut bus = Bus::default();
        let (mut deaf, mut good) = (open(&mut bus), open(&mut bus));
        let mut heard = String::new();
        let mut sent = 0_u16;
        let dropped = loop {
            bus.tell(&Traffic::from(&frame(sent)), None, 0);
            sent += 1;
            let dropped = bus.flush();
            heard += &read(&mut good);
            if !dropped.is_empty() {
                break dropped;
            }
        };
        assert_eq!(dropped, [1]);
        assert_eq!(bus.counts(), (1, 1));
        let lines: Vec<String> = (0..sent).map(|n| format!("t1232{n:04X}\r")).collect();
        assert_eq!(heard, lines.concat());
        // It gets what was written to its socket before, and the end: all but the lines that waited.
        let got = read(&mut deaf);
        let whole = got.matches('\r').count();
        assert_eq!(whole + WAITING, usize::from(sent) - 1);
        assert!(lines.concat().starts_with(&got));
    }
}
