//! What the tick has to know of the storage: whether the parameters are the ones that were stored, and whether a write has
//! failed. It knows no region and no byte of it.

use crate::alarm::{Alarm, Arg, Code};
use crate::params::{SCHEMA, TABLE_KEY};

/// The state of a board's stored parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Found {
    /// The newest set, whole.
    #[default]
    Newest,
    /// Nothing was ever stored.
    Nothing,
    /// The newest set is damaged. The set before is whole and loaded.
    Older,
    /// The stored sets are damaged. The built-in set is loaded.
    Lost,
    /// A set of another table. The built-in set is loaded.
    Foreign {
        /// Number of its table.
        schema: u16,
        /// Key of its table.
        key: u32,
    },
}

impl Found {
    /// The state as a number: 5011h:04.
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::Newest => 0,
            Self::Nothing => 1,
            Self::Older => 2,
            Self::Lost => 3,
            Self::Foreign { .. } => 4,
        }
    }

    /// The alarm that forbids motion; `None` where motion is allowed.
    #[must_use]
    pub fn alarm(self) -> Option<Alarm> {
        let (code, args) = match self {
            Self::Newest | Self::Nothing => return None,
            Self::Older => (Code::ParametersOlder, [Arg::None; 4]),
            Self::Lost => (Code::ParametersLost, [Arg::None; 4]),
            Self::Foreign { schema, key } => (
                Code::ParametersForeign,
                [
                    Arg::Int(schema.into()),
                    Arg::Key(key),
                    Arg::Int(SCHEMA.into()),
                    Arg::Key(TABLE_KEY),
                ],
            ),
        };
        Some(Alarm::of(code, &args))
    }

    /// A warning that stops nothing.
    #[must_use]
    pub fn warning(self) -> Option<Alarm> {
        (self == Self::Nothing).then(|| Alarm::of(Code::ParametersBuiltIn, &[]))
    }
}

/// A write or a read that has failed. After a failed write, the region holds its old content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The device refuses or does not answer.
    Device,
    /// There is no room.
    Full,
    /// The content of the device makes no sense any more and could not be repaired.
    Damaged,
}
