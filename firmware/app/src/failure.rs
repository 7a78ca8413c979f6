//! Why the firmware stopped the last time: a few words that a reset leaves in memory, and the alarm that they become.
//!
//! The handler of a failure writes [`Failure::encode`] to memory that a reset leaves as it is, and resets the
//! processor. The next start finds the record with [`Failure::decode`]. Then nothing moves before somebody has reset
//! the alarm.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::checksum::crc32;

/// What stopped the firmware.
// A byte, so that the value fits into a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum FailureKind {
    /// A fault of the processor: an instruction or an address that does not exist.
    Fault,
    /// The program has found itself in an impossible state.
    Panic,
    /// The stack has left its memory.
    StackOverflow,
    /// The watchdog: tick or background had stopped.
    Hung,
    /// The power has dropped for a moment.
    PowerDropped,
}

/// All that is known of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What stopped the firmware.
    pub kind: FailureKind,
    /// Fault: address of the instruction. Panic: address within the call that panicked. Else 0.
    pub place: u32,
    /// Fault: return address of the faulting function. Panic: address within the call of the panicking function. Else 0.
    pub within: u32,
    /// SYNC periods since power-up; 0 where that is not known.
    pub ticks: u32,
    /// Version of the firmware that failed; see [`VERSION`].
    pub version: u32,
    /// The number of this failure in a row, from 1. A good run ([`Left::GOOD`](crate::Left::GOOD)) ends a row.
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

    /// After so many failures in a row the board does not move any more. Somebody has to switch it off for ten seconds,
    /// or reset its processor: power that comes back sooner counts as another failure.
    pub const LIMIT: u32 = 3;

    /// After so many failures in a row the firmware does not start any more: it fails before it could report anything.
    /// A loss of power never reaches this number: see [`Left::failure`](crate::Left::failure).
    pub const LAST: u32 = 10;

    /// The first word of a record: memory at power-up does not look like it. A new meaning of the other words needs a
    /// new mark.
    const MARK: u32 = 0x4C53_4652;

    /// A failure without a record.
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

    /// The board stays at rest and takes no more orders to move.
    #[must_use]
    pub const fn is_final(&self) -> bool {
        self.in_a_row >= Self::LIMIT
    }

    /// The failure as a record.
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

    /// The failure in a record; `None` where there is no record, or it is damaged.
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

    /// The alarm on which the board stands until it is reset. A [final](Self::is_final) failure keeps it for good.
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
