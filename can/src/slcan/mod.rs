//! Lawicel (SLCAN) adapters, and boards that behave like one: on a serial line, over TCP or over a Unix socket.
//!
//! The protocol itself is in `leadscrew_slcan`; [`fd`] has an extension of some adapters for FD frames. Such adapters
//! report no error frames. The adapter acknowledges every frame with a line. No more than [`WINDOW`] frames wait for
//! their acknowledgement at a time, so that the adapter's buffer does not overflow.

mod fd;
mod line;
#[cfg(test)]
mod tests;

pub use fd::{LONGEST as FD_LINE, frame as fd_frame, line as fd_line, rate as fd_rate};

use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use leadscrew_core::bus::{self, Frame};
use leadscrew_slcan::{BitRate, Heard, Lines, Reply, Request, SlcanFrame};
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::time::TimeSpec;

use crate::{Address, Can, CanError, Data, Filter, Id, Packet, Received, Stamp};

/// Largest number of frames sent and not yet acknowledged.
const WINDOW: usize = 32;

/// Time for an adapter to answer a command, and to acknowledge frames. The other end of a socket may be a program, and
/// a computer may stall for seconds [D178].
const ANSWER: Duration = Duration::from_secs(5);

/// An acknowledgement that has not come by then, where none has come since and other lines have, is lost: an adapter sends
/// a frame and its acknowledgement within milliseconds, and a serial line drops bytes.
const LOST: Duration = Duration::from_millis(200);

/// Time for the version of an adapter that has already sent something.
const NO_VERSION: Duration = Duration::from_secs(2);

/// Time without a byte after which an adapter that was busy counts as quiet.
const QUIET: Duration = Duration::from_millis(100);

/// The connection to an adapter.
pub(crate) trait Stream: Read + Write + AsFd + Send {}

impl<T: Read + Write + AsFd + Send> Stream for T {}

/// An open adapter. Dropping this value closes the adapter.
pub struct Slcan {
    name: String,
    stream: Box<dyn Stream>,
    lines: Lines<{ fd::LONGEST }>,
    filters: Vec<Filter>,
    /// Frames sent and not yet acknowledged.
    under_way: usize,
    /// When the last frame was sent or acknowledged.
    active: Instant,
    /// When a frame was acknowledged last, or sent where none was under way.
    acknowledged: Instant,
    /// When bytes came last.
    heard: Instant,
    /// The adapter has refused a frame since the last report of a refusal.
    refused: bool,
    /// Packets received during another wait.
    early: Vec<Received>,
    /// Time for the adapter to acknowledge frames.
    patience: Duration,
}

impl Slcan {
    /// Opens the adapter at an address, at this bit rate.
    ///
    /// # Errors
    /// The address does not exist, or it does not answer like an adapter.
    pub fn open(address: &Address, bit_rate: BitRate) -> Result<Self, CanError> {
        let (name, stream) = line::open(address)?;
        let now = Instant::now();
        let mut adapter = Self {
            name,
            stream,
            lines: Lines::with_room(),
            filters: Vec::new(),
            under_way: 0,
            active: now,
            acknowledged: now,
            heard: now,
            refused: false,
            early: Vec::new(),
            patience: ANSWER,
        };
        adapter.begin(bit_rate)?;
        Ok(adapter)
    }

