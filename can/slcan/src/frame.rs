//! Frames as text on the line.

use super::line::{Line, number};
use leadscrew_core::bus::{CobId, Frame};

/// A 29-bit identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExtendedId(u32);

impl ExtendedId {
    /// The identifier `raw`; `None` above 1FFF_FFFFh.
    #[must_use]
    pub const fn new(raw: u32) -> Option<Self> {
        match raw {
            0..=0x1FFF_FFFF => Some(Self(raw)),
            _ => None,
        }
    }

    /// The identifier as a number.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }
}

/// A data frame with a 29-bit identifier. Unused bytes are zero, so that equal frames compare equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ExtendedFrame {
    id: ExtendedId,
    len: u8,
    data: [u8; 8],
}

impl ExtendedFrame {
    /// A frame with the bytes of `payload`; `None` if there are more than eight.
    #[must_use]
    pub fn new(id: ExtendedId, payload: &[u8]) -> Option<Self> {
        let mut data = [0; 8];
        data.get_mut(..payload.len())?.copy_from_slice(payload);
        Some(Self {
            id,
            len: payload.len() as u8,
            data,
        })
    }

    /// The identifier.
    #[must_use]
    pub const fn id(&self) -> ExtendedId {
        self.id
    }

    /// The payload, up to eight bytes.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        self.data.get(..usize::from(self.len)).unwrap_or(&self.data)
    }
}

/// A frame that the protocol can carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SlcanFrame {
    /// `t`: a data frame with an 11-bit identifier.
    Data(Frame),
    /// `T`: a data frame with a 29-bit identifier.
    Extended(ExtendedFrame),
    /// `r`: a remote request with an 11-bit identifier and the requested length, 0–8.
    Remote(CobId, u8),
    /// `R`: a remote request with a 29-bit identifier.
    RemoteExtended(ExtendedId, u8),
}

impl SlcanFrame {
    /// Adds the frame to the line.
    pub(super) fn write(&self, line: Line) -> Line {
        match self {
            Self::Data(frame) => bytes(
                line.with(b't').hex(u32::from(frame.id().get()), 3),
                frame.payload(),
            ),
            Self::Extended(frame) => {
                bytes(line.with(b'T').hex(frame.id().get(), 8), frame.payload())
            }
            Self::Remote(id, len) => line
                .with(b'r')
                .hex(u32::from(id.get()), 3)
                .hex(u32::from(*len), 1),
            Self::RemoteExtended(id, len) => {
                line.with(b'R').hex(id.get(), 8).hex(u32::from(*len), 1)
            }
        }
    }

    /// The frame at the front of a line, and the rest of the line after it.
    pub(super) fn read(line: &[u8]) -> Option<(Self, &[u8])> {
        let (kind, rest) = line.split_first()?;
        let digits = match kind {
            b't' | b'r' => 3,
            b'T' | b'R' => 8,
            _ => return None,
        };
        let (id, rest) = rest.split_at_checked(digits)?;
        let id = number(id)?;
        let (len, rest) = rest.split_first()?;
        let len = number(&[*len]).filter(|len| *len <= 8)? as u8;
        let standard = || CobId::new(u16::try_from(id).ok()?);
        match kind {
            b'r' => return Some((Self::Remote(standard()?, len), rest)),
            b'R' => return Some((Self::RemoteExtended(ExtendedId::new(id)?, len), rest)),
            _ => {}
        }
        let (text, rest) = rest.split_at_checked(usize::from(len).saturating_mul(2))?;
        let mut data = [0; 8];
        let (pairs, _) = text.as_chunks::<2>();
        for (byte, pair) in data.iter_mut().zip(pairs) {
            *byte = number(pair)? as u8;
        }
        let payload = data.get(..usize::from(len))?;
        let frame = if *kind == b't' {
            Self::Data(Frame::new(standard()?, payload)?)
        } else {
            Self::Extended(ExtendedFrame::new(ExtendedId::new(id)?, payload)?)
        };
        Some((frame, rest))
    }
}

/// Adds a length and that many bytes to the line.
fn bytes(line: Line, payload: &[u8]) -> Line {
    let line = line.hex(payload.len() as u32, 1);
    payload
        .iter()
        .fold(line, |line, byte| line.hex(u32::from(*byte), 2))
}
