//! The object dictionary as data: every object of a board, what it is and what it takes. The server answers from it, and
//! the EDS is printed from it.
//!
//! Two parts: the objects of CANopen and of the board itself, written down in `table`, and the
//! parameters, made of the parameter table: No. is index 2000h + No., an axis is a sub-index (1 X, 2 Z, 3 C), the bits of
//! a number are one byte.

use super::table::{NAMES, ROWS};
use crate::bus::{Abort, Object};
use crate::params::{Entry, FindError, Part};
use crate::units::Axis;

/// Name of sub-index 0 of an object with several.
pub(super) const HIGHEST: &str = "highest sub-index";

/// Index of parameter 0.
pub const PARAMETERS: u16 = 0x2000;

/// How a value travels.
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

    /// Bytes of a number; `None` where the length is the value's own.
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

    /// The number that `raw`, little-endian with zeros behind, means.
    #[must_use]
    pub const fn number(self, raw: [u8; 8]) -> i64 {
        let raw = i64::from_le_bytes(raw);
        match self {
            Self::I16 => raw as i16 as i64,
            Self::I32 => raw as i32 as i64,
            _ => raw,
        }
    }

    const fn of_range(low: i64, high: i64) -> Self {
        match (low, high) {
            (0.., ..=0xFF) => Self::U8,
            (0.., ..=0xFFFF) => Self::U16,
            (0.., ..=0xFFFF_FFFF) => Self::U32,
            _ => Self::I64,
        }
    }
}

/// Who may read and write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Never changes.
    Const,
    /// Read only.
    Read,
    /// Write only.
    Write,
    /// Both.
    Both,
}

impl Access {
    /// The word for it in an EDS.
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

/// The value after power-up, where it is known beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initial {
    /// Not known beforehand.
    Unknown,
    /// A number.
    Number(i64),
    /// The node's number plus this.
    OfNode(u32),
    /// A text.
    Text(&'static str),
}

/// Where the name of an item is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Name {
    /// With this line of the table.
    Line(usize),
    /// It is the highest sub-index of a parameter.
    Highest,
    /// It is an axis of a parameter.
    Axis(Axis),
    /// With the parameter.
    Parameter,
}

/// One sub-index of the dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// Where.
    pub object: Object,
    pub(super) name: Name,
    /// How it travels.
    pub kind: Kind,
    /// Who may do what.
    pub access: Access,
    /// The smallest and the largest number; `None`: all that the kind has.
    pub range: Option<(i64, i64)>,
    /// The value after power-up.
    pub initial: Initial,
    /// It stands in a PDO, or may.
    pub mappable: bool,
    /// The parameter behind it; of a number with bits, the first of them.
    pub entry: Option<&'static Entry>,
}

impl Item {
    /// What it is, in English; of a parameter, its axis or its key in machine files. A board does not ask: its image is
    /// without the texts.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.name {
            Name::Line(place) => NAMES.get(place).copied().unwrap_or(""),
            Name::Highest => HIGHEST,
            Name::Axis(Axis::X) => "X",
            Name::Axis(Axis::Z) => "Z",
            Name::Axis(Axis::C) => "C",
            Name::Parameter => self.entry.map_or("", |entry| entry.text().name),
        }
    }

    /// Sub-index 0 of an object with several: the highest there is.
    const fn count(index: u16, highest: u8) -> Self {
        Self {
            object: Object::new(index, 0),
            name: Name::Highest,
            kind: Kind::U8,
            access: Access::Const,
            range: None,
            initial: Initial::Number(highest as i64),
            mappable: false,
            entry: None,
        }
    }
}

/// The item of an object.
///
/// # Errors
/// [`Abort::NoObject`], [`Abort::NoSubIndex`].
pub fn find(object: Object) -> Result<Item, Abort> {
    match object.index {
        PARAMETERS..0x5000 => parameter(object),
        _ => of_table(object),
    }
}

