//! The SDO server of a node: answers one client, one transfer at a time.
//!
//! ```text
//! receive(frame) ─► answer        every request has at most one answer, at once
//! poll()         ─► segment       while a client reads in blocks: as many as the sender has room for
//! elapse(time)   ─► abort         a client that says nothing any more
//! ```
//!
//! A new beginning in the middle of a transfer replaces it: the client has lost its memory, not the server. A mistake
//! ends the transfer with its abort code. Only within a block are frames not taken for what they say: a segment may look
//! like any command. So after a block is broken off, what still comes of it is swallowed: it could read like a
//! write to another object.

mod block_download;
mod block_upload;

use super::wire::{Begin, BlockSegment, Bytes, Piece, Request, Response, SEGMENT, Segment};
use crate::bus::frame::{CobId, Frame, NodeId, Service};
use crate::bus::object::{Abort, Object, Objects};
use crate::bus::periods::Periods;
use block_download::BlockDownload;
use block_upload::BlockUpload;

/// Segments in a block, 1–127.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BlockSize(u8);

impl BlockSize {
    /// The largest.
    pub const MAX: Self = Self(127);

    /// `segments` in a block; `None` outside 1–127.
    #[must_use]
    pub const fn new(segments: u8) -> Option<Self> {
        match segments {
            1..=127 => Some(Self(segments)),
            _ => None,
        }
    }

    /// The number of segments.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }
}

/// What is going on.
#[derive(Clone, Copy, Debug, Default)]
enum State {
    /// Nothing.
    #[default]
    Idle,
    /// The client reads segment by segment.
    Upload {
        size: u32,
        offset: u32,
        toggle: bool,
    },
    /// The client writes segment by segment.
    Download {
        size: Option<u32>,
        offset: u32,
        toggle: bool,
    },
    /// The client reads in blocks.
    BlockUpload(BlockUpload),
    /// The client writes in blocks.
    BlockDownload(BlockDownload),
    /// A block was broken off; its rest may still come.
    Swallow,
}

/// An SDO server.
#[derive(Clone, Copy, Debug)]
pub struct SdoServer {
    node: NodeId,
    patience: Periods,
    block: BlockSize,
    state: State,
    /// What the transfer is about; 0000h where there is none.
    object: Object,
    /// Since the last frame of the transfer.
    quiet: Periods,
}

impl SdoServer {
    /// A server for `node` that breaks a transfer off where its client is silent for longer than `patience`, and takes
    /// `block` segments at once.
    #[must_use]
    pub const fn new(node: NodeId, patience: Periods, block: BlockSize) -> Self {
        Self {
            node,
            patience,
            block,
            state: State::Idle,
            object: Object::new(0, 0),
            quiet: Periods::new(0),
        }
    }

