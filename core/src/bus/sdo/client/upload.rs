//! A client reads.

use core::time::Duration;

use super::{Line, SdoError, SdoProtocol};
use crate::bus::sdo::server::BlockSize;
use crate::bus::sdo::wire::{
    Begin, BlockSegment, Bytes, Checksum, Piece, Request, Response, Segment,
};
use crate::bus::{Abort, Object};
use crate::bus::{Frame, NodeId};

/// Up to this length a server may answer a block upload with an expedited or segmented one: blocks are not faster
/// there.
const THRESHOLD: u8 = 14;

/// Takes the bytes of a read, in order. The bytes are valid only after a successful transfer, because the checksum
/// comes last.
pub trait SdoSink {
    /// Begins a value of `size` bytes; `None`: the server did not give the length.
    fn begin(&mut self, size: Option<u32>) -> Result<(), Abort>;
    /// The next bytes.
    fn put(&mut self, bytes: &[u8]) -> Result<(), Abort>;
}

/// A sink of a fixed size.
#[derive(Debug, PartialEq, Eq)]
pub struct SdoBuffer<'a> {
    into: &'a mut [u8],
    len: usize,
}

impl<'a> SdoBuffer<'a> {
    /// Fills `into` from its beginning.
    #[must_use]
    pub const fn new(into: &'a mut [u8]) -> Self {
        Self { into, len: 0 }
    }

    /// The bytes read so far.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.into.get(..self.len).unwrap_or_default()
    }
}

impl SdoSink for SdoBuffer<'_> {
    fn begin(&mut self, size: Option<u32>) -> Result<(), Abort> {
        self.len = 0;
        match size.map(usize::try_from) {
            Some(Ok(size)) if size <= self.into.len() => Ok(()),
            None => Ok(()),
            _ => Err(Abort::OutOfMemory),
        }
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), Abort> {
        let end = self.len.saturating_add(bytes.len());
        let room = self
            .into
            .get_mut(self.len..end)
            .filter(|room| room.len() == bytes.len())
            .ok_or(Abort::OutOfMemory)?;
        for (to, from) in room.iter_mut().zip(bytes) {
            *to = *from;
        }
        self.len = end;
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The request is sent.
    Asked,
    /// The segment with this toggle bit is requested.
    Segment(bool),
    /// Segments of a block are being received.
    Block(Block),
    /// All segments have arrived; the CRC has not.
    Ended(Block),
}

/// The received segments of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Block {
    /// Number of the last segment in sequence; 0 before the first.
    number: u8,
    /// The last segment: only the end of the transfer gives the number of its used bytes.
    held: Option<BlockSegment>,
    /// The server makes a CRC.
    crc: bool,
}

/// Reads an object of a node into a sink.
#[derive(Debug)]
pub struct SdoUpload<'a, S: SdoSink + ?Sized> {
    line: Line,
    sink: &'a mut S,
    protocol: SdoProtocol,
    phase: Phase,
    size: Option<u32>,
    taken: u32,
    checksum: Checksum,
}

impl<'a, S: SdoSink + ?Sized> SdoUpload<'a, S> {
    /// Reads `object` of `node` into `sink`; each answer may take `patience`.
    pub fn new(
        node: NodeId,
        object: Object,
        sink: &'a mut S,
        protocol: SdoProtocol,
        patience: Duration,
        now: Duration,
    ) -> Self {
        let first = match protocol {
            SdoProtocol::Block => Request::BlockUpload {
                object,
                crc: true,
                block: BlockSize::MAX.get(),
                threshold: THRESHOLD,
            },
            SdoProtocol::Short | SdoProtocol::Segmented => Request::Upload(object),
        };
        Self {
            line: Line::new(node, object, patience, now, first),
            sink,
            protocol,
            phase: Phase::Asked,
            size: None,
            taken: 0,
            checksum: Checksum::new(),
        }
    }

    /// The outcome; `None` during the transfer.
    #[must_use]
    pub const fn outcome(&self) -> Option<Result<(), SdoError>> {
        self.line.outcome
    }

    /// The time limit of the next answer: call [`SdoUpload::poll`] after it.
    #[must_use]
    pub fn deadline(&self) -> Duration {
        self.line.deadline()
    }

    /// Bytes read so far.
    #[must_use]
    pub const fn progress(&self) -> u32 {
        self.taken
    }

    /// The length in bytes; `None` until the server has sent it.
    #[must_use]
    pub const fn size(&self) -> Option<u32> {
        self.size
    }

    /// The next frame to send; `None` while the client waits for the server.
    pub fn poll(&mut self, now: Duration) -> Option<Frame> {
        self.line.next(now)
    }

    /// Takes a frame from the bus; ignores frames of other nodes and services.
    pub fn receive(&mut self, frame: &Frame, now: Duration) {
        let Some(bytes) = self.line.heard(frame, now) else {
            return;
        };
        if let Err(abort) = self.answered(bytes) {
            self.line.fail(abort);
        }
    }

