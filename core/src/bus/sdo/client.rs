//! The SDO client: one value for each transfer. The owner sends the value's frames and gives it the received frames.
//!
//! ```text
//! new ─► poll until None ─► wait for a frame or the deadline ─► receive ─► poll until None ─► … ─► outcome
//! ```
//!
//! The client repeats no request: a transfer without an answer in time ends with [`SdoError::TimedOut`]. After the
//! outcome, [`poll`](SdoDownload::poll) may give one more frame for the server; then the owner can drop the value. The
//! owner gives the time: it counts from any start and must not go back.

mod download;
mod upload;

use core::time::Duration;

use super::wire::{Bytes, Request};
use crate::bus::{Abort, Object};
use crate::bus::{CobId, Frame, NodeId, Service};

pub use download::SdoDownload;
pub use upload::{SdoBuffer, SdoSink, SdoUpload};

/// The kind of transfer that a client asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SdoProtocol {
    /// Expedited for 1 to 4 bytes, segmented for other lengths.
    Short,
    /// Segmented for any length. For a read the server chooses, so this is the same as [`SdoProtocol::Short`].
    Segmented,
    /// In blocks with a CRC. For a read of up to 14 bytes the server may choose [`SdoProtocol::Short`].
    Block,
}

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SdoError {
    /// The server broke the transfer off with this abort code; [`Abort::from_code`] knows the codes of CiA 301.
    Refused(u32),
    /// The client broke the transfer off with an abort to the server.
    Broken(Abort),
    /// The server was silent for too long. A write may have taken effect, if only its last answer was lost.
    TimedOut,
}

impl SdoError {
    /// The abort of CiA 301; `None` for a manufacturer-specific code.
    #[must_use]
    pub const fn abort(self) -> Option<Abort> {
        match self {
            Self::Refused(code) => Abort::from_code(code),
            Self::Broken(abort) => Some(abort),
            Self::TimedOut => Some(Abort::TimedOut),
        }
    }
}

/// The common part of both directions: node, object, patience, next frame and outcome.
#[derive(Clone, Copy, Debug)]
struct Line {
    node: NodeId,
    object: Object,
    patience: Duration,
    /// Time of the last frame, received or sent.
    last: Duration,
    out: Option<Bytes>,
    outcome: Option<Result<(), SdoError>>,
}

impl Line {
    fn new(
        node: NodeId,
        object: Object,
        patience: Duration,
        now: Duration,
        first: Request,
    ) -> Self {
        Self {
            node,
            object,
            patience,
            last: now,
            out: Some(first.encode()),
            outcome: None,
        }
    }

    /// The payload of a frame that belongs to the transfer.
    fn heard(&mut self, frame: &Frame, now: Duration) -> Option<Bytes> {
        if self.outcome.is_some() || frame.id() != CobId::of(Service::SdoReply, self.node) {
            return None;
        }
        let bytes = frame.exactly()?;
        self.last = now;
        Some(bytes)
    }

    fn send(&mut self, request: Request) {
        self.out = Some(request.encode());
    }

    /// The frame to send now, or the abort where the time is over.
    fn next(&mut self, now: Duration) -> Option<Frame> {
        if self.outcome.is_none() && now > self.deadline() {
            self.tell(Abort::TimedOut);
            self.outcome = Some(Err(SdoError::TimedOut));
        }
        let bytes = self.out.take()?;
        self.last = self.last.max(now);
        Some(self.frame(bytes))
    }

    const fn frame(&self, bytes: Bytes) -> Frame {
        Frame::of(CobId::of(Service::SdoRequest, self.node), bytes)
    }

    fn deadline(&self) -> Duration {
        self.last.saturating_add(self.patience)
    }

    fn tell(&mut self, abort: Abort) {
        self.send(Request::Abort(self.object, abort.code()));
    }

    fn done(&mut self) {
        self.outcome = Some(Ok(()));
    }

    fn fail(&mut self, abort: Abort) {
        self.tell(abort);
        self.outcome = Some(Err(SdoError::Broken(abort)));
    }

    /// The server has sent an abort. Some servers do not name the object. An abort for another object belongs to an
    /// earlier transfer.
    fn aborted(&mut self, object: Object, code: u32) {
        if object == self.object || object == Object::default() {
            self.outcome = Some(Err(SdoError::Refused(code)));
            self.out = None;
        }
    }
}