    /// True while a transfer is going on.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle | State::Swallow)
    }

    /// Takes a frame from the bus and gives the answer to send. Frames that are not for this server, and frames of
    /// another length than eight, do nothing.
    pub fn receive<O: Objects + ?Sized>(
        &mut self,
        frame: &Frame,
        objects: &mut O,
    ) -> Option<Frame> {
        if frame.id() != CobId::of(Service::SdoRequest, self.node) {
            return None;
        }
        let bytes = frame.exactly()?;
        self.quiet = Periods::new(0);
        match self.answer(bytes, objects) {
            Ok(response) => Some(self.frame(response?)),
            Err(abort) => Some(self.refuse(abort, objects)),
        }
    }

    /// The next segment to send to a client that reads in blocks; `None` where there is nothing to send now. Call it as
    /// often as there is room for frames.
    pub fn poll<O: Objects + ?Sized>(&mut self, objects: &mut O) -> Option<Frame> {
        let State::BlockUpload(transfer) = &mut self.state else {
            return None;
        };
        match transfer.next(self.object, objects) {
            Ok(segment) => {
                let segment = segment?;
                self.quiet = Periods::new(0);
                Some(self.frame_of(segment.encode()))
            }
            Err(abort) => Some(self.refuse(abort, objects)),
        }
    }

    /// Tells that time has passed; gives the abort to send where the client has been silent for too long.
    pub fn elapse<O: Objects + ?Sized>(&mut self, by: Periods, objects: &mut O) -> Option<Frame> {
        if matches!(self.state, State::Idle) {
            return None;
        }
        self.quiet = self.quiet.plus(by);
        if self.quiet <= self.patience {
            return None;
        }
        self.quiet = Periods::new(0);
        if matches!(self.state, State::Swallow) {
            self.state = State::Idle;
            return None;
        }
        Some(self.refuse(Abort::TimedOut, objects))
    }

    /// Forgets the transfer without a word: the communication was reset or stopped.
    pub fn reset<O: Objects + ?Sized>(&mut self, objects: &mut O) {
        self.close(objects);
    }

    fn answer<O: Objects + ?Sized>(
        &mut self,
        bytes: Bytes,
        objects: &mut O,
    ) -> Result<Option<Response>, Abort> {
        if matches!(self.state, State::Swallow) && self.swallows(bytes) {
            return Ok(None);
        }
        match &mut self.state {
            State::BlockDownload(transfer) if transfer.in_block() => {
                let segment = BlockSegment::decode(bytes);
                // An abort is the one command that is no segment: those count from 1.
                if !(segment.number == 0 && segment.last) {
                    return transfer.take(segment, self.object, objects);
                }
            }
            State::BlockDownload(transfer) if transfer.repeats(bytes) => return Ok(None),
            _ => {}
        }
        let request = Request::decode(bytes).ok_or(Abort::Specifier)?;
        match request {
            Request::Abort(..) => {
                self.close(objects);
                Ok(None)
            }
            Request::Download(object, begin) => {
                self.open(object, objects);
                self.download(begin, objects).map(Some)
            }
            Request::Upload(object) => {
                self.open(object, objects);
                let size = objects.size(object)?;
                self.upload(size, objects).map(Some)
            }
            Request::BlockDownload { object, crc, size } => {
                self.open(object, objects);
                objects.begin_write(object, size)?;
                self.state = State::BlockDownload(BlockDownload::new(crc, size, self.block));
                Ok(Some(Response::BlockDownload {
                    object,
                    crc: true,
                    block: self.block.get(),
                }))
            }
            Request::BlockUpload {
                object,
                block,
                threshold,
                ..
            } => {
                self.open(object, objects);
                let block = BlockSize::new(block).ok_or(Abort::BlockSize)?;
                let size = objects.size(object)?;
                if threshold > 0 && size <= u32::from(threshold) {
                    return self.upload(size, objects).map(Some);
                }
                self.state = State::BlockUpload(BlockUpload::new(size, block));
                Ok(Some(Response::BlockUpload {
                    object,
                    crc: true,
                    size: Some(size),
                }))
            }
            Request::DownloadSegment(segment) => self.download_segment(segment, objects).map(Some),
            Request::UploadSegment(toggle) => self.upload_segment(toggle, objects).map(Some),
            Request::BlockDownloadEnd { unused, crc } => {
                let State::BlockDownload(transfer) = &mut self.state else {
                    return Err(Abort::Specifier);
                };
                let length = transfer.end(unused, crc, self.object, objects)?;
                self.commit(length, objects)?;
                Ok(Some(Response::BlockDownloadEnd))
            }
            Request::BlockUploadStart => match &mut self.state {
                State::BlockUpload(transfer) => transfer.start().map(|()| None),
                _ => Err(Abort::Specifier),
            },
            Request::BlockUploadAnswer { number, block } => match &mut self.state {
                State::BlockUpload(transfer) => transfer.answered(number, block),
                _ => Err(Abort::Specifier),
            },
            Request::BlockUploadEnd => match &self.state {
                State::BlockUpload(transfer) if transfer.has_ended() => {
                    self.close(objects);
                    Ok(None)
                }
                _ => Err(Abort::Specifier),
            },
        }
    }

    /// Begins anew, whatever was going on.
    fn open<O: Objects + ?Sized>(&mut self, object: Object, objects: &mut O) {
        self.close(objects);
        self.object = object;
    }

    /// Ends what is going on; a write that was begun is abandoned.
    fn close<O: Objects + ?Sized>(&mut self, objects: &mut O) {
        if matches!(self.state, State::Download { .. } | State::BlockDownload(_)) {
            objects.abandon(self.object);
        }
        self.state = State::Idle;
        self.object = Object::new(0, 0);
    }

    fn refuse<O: Objects + ?Sized>(&mut self, abort: Abort, objects: &mut O) -> Frame {
        let frame = self.frame(Response::Abort(self.object, abort.code()));
        let more = matches!(&self.state, State::BlockDownload(transfer) if transfer.in_block());
        self.close(objects);
        if more {
            self.state = State::Swallow;
        }
        frame
    }

    /// True for what may be the rest of a block that was broken off. A request to read is let through: it does no harm,
    /// and a client that begins anew has its answer.
    fn swallows(&mut self, bytes: Bytes) -> bool {
        match Request::decode(bytes) {
            Some(Request::Abort(..)) => return false,
            Some(Request::Upload(_)) if is_bare(bytes) => return false,
            _ => {}
        }
        if BlockSegment::decode(bytes).last {
            self.state = State::Idle;
        }
        true
    }

    fn download<O: Objects + ?Sized>(
        &mut self,
        begin: Begin,
        objects: &mut O,
    ) -> Result<Response, Abort> {
        let object = self.object;
        let piece = match begin {
            Begin::Segments(size) => {
                objects.begin_write(object, size)?;
                self.state = State::Download {
                    size,
                    offset: 0,
                    toggle: false,
                };
                return Ok(Response::Download(object));
            }
            Begin::Expedited(piece) => piece,
            Begin::ExpeditedUnsized([a, b, c, d]) => {
                // As many as the object has now; where that cannot be told, all.
                let len = match objects.size(object) {
                    Ok(size @ 1..=4) => size as u8,
                    _ => 4,
                };
                Piece::new([a, b, c, d, 0, 0, 0], len)
            }
        };
        let length = u32::from(piece.len());
        objects.begin_write(object, Some(length))?;
        // From here on a refusal abandons.
        self.state = State::Download {
            size: Some(length),
            offset: 0,
            toggle: false,
        };
        objects.write(object, 0, piece.as_slice())?;
        self.commit(length, objects)?;
        Ok(Response::Download(object))
    }

    fn download_segment<O: Objects + ?Sized>(
        &mut self,
        segment: Segment,
        objects: &mut O,
    ) -> Result<Response, Abort> {
        let State::Download {
            size,
            offset,
            toggle,
        } = &mut self.state
        else {
            return Err(Abort::Specifier);
        };
        if segment.toggle != *toggle {
            return Err(Abort::Toggle);
        }
        *toggle = !*toggle;
        let begin = *offset;
        *offset = begin
            .checked_add(u32::from(segment.piece.len()))
            .filter(|end| size.is_none_or(|size| *end <= size))
            .ok_or(Abort::TooLong)?;
        let end = *offset;
        if segment.last && size.is_some_and(|size| end < size) {
            return Err(Abort::TooShort);
        }
        if segment.piece.len() > 0 {
            objects.write(self.object, begin, segment.piece.as_slice())?;
        }
        if segment.last {
            self.commit(end, objects)?;
        }
        Ok(Response::DownloadSegment(segment.toggle))
    }

    /// The one place where a write takes effect.
    fn commit<O: Objects + ?Sized>(&mut self, length: u32, objects: &mut O) -> Result<(), Abort> {
        // The write ends here either way: nothing is left to abandon.
        self.state = State::Idle;
        objects.end_write(self.object, length)?;
        self.object = Object::new(0, 0);
        Ok(())
    }

    fn upload<O: Objects + ?Sized>(
        &mut self,
        size: u32,
        objects: &mut O,
    ) -> Result<Response, Abort> {
        let object = self.object;
        if let 1..=4 = size {
            let piece = read(object, 0, size, objects)?;
            self.object = Object::new(0, 0);
            return Ok(Response::Upload(object, Begin::Expedited(piece)));
        }
        self.state = State::Upload {
            size,
            offset: 0,
            toggle: false,
        };
        Ok(Response::Upload(object, Begin::Segments(Some(size))))
    }

    fn upload_segment<O: Objects + ?Sized>(
        &mut self,
        wanted: bool,
        objects: &mut O,
    ) -> Result<Response, Abort> {
        let State::Upload {
            size,
            offset,
            toggle,
        } = &mut self.state
        else {
            return Err(Abort::Specifier);
        };
        if wanted != *toggle {
            return Err(Abort::Toggle);
        }
        *toggle = !*toggle;
        let piece = read(self.object, *offset, *size, objects)?;
        *offset = offset.saturating_add(u32::from(piece.len()));
        let last = *offset >= *size;
        if last {
            self.close(objects);
        }
        Ok(Response::UploadSegment(Segment {
            toggle: wanted,
            last,
            piece,
        }))
    }

    fn frame(&self, response: Response) -> Frame {
        self.frame_of(response.encode())
    }

    const fn frame_of(&self, bytes: Bytes) -> Frame {
        Frame::of(CobId::of(Service::SdoReply, self.node), bytes)
    }
}

/// True for a request to read with nothing in the bytes that mean nothing there.
const fn is_bare([head, _, _, _, rest @ ..]: Bytes) -> bool {
    matches!((head, rest), (0x40, [0, 0, 0, 0]))
}

/// The bytes of a segment at `offset` in a value of `size` bytes. A value that is shorter than it said is an error of the
/// device.
fn read<O: Objects + ?Sized>(
    object: Object,
    offset: u32,
    size: u32,
    objects: &mut O,
) -> Result<Piece, Abort> {
    let len = size.saturating_sub(offset).min(u32::from(SEGMENT)) as u8;
    let mut bytes = [0; 7];
    if let Some(into) = bytes
        .get_mut(..usize::from(len))
        .filter(|into| !into.is_empty())
        && objects.read(object, offset, into)? != into.len()
    {
        return Err(Abort::General);
    }
    Ok(Piece::new(bytes, len))
}
