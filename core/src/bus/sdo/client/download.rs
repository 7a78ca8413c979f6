//! A client writes.

use core::time::Duration;

use super::{Line, SdoError, SdoProtocol};
use crate::bus::sdo::server::BlockSize;
use crate::bus::sdo::wire::{
    Begin, BlockSegment, Checksum, Piece, Request, Response, SEGMENT, Segment,
};
use crate::bus::{Abort, Object};
use crate::bus::{Frame, NodeId};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The request is sent.
    Asked,
    /// A segment with this toggle bit is sent; `end` is the offset of its end.
    Segment { toggle: bool, end: u32 },
    /// Segments of a block are being sent; `sent` is their number so far.
    Block { sent: u8, block: u8, crc: bool },
    /// The whole value is sent.
    Ended,
}

/// Writes an object of a node.
#[derive(Clone, Copy, Debug)]
pub struct SdoDownload<'a> {
    line: Line,
    data: &'a [u8],
    protocol: SdoProtocol,
    phase: Phase,
    /// Bytes that the server has acknowledged.
    taken: u32,
}

impl<'a> SdoDownload<'a> {
    /// Writes `data` to `object` of `node`; each answer may take `patience`. Data of more than 4 GiB fail at once.
    #[must_use]
    pub fn new(
        node: NodeId,
        object: Object,
        data: &'a [u8],
        protocol: SdoProtocol,
        patience: Duration,
        now: Duration,
    ) -> Self {
        let size = u32::try_from(data.len());
        let known = size.unwrap_or(u32::MAX);
        let first = match (protocol, known) {
            (SdoProtocol::Block, _) => Request::BlockDownload {
                object,
                crc: true,
                size: Some(known),
            },
            (SdoProtocol::Short, 1..=4) => {
                Request::Download(object, Begin::Expedited(piece(data, 0)))
            }
            _ => Request::Download(object, Begin::Segments(Some(known))),
        };
        let mut line = Line::new(node, object, patience, now, first);
        if size.is_err() {
            line.out = None;
            line.outcome = Some(Err(SdoError::Broken(Abort::TooLong)));
        }
        Self {
            line,
            data,
            protocol,
            phase: Phase::Asked,
            taken: 0,
        }
    }

    /// The outcome; `None` during the transfer.
    #[must_use]
    pub const fn outcome(&self) -> Option<Result<(), SdoError>> {
        self.line.outcome
    }

    /// The time limit of the next answer: call [`SdoDownload::poll`] after it.
    #[must_use]
    pub fn deadline(&self) -> Duration {
        self.line.deadline()
    }

    /// Bytes the server has taken so far.
    #[must_use]
    pub const fn progress(&self) -> u32 {
        self.taken
    }

    /// The next frame to send; `None` while the client waits for the server.
    pub fn poll(&mut self, now: Duration) -> Option<Frame> {
        if let Some(frame) = self.line.next(now) {
            return Some(frame);
        }
        let Phase::Block { sent, block, .. } = &mut self.phase else {
            return None;
        };
        let offset = self.taken.saturating_add(bytes_in(*sent));
        // After the last segment the block is over, full or not. An empty value has one segment, too.
        let over = *sent > 0 && offset >= length(self.data);
        if self.line.outcome.is_some() || *sent >= *block || over {
            return None;
        }
        *sent = sent.saturating_add(1);
        let segment = BlockSegment {
            number: *sent,
            last: offset.saturating_add(u32::from(SEGMENT)) >= length(self.data),
            bytes: piece(self.data, offset).bytes(),
        };
        self.line.last = self.line.last.max(now);
        Some(self.line.frame(segment.encode()))
    }

    /// Takes a frame from the bus; ignores frames of other nodes and services.
    pub fn receive(&mut self, frame: &Frame, now: Duration) {
        let Some(bytes) = self.line.heard(frame, now) else {
            return;
        };
        let response = Response::decode(bytes);
        if let Some(Response::Abort(object, code)) = response {
            let phase = self.phase;
            self.line.aborted(object, code);
            if let (Phase::Block { .. }, Some(Err(SdoError::Refused(code)))) =
                (phase, self.line.outcome)
            {
                // The server may not know where the block ends. This abort tells the server that no segment follows.
                self.line.send(Request::Abort(self.line.object, code));
            }
            return;
        }
        if let Err(abort) = self.answered(response) {
            self.line.fail(abort);
        }
    }

