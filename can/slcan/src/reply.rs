//! The replies of an adapter.

use super::frame::SlcanFrame;
use super::line::{Heard, Line, number};

/// Time of arrival by the adapter's clock: milliseconds, 0–59 999, then again from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Stamp(u16);

impl Stamp {
    /// The stamp for a clock that shows this many milliseconds.
    #[must_use]
    pub const fn at(ms: u64) -> Self {
        Self((ms % 60_000) as u16)
    }

    /// Milliseconds within the minute.
    #[must_use]
    pub const fn ms(self) -> u16 {
        self.0
    }
}

/// The errors of an adapter since the host last asked for them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(pub(super) u8);

impl Flags {
    /// The receive queue is full.
    pub const RECEIVE_FULL: Self = Self(0x01);
    /// The send queue is full.
    pub const SEND_FULL: Self = Self(0x02);
    /// Near to error passive.
    pub const WARNING: Self = Self(0x04);
    /// A frame was lost in the controller.
    pub const OVERRUN: Self = Self(0x08);
    /// Error passive.
    pub const PASSIVE: Self = Self(0x20);
    /// Arbitration lost against a frame of higher priority.
    pub const ARBITRATION: Self = Self(0x40);
    /// An error on the line.
    pub const BUS_ERROR: Self = Self(0x80);

    /// The flags as the byte on the line.
    #[must_use]
    pub const fn raw(self) -> u8 {
        self.0
    }

    /// True where all of `flags` are among these.
    #[must_use]
    pub const fn has(self, flags: Self) -> bool {
        self.0 & flags.0 == flags.0
    }

    /// These flags and `flags`.
    #[must_use]
    pub const fn with(self, flags: Self) -> Self {
        Self(self.0 | flags.0)
    }
}

/// A reply, or a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// Done.
    Done,
    /// Refused.
    Refused,
    /// `z`: the frame is on its way to the bus.
    Sent,
    /// `Z`: the frame with an extended identifier is on its way to the bus.
    SentExtended,
    /// `Vhhss`: hardware and software versions, two digits each.
    Version(u8, u8),
    /// `Nxxxx`: four letters or digits.
    Serial([u8; 4]),
    /// `Fxx`.
    Flags(Flags),
    /// A received frame.
    Frame(SlcanFrame, Option<Stamp>),
}

impl Reply {
    /// The reply as a line.
    #[must_use]
    pub fn line(&self) -> Line {
        let line = Line::default();
        match self {
            Self::Refused => return Line::bell(),
            Self::Done => line,
            Self::Sent => line.with(b'z'),
            Self::SentExtended => line.with(b'Z'),
            Self::Version(hardware, software) => line
                .with(b'V')
                .hex(u32::from(*hardware), 2)
                .hex(u32::from(*software), 2),
            Self::Serial(serial) => serial
                .iter()
                .fold(line.with(b'N'), |line, byte| line.with(*byte)),
            Self::Flags(flags) => line.with(b'F').hex(u32::from(flags.raw()), 2),
            Self::Frame(frame, stamp) => {
                let line = frame.write(line);
                match stamp {
                    Some(stamp) => line.hex(u32::from(stamp.ms()), 4),
                    None => line,
                }
            }
        }
        .end()
    }

    /// The reply in a received line; `None` where it is no reply.
    #[must_use]
    pub fn of(heard: Heard<'_>) -> Option<Self> {
        let line = match heard {
            Heard::Bell => return Some(Self::Refused),
            Heard::TooLong => return None,
            Heard::Line(line) => line,
        };
        match line {
            [] => Some(Self::Done),
            [b'z'] => Some(Self::Sent),
            [b'Z'] => Some(Self::SentExtended),
            [b'V', a, b, c, d] => Some(Self::Version(
                number(&[*a, *b])? as u8,
                number(&[*c, *d])? as u8,
            )),
            [b'N', serial @ ..] => Some(Self::Serial(serial.try_into().ok()?)),
            [b'F', a, b] => Some(Self::Flags(Flags(number(&[*a, *b])? as u8))),
            line => {
                let (frame, rest) = SlcanFrame::read(line)?;
                let stamp = match rest {
                    [] => None,
                    [_, _, _, _] => Some(Stamp::at(u64::from(number(rest)?))),
                    _ => return None,
                };
                Some(Self::Frame(frame, stamp))
            }
        }
    }
}
