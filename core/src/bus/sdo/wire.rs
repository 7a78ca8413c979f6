//! The eight bytes of every SDO frame, in both directions.
//!
//! The first byte holds the command specifier (bits 7–5) and its flags. Bytes 1–3 hold the object in frames that name
//! one. The first byte of a block segment is a sequence number instead: only the state of the transfer tells a segment
//! from a command.
//!
//! The client uses requests and responses as values. The server reads the request's bytes and writes the response's
//! bytes in place [D161]. Tests run client and server against each other.

use crc::{CRC_16_XMODEM, Crc, NoTable};

use crate::bus::Object;

/// The payload of an SDO frame.
pub type Bytes = [u8; 8];

/// Bytes of a value in one segment.
pub const SEGMENT: u8 = 7;

/// Checksum of a block transfer so far: polynomial 1021h, start value 0, no reflection [CiA 301].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Checksum(u16);

impl Checksum {
    /// The checksum of no bytes.
    #[must_use]
    pub const fn new() -> Self {
        Self(0)
    }

    /// No table: it saves 512 bytes of flash. The few hundred instructions a segment take little time compared with the
    /// segment's frame.
    const CRC: Crc<u16, NoTable> = Crc::<u16, NoTable>::new(&CRC_16_XMODEM);

    /// The checksum continued with `bytes`.
    #[must_use]
    pub const fn with(self, bytes: &[u8]) -> Self {
        let mut digest = Self::CRC.digest_with_initial(self.0);
        digest.update(bytes);
        Self(digest.finalize())
    }

    /// The CRC to send.
    #[must_use]
    pub const fn get(self) -> u16 {
        self.0
    }
}

/// Up to seven bytes of a value; unused bytes are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Piece {
    bytes: [u8; 7],
    len: u8,
}

impl Piece {
    /// The first `len` bytes; all seven where `len` is larger.
    #[must_use]
    pub fn new(mut bytes: [u8; 7], len: u8) -> Self {
        let len = len.min(SEGMENT);
        for byte in bytes.iter_mut().skip(usize::from(len)) {
            *byte = 0;
        }
        Self { bytes, len }
    }

    /// All but the last `unused` bytes.
    #[must_use]
    pub fn without(bytes: [u8; 7], unused: u8) -> Self {
        Self::new(bytes, SEGMENT.saturating_sub(unused))
    }

    /// The bytes.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        self.bytes
            .get(..usize::from(self.len))
            .unwrap_or(&self.bytes)
    }

    /// All seven, as in a frame.
    #[must_use]
    pub const fn bytes(&self) -> [u8; 7] {
        self.bytes
    }

    /// The number of bytes, 0–7.
    #[must_use]
    pub const fn len(&self) -> u8 {
        self.len
    }

    /// The number of unused bytes, 0–7.
    #[must_use]
    pub const fn unused(&self) -> u8 {
        SEGMENT.saturating_sub(self.len)
    }
}

/// A segment of a segmented transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Changes from segment to segment; false in the first.
    pub toggle: bool,
    /// No segment follows.
    pub last: bool,
    /// The bytes.
    pub piece: Piece,
}

impl Segment {
    fn encode(self) -> Bytes {
        let head = (self.toggle as u8) << 4 | self.piece.unused() << 1 | self.last as u8;
        with_seven(head, self.piece.bytes)
    }

    fn decode(bytes: Bytes) -> Self {
        let (head, seven) = without_first(bytes);
        Self {
            toggle: head & 0x10 != 0,
            last: head & 1 != 0,
            piece: Piece::without(seven, head >> 1 & 7),
        }
    }
}

/// A segment of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockSegment {
    /// 1–127 within the block.
    pub number: u8,
    /// The value ends in it.
    pub last: bool,
    /// Seven bytes. For the last segment, only the end of the transfer gives the number of used bytes.
    pub bytes: [u8; 7],
}

impl BlockSegment {
    /// The bytes to send.
    pub fn encode(self) -> Bytes {
        with_seven((self.last as u8) << 7 | self.number & 0x7F, self.bytes)
    }