    /// Brings the adapter from any state to the open state.
    fn begin(&mut self, bit_rate: BitRate) -> Result<(), CanError> {
        // Empty lines end an unfinished line of another program. The adapter may be open already.
        self.write(b"\r\r\r")?;
        self.write(Request::Close.line().bytes())?;
        // The version arrives after all older bytes on the line. If an adapter gives no version, or one in another
        // format, this waits until the adapter is quiet.
        self.write(Request::Version.line().bytes())?;
        let deadline = Instant::now() + ANSWER;
        let mut patience = ANSWER;
        'stale: while Instant::now() < deadline && self.wait(patience)? {
            let mut bytes = [0; 512];
            let count = self.read(&mut bytes)?;
            for byte in bytes.get(..count).unwrap_or_default() {
                match self.lines.push(*byte) {
                    Some(heard) if matches!(Reply::of(heard), Some(Reply::Version(..))) => {
                        break 'stale;
                    }
                    Some(heard @ Heard::Line(_)) if Reply::of(heard).is_none() => patience = QUIET,
                    Some(_) => patience = patience.min(NO_VERSION),
                    None => {}
                }
            }
        }
        self.lines = Lines::with_room();
        self.command("S", &Request::Rate(bit_rate))?;
        self.command("O", &Request::Open)
    }

    fn command(&mut self, name: &'static str, request: &Request) -> Result<(), CanError> {
        self.ask(name, request.line().bytes())
    }

    /// Sends a line and waits for its answer.
    fn ask(&mut self, name: &'static str, line: &[u8]) -> Result<(), CanError> {
        self.write(line)?;
        let deadline = Instant::now() + ANSWER;
        let mut early = std::mem::take(&mut self.early);
        let (mut answered, mut over) = (None, false);
        while answered.is_none() {
            let left = deadline.saturating_duration_since(Instant::now());
            if over || !self.wait(left)? {
                return Err(CanError::AdapterSilent {
                    name: self.name.clone(),
                    command: name,
                });
            }
            // After the deadline, bytes that have already arrived still count.
            over = left.is_zero();
            self.take(&mut early, |reply| {
                if answered.is_none() && matches!(reply, Reply::Done | Reply::Refused) {
                    answered = Some(*reply);
                }
            })?;
        }
        self.early = early;
        match answered {
            Some(Reply::Done) => Ok(()),
            _ => Err(CanError::AdapterRefused {
                name: self.name.clone(),
                command: name,
            }),
        }
    }

    /// Reads once. Frames go to `into`, everything else to `other`.
    fn take(
        &mut self,
        into: &mut Vec<Received>,
        mut other: impl FnMut(&Reply),
    ) -> Result<(), CanError> {
        let mut bytes = [0; 4096];
        let count = self.read(&mut bytes)?;
        let time = Stamp::now();
        for byte in bytes.get(..count).unwrap_or_default() {
            let Some(heard) = self.lines.push(*byte) else {
                continue;
            };
            let packet = match (Reply::of(heard), heard) {
                (Some(Reply::Frame(frame, _)), _) => packet(&frame),
                (Some(reply), _) => {
                    other(&reply);
                    continue;
                }
                (None, Heard::Line(line)) => match fd::frame(line) {
                    Some(frame) => Packet::Fd(frame),
                    None => continue,
                },
                (None, _) => continue,
            };
            if Filter::any_passes(&self.filters, &packet) {
                into.push(Received { time, packet });
            }
        }
        Ok(())
    }

    /// Reads once, and counts acknowledgements.
    fn hear(&mut self, into: &mut Vec<Received>) -> Result<(), CanError> {
        let (mut done, mut refused) = (0, false);
        self.take(into, |reply| match reply {
            Reply::Sent | Reply::SentExtended | Reply::Done => done += 1,
            Reply::Refused => {
                done += 1;
                refused = true;
            }
            _ => {}
        })?;
        self.under_way = self.under_way.saturating_sub(done);
        if done > 0 {
            let now = Instant::now();
            (self.active, self.acknowledged) = (now, now);
        }
        self.refused |= refused;
        Ok(())
    }

    fn tell_refusal(&mut self) -> Result<(), CanError> {
        if std::mem::take(&mut self.refused) {
            return Err(CanError::AdapterRefused {
                name: self.name.clone(),
                command: "t",
            });
        }
        Ok(())
    }

    /// Sends lines with frames, no more at a time than the adapter takes.
    fn post(&mut self, lines: &[Vec<u8>]) -> Result<(), CanError> {
        self.tell_refusal()?;
        self.give_up_lost()?;
        let mut left = lines;
        while !left.is_empty() {
            let room = WINDOW.saturating_sub(self.under_way).min(left.len());
            let (first, later) = left.split_at(room);
            let text = first.concat();
            left = later;
            let now = Instant::now();
            self.active = now;
            if self.under_way == 0 {
                self.acknowledged = now;
            }
            self.under_way += room;
            self.write(&text)?;
            self.settle(WINDOW - 1)?;
        }
        Ok(())
    }

    /// Waits until no more than `most` sent frames lack their acknowledgement. Before a command `most` must be 0,
    /// because an acknowledgement looks like the answer to a command.
    ///
    /// Acknowledgements that are lost would take their places for ever: on a line on which other things are heard they are
    /// given up. Where none comes at all, nothing is.
    fn settle(&mut self, most: usize) -> Result<(), CanError> {
        let deadline = Instant::now() + self.patience;
        let mut early = std::mem::take(&mut self.early);
        let (mut result, mut over) = (Ok(()), false);
        while self.under_way > most && result.is_ok() {
            let left = deadline.saturating_duration_since(Instant::now());
            result = match self.wait(left) {
                // After the deadline, bytes that have already arrived still count.
                Ok(true) if !over => self.hear(&mut early).and_then(|()| {
                    match self.acknowledged.elapsed() < self.patience {
                        true => self.give_up_lost(),
                        false => Ok(()),
                    }
                }),
                Ok(false) if !left.is_zero() => Ok(()),
                Ok(_) => Err(CanError::AdapterStuck {
                    name: self.name.clone(),
                }),
                Err(error) => Err(error),
            };
            over = left.is_zero();
        }
        self.early = early;
        result
    }

    /// Frames whose acknowledgement is lost are not under way any more: long after the last one something else was heard,
    /// and nothing is left to be read.
    fn give_up_lost(&mut self) -> Result<(), CanError> {
        if self.under_way > 0 && self.heard >= self.active + LOST && !self.wait(Duration::ZERO)? {
            self.under_way = 0;
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), CanError> {
        self.stream
            .write_all(bytes)
            .and_then(|()| self.stream.flush())
            .map_err(|error| self.failed("send to", error))
    }

    /// Reads, and blocks until a byte arrives. Zero bytes mean that the line has ended, which is an error here.
    fn read(&mut self, into: &mut [u8]) -> Result<usize, CanError> {
        loop {
            match self.stream.read(into) {
                Ok(0) => {
                    return Err(CanError::Closed {
                        name: self.name.clone(),
                    });
                }
                Ok(count) => {
                    self.heard = Instant::now();
                    return Ok(count);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.failed("receive from", error)),
            }
        }
    }

    /// True where something can be read.
    fn wait(&self, patience: Duration) -> Result<bool, CanError> {
        let mut wanted = [PollFd::new(self.stream.as_fd(), PollFlags::POLLIN)];
        match ppoll(&mut wanted, Some(TimeSpec::from_duration(patience)), None) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::EINTR) => Ok(false),
            Err(error) => Err(self.failed("wait for", error.into())),
        }
    }

    fn failed(&self, doing: &'static str, error: std::io::Error) -> CanError {
        let name = self.name.clone();
        match error.kind() {
            ErrorKind::BrokenPipe | ErrorKind::ConnectionReset | ErrorKind::UnexpectedEof => {
                CanError::Closed { name }
            }
            // The error of a terminal after its device was unplugged.
            _ if error.raw_os_error() == Some(Errno::EIO as i32) => CanError::Closed { name },
            ErrorKind::WouldBlock | ErrorKind::TimedOut => CanError::AdapterStuck { name },
            _ => CanError::System { name, doing, error },
        }
    }
}

