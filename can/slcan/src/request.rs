//! The requests of a host to an adapter.

use super::frame::SlcanFrame;
use super::line::{Heard, Line, number};

/// The bit rates with a number in the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum BitRate {
    /// 10 kbit/s.
    K10 = 0,
    /// 20 kbit/s.
    K20 = 1,
    /// 50 kbit/s.
    K50 = 2,
    /// 100 kbit/s.
    K100 = 3,
    /// 125 kbit/s.
    K125 = 4,
    /// 250 kbit/s.
    K250 = 5,
    /// 500 kbit/s.
    K500 = 6,
    /// 800 kbit/s.
    K800 = 7,
    /// 1 Mbit/s.
    M1 = 8,
}

impl BitRate {
    /// All of them, by number.
    pub const ALL: [Self; 9] = [
        Self::K10,
        Self::K20,
        Self::K50,
        Self::K100,
        Self::K125,
        Self::K250,
        Self::K500,
        Self::K800,
        Self::M1,
    ];

    /// The rate of `kbit` kbit/s; `None` where an adapter does not have it.
    #[must_use]
    pub fn of_kbit(kbit: u32) -> Option<Self> {
        let bits = kbit.saturating_mul(1000);
        let mut all = Self::ALL.into_iter();
        all.find(|rate| rate.bits_per_second() == bits)
    }

    /// Bits in a second.
    #[must_use]
    pub const fn bits_per_second(self) -> u32 {
        match self {
            Self::K10 => 10_000,
            Self::K20 => 20_000,
            Self::K50 => 50_000,
            Self::K100 => 100_000,
            Self::K125 => 125_000,
            Self::K250 => 250_000,
            Self::K500 => 500_000,
            Self::K800 => 800_000,
            Self::M1 => 1_000_000,
        }
    }
}

/// A request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// `Sn`: the bit rate, while closed.
    Rate(BitRate),
    /// `sxxyy`: the timing registers BTR0 and BTR1 of an SJA1000 at 16 MHz, while closed.
    Timing(u8, u8),
    /// `O`: take part in the bus.
    Open,
    /// `L`: listen, and neither send nor acknowledge.
    Listen,
    /// `C`: leave the bus.
    Close,
    /// `t T r R`: send this frame.
    Send(SlcanFrame),
    /// `V`: the versions.
    Version,
    /// `N`: the serial number.
    Serial,
    /// `F`: give the error flags and clear them.
    Flags,
    /// `Zn`: received frames have a time stamp, or not.
    Stamps(bool),
    /// `Mxxxxxxxx`: the acceptance code, while closed.
    Code(u32),
    /// `mxxxxxxxx`: the acceptance mask, while closed; its ones do not count.
    Mask(u32),
}

impl Request {
    /// The request as a line.
    #[must_use]
    pub fn line(&self) -> Line {
        let line = Line::default();
        match self {
            Self::Rate(rate) => line.with(b'S').hex(*rate as u32, 1),
            Self::Timing(first, second) => line
                .with(b's')
                .hex(u32::from(*first), 2)
                .hex(u32::from(*second), 2),
            Self::Open => line.with(b'O'),
            Self::Listen => line.with(b'L'),
            Self::Close => line.with(b'C'),
            Self::Send(frame) => frame.write(line),
            Self::Version => line.with(b'V'),
            Self::Serial => line.with(b'N'),
            Self::Flags => line.with(b'F'),
            Self::Stamps(on) => line.with(b'Z').hex(u32::from(*on), 1),
            Self::Code(code) => line.with(b'M').hex(*code, 8),
            Self::Mask(mask) => line.with(b'm').hex(*mask, 8),
        }
        .end()
    }

    /// The request in a received line; `None` where it is no request.
    #[must_use]
    pub fn of(heard: Heard<'_>) -> Option<Self> {
        let Heard::Line(line) = heard else {
            return None;
        };
        let (kind, rest) = line.split_first()?;
        let alone = |request| rest.is_empty().then_some(request);
        let word = || (rest.len() == 8).then(|| number(rest)).flatten();
        match kind {
            b'O' => alone(Self::Open),
            b'L' => alone(Self::Listen),
            b'C' => alone(Self::Close),
            b'V' => alone(Self::Version),
            b'N' => alone(Self::Serial),
            b'F' => alone(Self::Flags),
            b'S' => match rest {
                [digit @ b'0'..=b'8'] => {
                    let number = usize::from(digit.wrapping_sub(b'0'));
                    BitRate::ALL.get(number).copied().map(Self::Rate)
                }
                _ => None,
            },
            b's' => match rest {
                [a, b, c, d] => Some(Self::Timing(
                    number(&[*a, *b])? as u8,
                    number(&[*c, *d])? as u8,
                )),
                _ => None,
            },
            b'Z' => match rest {
                [b'0'] => Some(Self::Stamps(false)),
                [b'1'] => Some(Self::Stamps(true)),
                _ => None,
            },
            b'M' => word().map(Self::Code),
            b'm' => word().map(Self::Mask),
            _ => match SlcanFrame::read(line)? {
                (frame, []) => Some(Self::Send(frame)),
                _ => None,
            },
        }
    }
}
