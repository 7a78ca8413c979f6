//! The adapter's side of the protocol. The effect of a request depends on whether the adapter is open.

use super::acceptance::Acceptance;
use super::frame::SlcanFrame;
use super::line::Heard;
use super::reply::{Flags, Reply, Stamp};
use super::request::{BitRate, Request};

/// State of the channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Closed,
    Listening,
    Open,
}

/// The result of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handled {
    /// Reply to send to the host.
    pub reply: Reply,
    /// Frame to put on the bus.
    pub send: Option<SlcanFrame>,
}

/// An adapter, closed at first.
#[derive(Clone, Copy, Debug)]
pub struct Adapter {
    channel: Channel,
    rate: Option<BitRate>,
    timing: Option<(u8, u8)>,
    stamps: bool,
    acceptance: Acceptance,
    flags: Flags,
    version: (u8, u8),
    serial: [u8; 4],
}

impl Adapter {
    /// An adapter with these versions of hardware and software and this serial number (letters and digits).
    #[must_use]
    pub const fn new(hardware: u8, software: u8, serial: [u8; 4]) -> Self {
        Self {
            channel: Channel::Closed,
            rate: None,
            timing: None,
            stamps: false,
            acceptance: Acceptance::ALL,
            flags: Flags(0),
            version: (hardware, software),
            serial,
        }
    }

    /// True while the adapter takes part in the bus or listens.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        !matches!(self.channel, Channel::Closed)
    }

    /// The last requested bit rate; `None` before the first request, and after a request for timing registers.
    #[must_use]
    pub const fn bit_rate(&self) -> Option<BitRate> {
        self.rate
    }

    /// The last requested timing registers; `None` where the last request was for a bit rate.
    #[must_use]
    pub const fn timing(&self) -> Option<(u8, u8)> {
        self.timing
    }

    /// Records errors; the host gets them when it asks.
    pub const fn flag(&mut self, flags: Flags) {
        self.flags = self.flags.with(flags);
    }

    /// Handles a line from the host. Some hosts send an empty line to clear the line: the adapter answers it like any
    /// other and changes nothing.
    pub fn handle(&mut self, heard: Heard<'_>) -> Handled {
        if heard == Heard::Line(&[]) {
            return Handled {
                reply: Reply::Done,
                send: None,
            };
        }
        let answer = Request::of(heard).and_then(|request| self.answer(request));
        let (reply, send) = answer.unwrap_or((Reply::Refused, None));
        Handled { reply, send }
    }

    /// Answers a request; `None` refuses it.
    fn answer(&mut self, request: Request) -> Option<(Reply, Option<SlcanFrame>)> {
        let closed = self.channel == Channel::Closed;
        let reply = match request {
            Request::Version => Reply::Version(self.version.0, self.version.1),
            Request::Serial => Reply::Serial(self.serial),
            Request::Rate(rate) if closed => {
                (self.rate, self.timing) = (Some(rate), None);
                Reply::Done
            }
            Request::Timing(first, second) if closed => {
                (self.rate, self.timing) = (None, Some((first, second)));
                Reply::Done
            }
            Request::Stamps(on) if closed => {
                self.stamps = on;
                Reply::Done
            }
            Request::Code(code) if closed => {
                self.acceptance.code = code;
                Reply::Done
            }
            Request::Mask(mask) if closed => {
                self.acceptance.mask = mask;
                Reply::Done
            }
            Request::Open | Request::Listen
                if closed && (self.rate.is_some() || self.timing.is_some()) =>
            {
                self.channel = if request == Request::Open {
                    Channel::Open
                } else {
                    Channel::Listening
                };
                Reply::Done
            }
            Request::Close if !closed => {
                self.channel = Channel::Closed;
                Reply::Done
            }
            Request::Flags if !closed => {
                let flags = self.flags;
                self.flags = Flags(0);
                Reply::Flags(flags)
            }
            Request::Send(frame) if self.channel == Channel::Open => {
                let extended = matches!(
                    frame,
                    SlcanFrame::Extended(_) | SlcanFrame::RemoteExtended(..)
                );
                let reply = if extended {
                    Reply::SentExtended
                } else {
                    Reply::Sent
                };
                return Some((reply, Some(frame)));
            }
            _ => return None,
        };
        Some((reply, None))
    }

    /// The line for a frame from the bus; `ms` is the time of the adapter's clock. `None` while the adapter is closed,
    /// or where the acceptance filter does not pass the frame.
    #[must_use]
    pub fn received(&self, frame: &SlcanFrame, ms: u64) -> Option<Reply> {
        let wanted = self.is_open() && self.acceptance.passes(frame);
        wanted.then(|| Reply::Frame(*frame, self.stamps.then(|| Stamp::at(ms))))
    }
}
