//! The SDO server of a node: answers one client, one transfer at a time.
//!
//! ```text
//! receive(frame) ─► answer        every request has at most one answer, at once
//! poll()         ─► segment       while a client reads in blocks: as many as the sender has room for
//! elapse(time)   ─► abort         a client that says nothing any more
//! ```
//!
//! A new request during a transfer replaces the transfer, because the client has evidently forgotten the old one. A
//! mistake ends the transfer with its abort code. Within a block the server does not read frames as commands, because a
//! segment may look like any command. Therefore the server discards the rest of a block after an abort: a late segment
//! could look like a write to another object.
//!
//! The server writes each answer byte by byte into the frame to send. Requests and answers as values would take twice
//! as much code on a board [D161].

mod reading;
mod writing;

use super::wire::{Bytes, Checksum};
use crate::bus::Periods;
use crate::bus::{Abort, Object, Objects};
use crate::bus::{CobId, Frame, NodeId, Service};

/// Segments in a block, 1–127.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BlockSize(u8);

impl BlockSize {
    /// The largest block.
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

/// The state of the server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// No transfer.
    Idle,
    /// A block was broken off; the rest of its segments may still come.
    Swallow,
    /// The client reads segment by segment.
    Upload,
    /// The client writes segment by segment.
    Download,
    /// The client reads in blocks: it has got the length and has not started the first block.
    Offered,
    /// The client reads in blocks: segments of a block still have to be sent.
    Sending,
    /// The client reads in blocks: the whole block is sent.
    Sent,
    /// The client reads in blocks: it has the whole value and checks the CRC.
    Read,
    /// The client writes in blocks: the next frames are segments.
    Taking,
    /// The client writes in blocks: all segments have arrived.
    Taken,
}

impl State {
    const fn is_write(self) -> bool {
        matches!(self, Self::Download | Self::Taking | Self::Taken)
    }
}

/// The progress of a transfer; each kind of transfer uses the fields that it needs.
#[derive(Clone, Copy, Debug)]
struct Transfer {
    /// Length of the value in bytes; `None` for a write without an announced length.
    size: Option<u32>,
    /// Bytes transferred so far; for a read in blocks, the offset of the block.
    offset: u32,
    /// Toggle bit of the next segment.
    toggle: bool,
    /// Segments in a block.
    block: BlockSize,
    /// Number of the last segment transferred in the block; 0 before the first.
    number: u8,
    /// In blocks: checksum of all bytes transferred so far. The server computes it for every client, because some
    /// clients check it without asking for it.
    checksum: Checksum,
    /// The client sends a checksum.
    sums: bool,
    /// Bytes in the checksum: repeated segments must not be summed again.
    summed: u32,
    /// The last segment of a write in blocks. The server holds it back, because only the end of the transfer gives the
    /// number of its used bytes.
    held: Option<Bytes>,
}

impl Transfer {
    const fn new(size: Option<u32>, block: BlockSize, sums: bool) -> Self {
        Self {
            size,
            offset: 0,
            toggle: false,
            block,
            number: 0,
            checksum: Checksum::new(),
            sums,
            summed: 0,
            held: None,
        }
    }
}

/// The first byte of an answer, without its flags.
mod reply {
    pub const UPLOAD_SEGMENT: u8 = 0x00;
    pub const DOWNLOAD_SEGMENT: u8 = 0x20;
    pub const UPLOAD: u8 = 0x40;
    pub const DOWNLOAD: u8 = 0x60;
    pub const ABORT: u8 = 0x80;
    /// With a checksum.
    pub const BLOCK_DOWNLOAD: u8 = 0xA4;
    pub const BLOCK_DOWNLOAD_END: u8 = 0xA1;
    pub const BLOCK_DOWNLOAD_ANSWER: u8 = 0xA2;
    /// With a checksum and the length.
    pub const BLOCK_UPLOAD: u8 = 0xC6;
    pub const BLOCK_UPLOAD_END: u8 = 0xC1;
}

/// The first byte of the request that breaks a transfer off.
const ABORT: u8 = 0x80;
/// The first byte of a request to read, with 0 in all reserved bits.
const BARE_UPLOAD: u8 = 0x40;
/// The first byte of a request to write in blocks, without its flags.
const BLOCK_DOWNLOAD: u8 = 0xC0;
/// Flags of that byte: length and checksum.
const WITH_SIZE_AND_SUM: u8 = 0x06;
/// The toggle bit of a segment.
const TOGGLE: u8 = 0x10;
/// The segment of a block is the last.
const LAST: u8 = 0x80;

/// An SDO server.
#[derive(Clone, Copy, Debug)]
pub struct SdoServer {
    node: NodeId,
    patience: Periods,
    block: BlockSize,
    state: State,
    transfer: Transfer,
    /// The object of the transfer; 0000h without a transfer.
    object: Object,
    /// Time since the last frame of the transfer.
    quiet: Periods,
}

impl SdoServer {
    /// A server for `node`. It breaks a transfer off when the client is silent for longer than `patience`. It takes
    /// blocks of `block` segments.
    #[must_use]
    pub const fn new(node: NodeId, patience: Periods, block: BlockSize) -> Self {
        Self {
            node,
            patience,
            block,
            state: State::Idle,
            transfer: Transfer::new(None, block, false),
            object: Object::new(0, 0),
            quiet: Periods::new(0),
        }
    }

