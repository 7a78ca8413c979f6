//! Lines of text, and the digits in them.

/// The end of a line.
const CR: u8 = b'\r';

/// Refusal; it stands alone.
const BEL: u8 = 0x07;

/// The longest line: an extended frame with eight bytes and a time stamp.
const LONGEST: usize = 1 + 8 + 1 + 16 + 4 + 1;

/// A line with its end, ready to be sent.
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

    /// The line so far and `byte`.
    pub(super) fn with(mut self, byte: u8) -> Self {
        // The longest line has room for all that is ever written into one.
        if let Some(place) = self.bytes.get_mut(self.len) {
            *place = byte;
            self.len = self.len.saturating_add(1);
        }
        self
    }

    /// The line so far and a number of `digits` hexadecimal digits.
    pub(super) fn hex(self, value: u32, digits: u32) -> Self {
        (0..digits).rev().fold(self, |line, place| {
            let shift = place.saturating_mul(4);
            line.with(digit(value.wrapping_shr(shift) & 0xF))
        })
    }

    /// The line and its end.
    pub(super) fn end(self) -> Self {
        self.with(CR)
    }
}

/// The digit of a value below 16.
fn digit(value: u32) -> u8 {
    let digit = char::from_digit(value, 16).unwrap_or('0');
    digit.to_ascii_uppercase() as u8
}

/// The number that all of `digits` are, hexadecimal; `None` where one of them is no digit, or there are none or more than
/// eight.
pub(super) fn number(digits: &[u8]) -> Option<u32> {
    if digits.is_empty() || digits.len() > 8 {
        return None;
    }
    digits.iter().try_fold(0_u32, |value, byte| {
        Some(value.wrapping_shl(4) | char::from(*byte).to_digit(16)?)
    })
}

/// What a byte has completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard<'a> {
    /// A line, without its end; an empty one is an adapter's consent.
    Line(&'a [u8]),
    /// A BEL: an adapter's refusal.
    Bell,
    /// A line longer than any there is.
    TooLong,
}

/// Cuts bytes into lines of at most `ROOM` bytes: as many as the longest one has,
/// unless an adapter knows more than classical frames.
#[derive(Clone, Copy, Debug)]
pub struct Lines<const ROOM: usize = LONGEST> {
    bytes: [u8; ROOM],
    /// Bytes of the line so far; more than there is room for means that it is too long.
    len: usize,
    /// The line before was handed out.
    complete: bool,
}

impl<const ROOM: usize> Default for Lines<ROOM> {
    fn default() -> Self {
        Self::with_room()
    }
}

impl Lines {
    /// Nothing heard so far.
    #[must_use]
    pub const fn new() -> Self {
        Self::with_room()
    }
}

impl<const ROOM: usize> Lines<ROOM> {
    /// Nothing heard so far.
    #[must_use]
    pub const fn with_room() -> Self {
        Self {
            bytes: [0; ROOM],
            len: 0,
            complete: false,
        }
    }

    /// Takes a byte. A BEL drops what came of the line before it; a line feed counts as nothing.
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