/// All items by index and sub-index. Parameters with two numbers are listed under the first.
pub fn items() -> impl Iterator<Item = Item> {
    let before = table().filter(|item| item.object.index < PARAMETERS);
    let behind = table().filter(|item| item.object.index >= PARAMETERS);
    before.chain(parameters()).chain(behind)
}

fn table() -> impl Iterator<Item = Item> {
    ROWS.iter().enumerate().map(|(place, row)| row.item(place))
}

fn of_table(object: Object) -> Result<Item, Abort> {
    let mut rows = ROWS.iter().enumerate();
    if let Some((place, row)) = rows.find(|(_, row)| row.object == object) {
        return Ok(row.item(place));
    }
    if ROWS.iter().any(|row| row.object.index == object.index) {
        Err(Abort::NoSubIndex)
    } else {
        Err(Abort::NoObject)
    }
}

/// Every parameter, each number at its first entry.
fn parameters() -> impl Iterator<Item = Item> {
    let entries = Entry::all();
    entries.iter().enumerate().flat_map(|(place, entry)| {
        let before = place.checked_sub(1).and_then(|place| entries.get(place));
        let first = before.is_none_or(|before| before.no != entry.no);
        let index = PARAMETERS.saturating_add(entry.no);
        let count = match entry.part {
            Part::Axis(_) if first => Some(Item::count(index, highest(entry.no))),
            _ => None,
        };
        let value = match entry.part {
            Part::Bit(_) if !first => None,
            _ => Some(of_entry(index, entry)),
        };
        [count, value].into_iter().flatten()
    })
}

fn parameter(object: Object) -> Result<Item, Abort> {
    let no = object.index.saturating_sub(PARAMETERS);
    let first = match Entry::find(no, None) {
        Ok(entry) | Err(FindError::PartMissing(entry) | FindError::NoSuchPart(entry)) => entry,
        Err(FindError::Unknown) => return Err(Abort::NoObject),
    };
    let entry = match (first.part, object.sub) {
        (Part::Whole | Part::Bit(_), 0) => first,
        (Part::Whole | Part::Bit(_), _) => return Err(Abort::NoSubIndex),
        (Part::Axis(_), 0) => return Ok(Item::count(object.index, highest(first.no))),
        (Part::Axis(_), sub) => axis_of(sub)
            .and_then(|axis| Entry::find(no, Some(Part::Axis(axis))).ok())
            .ok_or(Abort::NoSubIndex)?,
    };
    Ok(of_entry(object.index, entry))
}

fn of_entry(index: u16, entry: &'static Entry) -> Item {
    let (sub, range) = match entry.part {
        Part::Whole => (0, (entry.min(), entry.max())),
        Part::Bit(_) => (0, (0, entry.byte_mask())),
        Part::Axis(axis) => (sub_of(axis), (entry.min(), entry.max())),
    };
    let name = match entry.part {
        Part::Whole | Part::Bit(_) => Name::Parameter,
        Part::Axis(axis) => Name::Axis(axis),
    };
    // The largest and the smallest integer stand for "none".
    let (low, high) = match entry.none() {
        Some(none) => (range.0.min(none), range.1.max(none)),
        None => range,
    };
    Item {
        object: Object::new(index, sub),
        name,
        kind: Kind::of_range(low, high),
        access: Access::Both,
        range: Some(range),
        initial: Initial::Unknown,
        mappable: false,
        entry: Some(entry),
    }
}

const fn sub_of(axis: Axis) -> u8 {
    match axis {
        Axis::X => 1,
        Axis::Z => 2,
        Axis::C => 3,
    }
}

const fn axis_of(sub: u8) -> Option<Axis> {
    match sub {
        1 => Some(Axis::X),
        2 => Some(Axis::Z),
        3 => Some(Axis::C),
        _ => None,
    }
}

/// The highest sub-index of a number with axes.
fn highest(no: u16) -> u8 {
    let of_number = Entry::all().iter().filter(|entry| entry.no == no);
    let subs = of_number.filter_map(|entry| match entry.part {
        Part::Axis(axis) => Some(sub_of(axis)),
        Part::Whole | Part::Bit(_) => None,
    });
    subs.max().unwrap_or(0)
}
