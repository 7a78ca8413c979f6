//! Lines of text, and the digits in them.

/// The end of a line.
const CR: u8 = b'\r';

/// Refusal; it needs no CR.
const BEL: u8 = 0x07;

/// The longest line: an extended frame with eight bytes and a time stamp.
const LONGEST: usize = 1 + 8 + 1 + 16 + 4 + 1;

/// A line with its end, ready to send.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Line {
    bytes: [u8; LONGEST],
    len: usize,
}

impl Line {
    /// The bytes to send.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&self.bytes)
    }

    /// A BEL.
    pub(super) fn bell() -> Self {
        Self::default().with(BEL)
    }

    /// Adds `byte` to the line.
    pub(super) fn with(mut self, byte: u8) -> Self {
        // The longest line has room for every byte that is written.
        if let Some(place) = self.bytes.get_mut(self.len) {
            *place = byte;
            self.len = self.len.saturating_add(1);
        }
        self
    }

    /// Adds a number of `digits` hexadecimal digits to the line.
    pub(super) fn hex(self, value: u32, digits: u32) -> Self {
        (0..digits).rev().fold(self, |line, place| {
            let shift = place.saturating_mul(4);
            line.with(digit(value.wrapping_shr(shift) & 0xF))
        })
    }

    /// Adds the end of the line.
    pub(super) fn end(self) -> Self {
        self.with(CR)
    }
}

/// The digit of a value below 16.
fn digit(value: u32) -> u8 {
    let digit = char::from_digit(value, 16).unwrap_or('0');
    digit.to_ascii_uppercase() as u8
}

/// The value of the hexadecimal `digits`; `None` where one of them is no digit, or there are no digits or more than
/// eight.
pub(super) fn number(digits: &[u8]) -> Option<u32> {
    if digits.is_empty() || digits.len() > 8 {
        return None;
    }
    digits.iter().try_fold(0_u32, |value, byte| {
        Some(value.wrapping_shl(4) | char::from(*byte).to_digit(16)?)
    })
}

/// A complete message from the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard<'a> {
    /// A line, without its end. An empty line is an adapter's confirmation.
    Line(&'a [u8]),
    /// A BEL: an adapter's refusal.
    Bell,
    /// A line that is too long.
    TooLong,
}

/// Cuts bytes into lines of at most `ROOM` bytes. The default is the longest line with a classical frame; an adapter
/// with other frames needs more.
#[derive(Clone, Copy, Debug)]
pub struct Lines<const ROOM: usize = LONGEST> {
    bytes: [u8; ROOM],
    /// Bytes of the line so far; more than the room means that the line is too long.
    len: usize,
    /// The line so far was already given out.
    complete: bool,
}

impl<const ROOM: usize> Default for Lines<ROOM> {
    fn default() -> Self {
        Self::with_room()
    }
}

impl Lines {
    /// An empty line.
    #[must_use]
    pub const fn new() -> Self {
        Self::with_room()
    }
}

impl<const ROOM: usize> Lines<ROOM> {
    /// An empty line.
    #[must_use]
    pub const fn with_room() -> Self {
        Self {
            bytes: [0; ROOM],
            len: 0,
            complete: false,
        }
    }

    /// Takes a byte. A BEL drops the unfinished line before it; a line feed is ignored.
    pub fn push(&mut self, byte: u8) -> Option<Heard<'_>> {
        if self.complete {
            self.complete = false;
            self.len = 0;
        }
        match byte {
            CR => {
                self.complete = true;
                Some(
                    self.bytes
                        .get(..self.len)
                        .map_or(Heard::TooLong, Heard::Line),
                )
            }
            BEL => {
                self.complete = true;
                Some(Heard::Bell)
            }
            b'\n' => None,
            byte => {
                if let Some(place) = self.bytes.get_mut(self.len) {
                    *place = byte;
                }
                self.len = self.len.saturating_add(1).min(ROOM.saturating_add(1));
                None
            }
        }
    }
}