impl Drop for Slcan {
    fn drop(&mut self) {
        // If the adapter is gone, there is nothing to close.
        let _ = self.write(Request::Close.line().bytes());
    }
}

impl Can for Slcan {
    fn name(&self) -> &str {
        &self.name
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        let lines = frames.iter().map(|frame| {
            Request::Send(SlcanFrame::Data(*frame))
                .line()
                .bytes()
                .to_vec()
        });
        self.post(&lines.collect::<Vec<_>>())
    }

    fn use_fd(&mut self, data_kbit: u32) -> Result<(), CanError> {
        let refused = CanError::AdapterNoFd {
            name: self.name.clone(),
            kbit: data_kbit,
        };
        let Some(rate) = fd::rate(data_kbit) else {
            return Err(refused);
        };
        self.settle(0)?;
        self.command("C", &Request::Close)?;
        match self.ask("Y", rate.as_bytes()) {
            Ok(()) => {}
            Err(CanError::AdapterRefused { .. }) => return Err(refused),
            Err(error) => return Err(error),
        }
        self.command("O", &Request::Open)
    }

    fn send_fd(&mut self, frames: &[bus::FdFrame]) -> Result<(), CanError> {
        self.post(&frames.iter().map(fd::line).collect::<Vec<_>>())
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        self.tell_refusal()?;
        let before = into.len();
        into.append(&mut self.early);
        if into.len() > before {
            return Ok(into.len() - before);
        }
        // Acknowledgements arrive, too; they do not end the wait.
        let started = Instant::now();
        let mut left = patience;
        while self.wait(left)? {
            self.hear(into)?;
            left = patience.saturating_sub(started.elapsed());
            if into.len() > before || left.is_zero() {
                break;
            }
        }
        Ok(into.len() - before)
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        self.filters = filters.to_vec();
        Ok(())
    }

    fn dropped(&self) -> Result<u64, CanError> {
        // A line makes the adapter wait; no frame is lost on this side.
        Ok(0)
    }
}

fn packet(frame: &SlcanFrame) -> Packet {
    match frame {
        SlcanFrame::Data(frame) => Packet::Frame(*frame),
        SlcanFrame::Remote(id, len) => Packet::Remote(Id::Standard(*id), *len),
        SlcanFrame::RemoteExtended(id, len) => Packet::Remote(Id::Extended(id.get()), *len),
        SlcanFrame::Extended(frame) => {
            let data = Data::truncated(frame.payload());
            Packet::Extended(frame.id().get(), data)
        }
    }
}