    fn answered(&mut self, response: Option<Response>) -> Result<(), Abort> {
        match (self.phase, response) {
            (Phase::Asked, response) => self.begun(response),
            (Phase::Segment { toggle, end }, Some(Response::DownloadSegment(answered))) => {
                if answered != toggle {
                    return Err(Abort::Toggle);
                }
                self.taken = end;
                // A segment that reaches the end of the value is the last one.
                if end >= length(self.data) {
                    self.line.done();
                } else {
                    self.send_segment(!toggle);
                }
                Ok(())
            }
            (
                Phase::Block { sent, crc, .. },
                Some(Response::BlockDownloadAnswer { number, block }),
            ) => self.block_answered(number, block, sent, crc),
            (Phase::Ended, Some(Response::BlockDownloadEnd)) => {
                self.line.done();
                Ok(())
            }
            _ => Err(Abort::Specifier),
        }
    }

    /// Takes the answer to the first request. An answer about another object belongs to an earlier transfer.
    fn begun(&mut self, response: Option<Response>) -> Result<(), Abort> {
        match response {
            Some(Response::Download(object)) if object == self.line.object => {
                match (self.protocol, length(self.data)) {
                    (SdoProtocol::Block, _) => return Err(Abort::Specifier),
                    (SdoProtocol::Short, length @ 1..=4) => {
                        self.taken = length;
                        self.line.done();
                    }
                    _ => self.send_segment(false),
                }
                Ok(())
            }
            Some(Response::BlockDownload { object, crc, block }) if object == self.line.object => {
                if self.protocol != SdoProtocol::Block {
                    return Err(Abort::Specifier);
                }
                let block = BlockSize::new(block).ok_or(Abort::BlockSize)?.get();
                self.phase = Phase::Block {
                    sent: 0,
                    block,
                    crc,
                };
                Ok(())
            }
            Some(Response::Upload(object, _) | Response::BlockUpload { object, .. })
                if object == self.line.object =>
            {
                Err(Abort::Specifier)
            }
            _ => Ok(()),
        }
    }

    fn send_segment(&mut self, toggle: bool) {
        let piece = piece(self.data, self.taken);
        let end = self.taken.saturating_add(u32::from(piece.len()));
        self.phase = Phase::Segment { toggle, end };
        self.line.send(Request::DownloadSegment(Segment {
            toggle,
            last: end >= length(self.data),
            piece,
        }));
    }

    fn block_answered(&mut self, number: u8, block: u8, sent: u8, crc: bool) -> Result<(), Abort> {
        let block_size = BlockSize::new(block).ok_or(Abort::BlockSize)?;
        if number > sent {
            let Phase::Block { block, .. } = self.phase else {
                return Err(Abort::Specifier);
            };
            let end = self.taken.saturating_add(bytes_in(sent));
            let out = sent >= block || (sent > 0 && end >= length(self.data));
            // In the middle of a block: a repeated answer to the block before.
            return if out { Err(Abort::Sequence) } else { Ok(()) };
        }
        let end = self.taken.saturating_add(bytes_in(number));
        self.taken = end.min(length(self.data));
        if number == 0 || end < length(self.data) {
            self.phase = Phase::Block {
                sent: 0,
                block: block_size.get(),
                crc,
            };
            return Ok(());
        }
        self.phase = Phase::Ended;
        let checksum = if crc {
            Checksum::new().with(self.data)
        } else {
            Checksum::new()
        };
        self.line.send(Request::BlockDownloadEnd {
            unused: end.saturating_sub(length(self.data)).min(7) as u8,
            crc: checksum.get(),
        });
        Ok(())
    }
}

/// Number of bytes in `segments` full segments.
fn bytes_in(segments: u8) -> u32 {
    u32::from(segments).saturating_mul(u32::from(SEGMENT))
}

/// The length fits 32 bits: [`SdoDownload::new`] has refused longer values.
fn length(data: &[u8]) -> u32 {
    u32::try_from(data.len()).unwrap_or(u32::MAX)
}

/// Up to seven bytes from `offset` on.
fn piece(data: &[u8], offset: u32) -> Piece {
    let rest = usize::try_from(offset)
        .ok()
        .and_then(|offset| data.get(offset..))
        .unwrap_or_default();
    let mut bytes = [0; 7];
    let mut len = 0_u8;
    for (to, from) in bytes.iter_mut().zip(rest) {
        *to = *from;
        len = len.saturating_add(1);
    }
    Piece::new(bytes, len)
}