    fn answered(&mut self, bytes: Bytes) -> Result<(), Abort> {
        match self.phase {
            Phase::Block(block) => {
                let segment = BlockSegment::decode(bytes);
                // During a block only an abort is a command: its first byte would be segment number 0, and segments
                // count from 1.
                if !(segment.number == 0 && segment.last) {
                    return self.block_segment(segment, block);
                }
            }
            // A repetition of the last segment may look like the end of the transfer.
            Phase::Ended(Block {
                held: Some(held), ..
            }) if held.encode() == bytes => return Ok(()),
            _ => {}
        }
        match (self.phase, Response::decode(bytes)) {
            (_, Some(Response::Abort(object, code))) => {
                self.line.aborted(object, code);
                Ok(())
            }
            (Phase::Asked, response) => self.begun(response),
            (Phase::Segment(wanted), Some(Response::UploadSegment(segment))) => {
                self.segment(wanted, segment)
            }
            (Phase::Ended(block), Some(Response::BlockUploadEnd { unused, crc })) => {
                self.block_end(block, unused, crc)
            }
            _ => Err(Abort::Specifier),
        }
    }

    /// Takes the answer to the first request. An answer about another object belongs to an earlier transfer.
    fn begun(&mut self, response: Option<Response>) -> Result<(), Abort> {
        match response {
            Some(Response::Upload(object, begin)) if object == self.line.object => match begin {
                Begin::Expedited(piece) => {
                    self.begin(Some(u32::from(piece.len())))?;
                    self.take(piece)?;
                    self.finish()
                }
                Begin::ExpeditedUnsized([a, b, c, d]) => {
                    self.begin(None)?;
                    self.take(Piece::new([a, b, c, d, 0, 0, 0], 4))?;
                    self.finish()
                }
                Begin::Segments(size) => {
                    self.begin(size)?;
                    self.phase = Phase::Segment(false);
                    self.line.send(Request::UploadSegment(false));
                    Ok(())
                }
            },
            Some(Response::BlockUpload { object, crc, size }) if object == self.line.object => {
                if self.protocol != SdoProtocol::Block {
                    return Err(Abort::Specifier);
                }
                self.begin(size)?;
                self.phase = Phase::Block(Block {
                    number: 0,
                    held: None,
                    crc,
                });
                self.line.send(Request::BlockUploadStart);
                Ok(())
            }
            Some(Response::Download(object) | Response::BlockDownload { object, .. })
                if object == self.line.object =>
            {
                Err(Abort::Specifier)
            }
            _ => Ok(()),
        }
    }

    fn segment(&mut self, wanted: bool, segment: Segment) -> Result<(), Abort> {
        if segment.toggle != wanted {
            return Err(Abort::Toggle);
        }
        self.take(segment.piece)?;
        if segment.last {
            return self.finish();
        }
        self.phase = Phase::Segment(!wanted);
        self.line.send(Request::UploadSegment(!wanted));
        Ok(())
    }

    fn block_segment(&mut self, segment: BlockSegment, mut block: Block) -> Result<(), Abort> {
        if segment.number == 0 {
            return Err(Abort::Sequence);
        }
        let mut complete = false;
        if segment.number == block.number.saturating_add(1) {
            if let Some(before) = block.held {
                self.take(Piece::without(before.bytes, 0))?;
            }
            block.held = Some(segment);
            block.number = segment.number;
            complete = segment.last;
        }
        if segment.last || segment.number == BlockSize::MAX.get() {
            self.line.send(Request::BlockUploadAnswer {
                number: core::mem::take(&mut block.number),
                block: BlockSize::MAX.get(),
            });
        }
        self.phase = if complete {
            Phase::Ended(block)
        } else {
            Phase::Block(block)
        };
        Ok(())
    }

    fn block_end(&mut self, block: Block, unused: u8, crc: u16) -> Result<(), Abort> {
        let bytes = block.held.map_or([0; 7], |held| held.bytes);
        self.take(Piece::without(bytes, unused))?;
        if block.crc && self.checksum.get() != crc {
            return Err(Abort::Crc);
        }
        self.finish()?;
        self.line.send(Request::BlockUploadEnd);
        Ok(())
    }

    fn begin(&mut self, size: Option<u32>) -> Result<(), Abort> {
        self.size = size;
        self.sink.begin(size)
    }

    fn take(&mut self, piece: Piece) -> Result<(), Abort> {
        self.taken = self
            .taken
            .checked_add(u32::from(piece.len()))
            .filter(|taken| self.size.is_none_or(|size| *taken <= size))
            .ok_or(Abort::TooLong)?;
        if matches!(self.phase, Phase::Block(_) | Phase::Ended(_)) {
            self.checksum = self.checksum.with(piece.as_slice());
        }
        self.sink.put(piece.as_slice())
    }

    fn finish(&mut self) -> Result<(), Abort> {
        if self.size.is_some_and(|size| self.taken < size) {
            return Err(Abort::TooShort);
        }
        self.line.done();
        Ok(())
    }
}
