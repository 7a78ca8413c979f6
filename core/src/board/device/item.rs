//! The properties of one item of the dictionary: data type, access and initial value.
//!
//! Plain values. The table and the parameters know which objects exist.

use crate::bus::Object;
use crate::params::Entry;
use crate::units::Axis;

/// Data type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// UNSIGNED8.
    U8,
    /// UNSIGNED16.
    U16,
    /// UNSIGNED32.
    U32,
    /// UNSIGNED64.
    U64,
    /// INTEGER16.
    I16,
    /// INTEGER32.
    I32,
    /// INTEGER64.
    I64,
    /// VISIBLE_STRING.
    Text,
    /// DOMAIN.
    Domain,
}

impl Kind {
    /// Index of the data type in CiA 301.
    #[must_use]
    pub const fn code(self) -> u16 {
        match self {
            Self::I16 => 0x03,
            Self::I32 => 0x04,
            Self::U8 => 0x05,
            Self::U16 => 0x06,
            Self::U32 => 0x07,
            Self::Text => 0x09,
            Self::Domain => 0x0F,
            Self::I64 => 0x15,
            Self::U64 => 0x1B,
        }
    }

    /// Bytes of a number; `None` for a value with a length of its own.
    #[must_use]
    pub const fn bytes(self) -> Option<usize> {
        match self {
            Self::U8 => Some(1),
            Self::U16 | Self::I16 => Some(2),
            Self::U32 | Self::I32 => Some(4),
            Self::U64 | Self::I64 => Some(8),
            Self::Text | Self::Domain => None,
        }
    }

    /// The number in `raw`: little-endian, with zeros at the end.
    #[must_use]
    pub const fn number(self, raw: [u8; 8]) -> i64 {
        let raw = i64::from_le_bytes(raw);
        match self {
            Self::I16 => raw as i16 as i64,
            Self::I32 => raw as i32 as i64,
            _ => raw,
        }
    }
}

/// Access rights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// A constant.
    Const,
    /// Read only.
    Read,
    /// Write only.
    Write,
    /// Both.
    Both,
}

impl Access {
    /// The word in an EDS.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Const => "const",
            Self::Read => "ro",
            Self::Write => "wo",
            Self::Both => "rw",
        }
    }
}

/// The value after power-up, if it is known beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initial {
    /// Not known beforehand.
    Unknown,
    /// A number.
    Number(i64),
    /// The node number plus this.
    OfNode(u32),
    /// A text.
    Text(&'static str),
}

/// Source of an item's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Name {
    /// This row of the table.
    Line(usize),
    /// The item is the highest sub-index of an object.
    Highest,
    /// The item is an axis of a parameter.
    Axis(Axis),
    /// The parameter.
    Parameter,
}

/// One sub-index of the dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// Index and sub-index.
    pub object: Object,
    pub(super) name: Name,
    /// Data type.
    pub kind: Kind,
    /// Access rights.
    pub access: Access,
    /// The smallest and the largest number; `None`: all numbers of the data type.
    pub range: Option<(i64, i64)>,
    /// The value after power-up.
    pub initial: Initial,
    /// The item may stand in a PDO.
    pub mappable: bool,
    /// The parameter; for a number with bits, its first bit.
    pub entry: Option<&'static Entry>,
}
