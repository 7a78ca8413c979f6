//! The SDO client: one value for each transfer, which says what to send and is told what came.
//!
//! ```text
//! new ─► poll until None ─► wait for a frame or the deadline ─► receive ─► poll until None ─► … ─► outcome
//! ```
//!
//! Nothing is repeated by itself: a transfer that is not answered in time ends with [`SdoError::TimedOut`]. Once there is
//! an outcome, [`poll`](SdoDownload::poll) may have one more frame (the server is told), and then the value can go.
//! Time is what the owner says it is: since any start, growing.

mod download;
mod upload;

use core::time::Duration;

use super::wire::{Bytes, Request};
use crate::bus::frame::{CobId, Frame, NodeId, Service};
use crate::bus::object::{Abort, Object};

pub use download::SdoDownload;
pub use upload::{SdoBuffer, SdoSink, SdoUpload};

/// Which transfer a client asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SdoProtocol {
    /// Expedited for 1 to 4 bytes, segmented for other lengths.
    Short,
    /// Segmented whatever the length. Reading, the server chooses: this is [`SdoProtocol::Short`].
    Segmented,
    /// In blocks with a CRC. Reading, the server may choose the short one for up to 14 bytes.
    Block,
}

/// Why a transfer failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SdoError {
    /// The server broke it off with this abort code; [`Abort::from_code`] knows those of CiA 301.
    Refused(u32),
    /// This side broke it off, and told the server so.
    Broken(Abort),
    /// The server was silent for too long. Whether a write took effect is not known where the last answer was lost.
    TimedOut,
}

impl SdoError {
    /// The abort as CiA 301 has it; `None` for a code of the maker's own.
    #[must_use]
    pub const fn abort(self) -> Option<Abort> {
        match self {
            Self::Refused(code) => Abort::from_code(code),
            Self::Broken(abort) => Some(abort),
            Self::TimedOut => Some(Abort::TimedOut),
        }
    }
}

/// What both directions share: who, what, how long, what to send next, and how it ended.
#[derive(Clone, Copy, Debug)]
struct Line {
    node: NodeId,
    object: Object,
    patience: Duration,
    /// When something was last heard or sent.
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

    /// What is to be sent now, or the abort where the time is over.
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

    /// The server broke off. Some do not say what; an abort of another object is left over from another transfer.
    fn aborted(&mut self, object: Object, code: u32) {
        if object == self.object || object == Object::default() {
            self.outcome = Some(Err(SdoError::Refused(code)));
            self.out = None;
        }
    }
}