    /// Interprets any frame as a segment.
    pub fn decode(bytes: Bytes) -> Self {
        let (head, seven) = without_first(bytes);
        Self {
            number: head & 0x7F,
            last: head & 0x80 != 0,
            bytes: seven,
        }
    }
}

/// The beginning of an expedited or segmented transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// Expedited: one to four bytes. The transfer is already complete.
    Expedited(Piece),
    /// Expedited without a length: four bytes, of which some may be unused.
    ExpeditedUnsized([u8; 4]),
    /// Segmented, with the length in bytes if it was announced.
    Segments(Option<u32>),
}

impl Begin {
    fn encode(self, specifier: u8, object: Object) -> Bytes {
        match self {
            Self::Expedited(piece) => {
                let unused = 4_u8.saturating_sub(piece.len());
                let [a, b, c, d, ..] = piece.bytes;
                with_object(specifier | unused << 2 | 3, object, [a, b, c, d])
            }
            Self::ExpeditedUnsized(bytes) => with_object(specifier | 2, object, bytes),
            Self::Segments(Some(size)) => with_object(specifier | 1, object, size.to_le_bytes()),
            Self::Segments(None) => with_object(specifier, object, [0; 4]),
        }
    }

    fn decode(bytes: Bytes) -> Self {
        let [head, _, _, _, a, b, c, d] = bytes;
        match (head & 2 != 0, head & 1 != 0) {
            (true, true) => Self::Expedited(Piece::new(
                [a, b, c, d, 0, 0, 0],
                4_u8.saturating_sub(head >> 2 & 3),
            )),
            (true, false) => Self::ExpeditedUnsized([a, b, c, d]),
            (false, true) => Self::Segments(Some(u32::from_le_bytes([a, b, c, d]))),
            (false, false) => Self::Segments(None),
        }
    }
}

/// A request of a client; block segments are separate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Writes.
    Download(Object, Begin),
    /// A segment of a write.
    DownloadSegment(Segment),
    /// Reads.
    Upload(Object),
    /// Asks for the next segment, with this toggle bit.
    UploadSegment(bool),
    /// Breaks the transfer off, with an abort code.
    Abort(Object, u32),
    /// Writes in blocks.
    BlockDownload {
        /// The object to write.
        object: Object,
        /// The client makes a CRC.
        crc: bool,
        /// Length in bytes, if announced.
        size: Option<u32>,
    },
    /// The value is complete.
    BlockDownloadEnd {
        /// Number of unused bytes in the last segment.
        unused: u8,
        /// CRC over the whole value.
        crc: u16,
    },
    /// Reads in blocks.
    BlockUpload {
        /// The object to read.
        object: Object,
        /// The client checks a CRC.
        crc: bool,
        /// Segments in a block.
        block: u8,
        /// Up to this length the server may use an expedited or segmented transfer instead; 0: never.
        threshold: u8,
    },
    /// The client is ready for the first block.
    BlockUploadStart,
    /// Acknowledges a block up to this segment, and gives the size of the next block.
    BlockUploadAnswer {
        /// The last segment in sequence; 0: none.
        number: u8,
        /// Segments in the next block.
        block: u8,
    },
    /// The client has the value and its CRC is right.
    BlockUploadEnd,
}

impl Request {
    /// The bytes to send.
    pub fn encode(self) -> Bytes {
        match self {
            Self::Download(object, begin) => begin.encode(0x20, object),
            Self::DownloadSegment(segment) => segment.encode(),
            Self::Upload(object) => with_object(0x40, object, [0; 4]),
            Self::UploadSegment(toggle) => alone(0x60 | (toggle as u8) << 4),
            Self::Abort(object, code) => with_object(0x80, object, code.to_le_bytes()),
            Self::BlockDownload { object, crc, size } => {
                let (told, size) = optional(size);
                with_object(0xC0 | (crc as u8) << 2 | told << 1, object, size)
            }
            Self::BlockDownloadEnd { unused, crc } => {
                with_word(0xC1 | (unused & 7) << 2, crc.to_le_bytes())
            }
            Self::BlockUpload {
                object,
                crc,
                block,
                threshold,
            } => with_object(0xA0 | (crc as u8) << 2, object, [block, threshold, 0, 0]),
            Self::BlockUploadStart => alone(0xA3),
            Self::BlockUploadAnswer { number, block } => with_word(0xA2, [number, block]),
            Self::BlockUploadEnd => alone(0xA1),
        }
    }
}

