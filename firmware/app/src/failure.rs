//! Why the firmware stopped the last time: a few words that outlive a reset, and the alarm they become.
//!
//! Whoever catches a failure writes [`Failure::encode`] to memory that a reset leaves as it is, and starts anew; at
//! power-up [`Failure::decode`] finds it there, and nothing moves before somebody has taken note.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::checksum::crc32;

/// What stopped it.
// A byte, so that it goes through a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum FailureKind {
    /// A fault of the processor: an instruction or an address that does not exist.
    Fault,
    /// The program has found itself in a state that cannot be.
    Panic,
    /// The stack has left its memory.
    StackOverflow,
    /// The watchdog: tick or background had stopped.
    Hung,
    /// The power has dropped for a moment.
    PowerDropped,
}

/// What is known of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What stopped it.
    pub kind: FailureKind,
    /// Fault: address of the instruction. Panic: address within the call that panicked. Else 0.
    pub place: u32,
    /// Fault: return address of the function it was in. Panic: address within the call of the function it was in. Else 0.
    pub within: u32,
    /// SYNC periods since power-up; 0 where that is not known.
    pub ticks: u32,
    /// Of the firmware that failed; see [`VERSION`].
    pub version: u32,
    /// Which failure in a row this is, from 1: between them was no good run ([`Left::GOOD`](crate::Left::GOOD)).
    pub in_a_row: u32,
}

/// This firmware: major, minor and patch version in a byte each.
pub const VERSION: u32 = number(env!("CARGO_PKG_VERSION_MAJOR")) << 16
    | number(env!("CARGO_PKG_VERSION_MINOR")) << 8
    | number(env!("CARGO_PKG_VERSION_PATCH"));

const fn number(text: &str) -> u32 {
    let mut bytes = text.as_bytes();
    let mut value = 0_u32;
    while let [digit, rest @ ..] = bytes {
        value = value
            .wrapping_mul(10)
            .wrapping_add(digit.wrapping_sub(b'0') as u32);
        bytes = rest;
    }
    value
}

impl Failure {
    /// Words of a record.
    pub const WORDS: usize = 8;

    /// With so many in a row the board does not move any more before somebody has switched it off for ten seconds, or
    /// reset its processor: power that comes back sooner is a failure of its own.
    pub const LIMIT: u32 = 3;

    /// With so many in a row it fails on its way to where it could say so: the firmware does not start any more.
    /// The power never makes it so many: see [`Left::failure`](crate::Left::failure).
    pub const LAST: u32 = 10;

    /// In front of a record: memory at power-up does not look like it. Another one for each meaning of the words behind it.
    const MARK: u32 = 0x4C53_4652;

    /// One that leaves no record.
    pub(crate) const fn untold(kind: FailureKind) -> Self {
        Self {
            kind,
            place: 0,
            within: 0,
            ticks: 0,
            version: VERSION,
            in_a_row: 1,
        }
    }

    /// The board stays at rest, whatever it is told.
    #[must_use]
    pub const fn is_final(&self) -> bool {
        self.in_a_row >= Self::LIMIT
    }

    /// As a record.
    #[must_use]
    pub fn encode(&self) -> [u32; Self::WORDS] {
        let kind = match self.kind {
            FailureKind::Fault => 1,
            FailureKind::Panic => 2,
            FailureKind::StackOverflow => 3,
            FailureKind::Hung => 4,
            FailureKind::PowerDropped => 5,
        };
        let words = [
            Self::MARK,
            kind,
            self.place,
            self.within,
            self.ticks,
            self.version,
            self.in_a_row,
        ];
        let [a, b, c, d, e, f, g] = words;
        [a, b, c, d, e, f, g, checksum(&words)]
    }

    /// The failure in a record; `None` where there is none, or it is not whole.
    #[must_use]
    pub fn decode(record: &[u32; Self::WORDS]) -> Option<Self> {
        let &[mark, kind, place, within, ticks, version, in_a_row, sum] = record;
        let words = [mark, kind, place, within, ticks, version, in_a_row];
        if mark != Self::MARK || sum != checksum(&words) {
            return None;
        }
        let kind = match kind {
            1 => FailureKind::Fault,
            2 => FailureKind::Panic,
            3 => FailureKind::StackOverflow,
            4 => FailureKind::Hung,
            5 => FailureKind::PowerDropped,
            _ => return None,
        };
        Some(Self {
            kind,
            place,
            within,
            ticks,
            version,
            in_a_row,
        })
    }

    /// What the board stands on: until it is reset, or for good where it [is final](Self::is_final).
    #[must_use]
    pub fn alarm(&self) -> Alarm {
        let (code, args) = self.told();
        let (code, args) = if self.is_final() {
            let again = [
                Arg::Int(self.in_a_row as i64),
                Arg::Int(code.number() as i64),
                Arg::Key(self.place),
                Arg::Key(self.within),
            ];
            (Code::FailsAgain, again)
        } else {
            (code, args)
        };
        Alarm::of(code, &args)
    }

    const fn told(&self) -> (Code, [Arg; 4]) {
        let ticks = Arg::Int(self.ticks as i64);
        let version = Arg::Key(self.version);
        match self.kind {
            FailureKind::Hung => (Code::FirmwareHung, [ticks, Arg::None, Arg::None, Arg::None]),
            FailureKind::PowerDropped => {
                (Code::PowerDropped, [ticks, Arg::None, Arg::None, Arg::None])
            }
            FailureKind::Fault => (
                Code::FirmwareFault,
                [Arg::Key(self.place), Arg::Key(self.within), ticks, version],
            ),
            FailureKind::Panic => (
                Code::FirmwarePanic,
                [Arg::Key(self.place), Arg::Key(self.within), ticks, version],
            ),
            FailureKind::StackOverflow => {
                (Code::FirmwareStack, [ticks, version, Arg::None, Arg::None])
            }
        }
    }
}

/// CRC-32 of words, little-endian.
pub(crate) fn checksum(words: &[u32]) -> u32 {
    words
        .iter()
        .fold(0, |sum, word| crc32(sum, &word.to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PANIC: Failure = Failure {
        kind: FailureKind::Panic,
        place: 0x0800_1234,
        within: 0x0800_2345,
        ticks: 4711,
        version: VERSION,
        in_a_row: 2,
    };

    #[test]
    fn a_record_reads_back_and_what_is_not_whole_is_none() {
        for kind in [
            FailureKind::Fault,
            FailureKind::Panic,
            FailureKind::StackOverflow,
            FailureKind::Hung,
            FailureKind::PowerDropped,
        ] {
            let failure = Failure { kind, ..PANIC };
            assert_eq!(Failure::decode(&failure.encode()), Some(failure));
        }
        let record = PANIC.encode();
        for word in 0..Failure::WORDS {
            for bit in 0..32 {
                let mut damaged = record;
                damaged[word] ^= 1 << bit;
                assert_eq!(Failure::decode(&damaged), None);
            }
        }
        assert_eq!(Failure::decode(&[0; Failure::WORDS]), None);
        assert_eq!(Failure::decode(&[u32::MAX; Failure::WORDS]), None);
    }

    #[test]
    fn the_version_is_one_of_three_bytes() {
        assert_eq!(number("10"), 10);
        assert_eq!(VERSION, 0x0000_0100);
    }
}