    /// True while a transfer is going on.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle | State::Swallow)
    }

    /// Takes a frame from the bus and gives the answer to send. The server ignores frames for other nodes and services,
    /// and frames without exactly eight bytes.
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
        let mut reply = [0; 8];
        if self.state == State::Swallow && self.swallows(&bytes) {
            return None;
        }
        let answered = self.answer(&bytes, &mut reply, objects);
        self.finish(answered, reply, objects)
    }

    /// The next segment to send to a client that reads in blocks; `None` where there is nothing to send now. Call this
    /// function as often as the sender has room for frames.
    pub fn poll<O: Objects + ?Sized>(&mut self, objects: &mut O) -> Option<Frame> {
        if self.state != State::Sending {
            return None;
        }
        self.quiet = Periods::new(0);
        let mut reply = [0; 8];
        let sent = self.next_segment(&mut reply, objects);
        self.finish(sent.map(|()| true), reply, objects)
    }

    /// Counts the time `by`; gives the abort to send where the client has been silent for too long.
    pub fn elapse<O: Objects + ?Sized>(&mut self, by: Periods, objects: &mut O) -> Option<Frame> {
        if self.state == State::Idle {
            return None;
        }
        self.quiet = self.quiet.plus(by);
        if self.quiet <= self.patience {
            return None;
        }
        self.quiet = Periods::new(0);
        if self.state == State::Swallow {
            self.state = State::Idle;
            return None;
        }
        self.finish(Err(Abort::TimedOut), [0; 8], objects)
    }

    /// Ends the transfer without an abort frame: the communication was reset or stopped.
    pub fn reset<O: Objects + ?Sized>(&mut self, objects: &mut O) {
        self.close(objects);
    }

    /// The frame to send: the answer, or the abort with its code. `None` where there is no answer.
    #[inline(never)]
    fn finish<O: Objects + ?Sized>(
        &mut self,
        answered: Result<bool, Abort>,
        mut reply: Bytes,
        objects: &mut O,
    ) -> Option<Frame> {
        match answered {
            Ok(true) => {}
            Ok(false) => return None,
            Err(abort) => {
                let [low, high] = self.object.index.to_le_bytes();
                let [a, b, c, d] = abort.code().to_le_bytes();
                reply = [reply::ABORT, low, high, self.object.sub, a, b, c, d];
                let more = self.state == State::Taking;
                self.close(objects);
                if more {
                    self.state = State::Swallow;
                }
            }
        }
        Some(Frame::of(CobId::of(Service::SdoReply, self.node), reply))
    }

    /// Takes a request and writes the answer into `reply`, which holds zeros. False where there is no answer.
    fn answer<O: Objects + ?Sized>(
        &mut self,
        bytes: &Bytes,
        reply: &mut Bytes,
        objects: &mut O,
    ) -> Result<bool, Abort> {
        let [head, first, second, ..] = *bytes;
        match self.state {
            // During a block only an abort is a command: its first byte would be segment number 0, and segments count
            // from 1.
            State::Taking if head != ABORT => return self.take_segment(bytes, reply, objects),
            // A repetition of the last segment may look like the command that ends the transfer.
            State::Taken if self.transfer.held == Some(*bytes) => return Ok(false),
            _ => {}
        }
        match (head >> 5, head & 3) {
            (0, _) => self.take_piece(bytes, reply, objects)?,
            (1, _) | (6, 0 | 2) => {
                self.open(bytes, reply, objects);
                self.begin_write(bytes, reply, objects)?;
            }
            (2, _) | (5, 0) => {
                self.open(bytes, reply, objects);
                self.begin_read(bytes, reply, objects)?;
            }
            (3, _) => self.give_piece(head, reply, objects)?,
            (4, _) => {
                self.close(objects);
                return Ok(false);
            }
            (5, 1) => {
                if self.state != State::Read {
                    return Err(Abort::Specifier);
                }
                self.close(objects);
                return Ok(false);
            }
            (5, 2) => return self.answered(first, second, reply),
            (5, _) => {
                if self.state != State::Offered {
                    return Err(Abort::Specifier);
                }
                self.state = State::Sending;
                return Ok(false);
            }
            (6, 1) => {
                let crc = u16::from_le_bytes([first, second]);
                self.end_blocks(head >> 2 & 7, crc, objects)?;
                reply[0] = reply::BLOCK_DOWNLOAD_END;
            }
            _ => return Err(Abort::Specifier),
        }
        Ok(true)
    }

    /// Ends any transfer and begins a new one; the answer names the object.
    fn open<O: Objects + ?Sized>(&mut self, bytes: &Bytes, reply: &mut Bytes, objects: &mut O) {
        self.close(objects);
        let [_, low, high, sub, ..] = *bytes;
        [_, reply[1], reply[2], reply[3], ..] = *bytes;
        self.object = Object::new(u16::from_le_bytes([low, high]), sub);
    }

    /// Ends any transfer; abandons a write that was begun.
    fn close<O: Objects + ?Sized>(&mut self, objects: &mut O) {
        if self.state.is_write() {
            objects.abandon(self.object);
        }
        self.state = State::Idle;
        self.object = Object::new(0, 0);
    }

    /// True for a frame that may belong to the rest of an aborted block: the server must discard the frame. The block's
    /// last segment, or an abort, ends this state. A request to read passes, and so does a request to write in blocks,
    /// which alone changes nothing: neither does harm, and a client that begins a new transfer gets its answer. A last
    /// segment with number 64, 66, 68 or 70 looks like a request to write in blocks and passes, too.
    fn swallows(&mut self, bytes: &Bytes) -> bool {
        let [head, _, _, _, rest @ ..] = *bytes;
        if head & LAST != 0 {
            self.state = State::Idle;
            return head & !WITH_SIZE_AND_SUM != BLOCK_DOWNLOAD;
        }
        head != BARE_UPLOAD || rest != [0; 4]
    }
}

/// The number in the last four bytes.
const fn long([_, _, _, _, a, b, c, d]: Bytes) -> u32 {
    u32::from_le_bytes([a, b, c, d])
}
