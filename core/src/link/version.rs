//! The version of the link: a number for people and a key over the message types.

use core::fmt;

use postcard_schema::Schema;
use postcard_schema::key::Key;
use serde::{Deserialize, Serialize};

use super::{Certificate, Logged, Status, ThreadCertificate};
use crate::alarm::Code;
use crate::call::Call;
use crate::signals::Signals;

/// The version of a link. Both sides must have the same version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Version {
    /// Incremented by hand with every release that changes the meaning of a message.
    pub number: u16,
    /// Key over all message types, field by field, over the bits of the signals, and over the list of alarms.
    #[serde(with = "postcard::fixint::le")]
    pub key: u32,
}

/// The version of this build. Since 2, [`Status::signals`] has the board's mirrored bits above its signals [D164]; since
/// 3, a batch names the revision of the offsets.
pub const VERSION: Version = Version {
    number: 3,
    key: key(),
};

impl Version {
    /// The version as one number, with the key in the lower 32 bits: object 5020h sub 2.
    #[must_use]
    pub const fn raw(self) -> u64 {
        ((self.number as u64) << 32) | self.key as u64
    }

    /// The version of a [`raw`](Self::raw) number; bits from 48 on do not count.
    #[must_use]
    pub const fn from_raw(raw: u64) -> Self {
        Self {
            number: (raw >> 32) as u16,
            key: raw as u32,
        }
    }
}

/// `1 (key 0123abcd)`.
impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (key {:08x})", self.number, self.key)
    }
}

const fn key() -> u32 {
    let key = Key::for_path::<(Call, Status, Logged, Certificate, ThreadCertificate)>("leadscrew");
    let mut hash = u64::from_le_bytes(key.to_bytes());
    // The type does not show the meaning of the signal bits, so the key includes the known bits: a side that knows
    // fewer bits would return the others with any value. FNV-1a, as above.
    hash = (hash ^ (Signals::BITS | Signals::MIRRORED) as u64).wrapping_mul(0x0000_0100_0000_01B3);
    // A message has only the number of an alarm, so both sides need the same list.
    let mut codes: &[Code] = Code::ALL;
    while let [first, rest @ ..] = codes {
        hash = (hash ^ first.number() as u64).wrapping_mul(0x0000_0100_0000_01B3);
        codes = rest;
    }
    (hash ^ (hash >> 32)) as u32
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::string::ToString;

    use super::*;

    #[test]
    fn a_version_is_read_back_and_printed() {
        let version = Version {
            number: 0x0102,
            key: 0x0000_BEEF,
        };
        assert_eq!(version.raw(), 0x0102_0000_BEEF);
        assert_eq!(Version::from_raw(version.raw()), version);
        assert_eq!(version.to_string(), "258 (key 0000beef)");
        assert_ne!(VERSION.key, 0);
    }
}