/// A response of a server; block segments are separate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// A write has begun or, expedited, is done.
    Download(Object),
    /// A segment was taken.
    DownloadSegment(bool),
    /// A read has begun or, expedited, is done.
    Upload(Object, Begin),
    /// A segment of a read.
    UploadSegment(Segment),
    /// Breaks the transfer off, with an abort code.
    Abort(Object, u32),
    /// A write in blocks has begun.
    BlockDownload {
        /// The object to write.
        object: Object,
        /// The server checks a CRC.
        crc: bool,
        /// Segments in the first block.
        block: u8,
    },
    /// Acknowledges a block up to this segment, and gives the size of the next block.
    BlockDownloadAnswer {
        /// The last segment in sequence; 0: none.
        number: u8,
        /// Segments in the next block.
        block: u8,
    },
    /// The server has taken the whole value.
    BlockDownloadEnd,
    /// A read in blocks has begun.
    BlockUpload {
        /// The object to read.
        object: Object,
        /// The server makes a CRC.
        crc: bool,
        /// Length in bytes, if announced.
        size: Option<u32>,
    },
    /// The value is complete.
    BlockUploadEnd {
        /// Number of unused bytes in the last segment.
        unused: u8,
        /// CRC over the whole value.
        crc: u16,
    },
}

impl Response {
    /// The response in `bytes`; `None` for a specifier that does not exist.
    pub fn decode(bytes: Bytes) -> Option<Self> {
        let [head, first, second, _, a, b, c, d] = bytes;
        let object = object(bytes);
        let long = u32::from_le_bytes([a, b, c, d]);
        Some(match (head >> 5, head & 3) {
            (0, _) => Self::UploadSegment(Segment::decode(bytes)),
            (1, _) => Self::DownloadSegment(head & 0x10 != 0),
            (2, _) => Self::Upload(object, Begin::decode(bytes)),
            (3, _) => Self::Download(object),
            (4, _) => Self::Abort(object, long),
            (5, 0) => Self::BlockDownload {
                object,
                crc: head & 4 != 0,
                block: a,
            },
            (5, 1) => Self::BlockDownloadEnd,
            (5, 2) => Self::BlockDownloadAnswer {
                number: first,
                block: second,
            },
            (6, 0 | 2) => Self::BlockUpload {
                object,
                crc: head & 4 != 0,
                size: if head & 2 != 0 { Some(long) } else { None },
            },
            (6, 1) => Self::BlockUploadEnd {
                unused: head >> 2 & 7,
                crc: u16::from_le_bytes([first, second]),
            },
            _ => return None,
        })
    }
}

const fn alone(head: u8) -> Bytes {
    with_seven(head, [0; 7])
}

const fn with_word(head: u8, [a, b]: [u8; 2]) -> Bytes {
    with_seven(head, [a, b, 0, 0, 0, 0, 0])
}

const fn with_object(head: u8, object: Object, [a, b, c, d]: [u8; 4]) -> Bytes {
    let [low, high] = object.index.to_le_bytes();
    [head, low, high, object.sub, a, b, c, d]
}

const fn with_seven(head: u8, [a, b, c, d, e, f, g]: [u8; 7]) -> Bytes {
    [head, a, b, c, d, e, f, g]
}

const fn without_first([head, a, b, c, d, e, f, g]: Bytes) -> (u8, [u8; 7]) {
    (head, [a, b, c, d, e, f, g])
}

const fn object([_, low, high, sub, ..]: Bytes) -> Object {
    Object::new(u16::from_le_bytes([low, high]), sub)
}

const fn optional(size: Option<u32>) -> (u8, [u8; 4]) {
    match size {
        Some(size) => (1, size.to_le_bytes()),
        None => (0, [0; 4]),
    }
}
