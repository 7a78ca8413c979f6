//! The object dictionary as data: every object of a board with its properties. The SDO server answers from it, and the EDS
//! is printed from it.
//!
//! It has two parts. The objects of CANopen and of the board are in `objects`. The parameters come from the parameter
//! table: parameter No. has index 2000h + No.; an axis is a sub-index (1 X, 2 Z, 3 C); the bits of a number are one byte.

use super::item::Name;
pub use super::item::{Access, Initial, Item, Kind};
use super::table::{NAMES, ROWS, Row};
use crate::bus::{Abort, Object};
use crate::params::{Entry, Part};
use crate::units::Axis;

/// Name of sub-index 0 of an object with several sub-indices.
const HIGHEST: &str = "highest sub-index";

/// Index of parameter 0.
pub const PARAMETERS: u16 = 0x2000;

impl Kind {
    fn of_entry(entry: &Entry) -> Self {
        match range_of(entry) {
            (0.., ..=0xFF) => Self::U8,
            (0.., ..=0xFFFF) => Self::U16,
            (0.., ..=0xFFFF_FFFF) => Self::U32,
            _ => Self::I64,
        }
    }
}

impl Item {
    /// Its meaning in English; for a parameter, its axis or its key in machine files. A board does not ask for it: its
    /// image has no texts.
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

    /// Sub-index 0 of an object with several: the highest sub-index.
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

/// The source of an object. A board asks for one property after the other.
#[derive(Clone, Copy, Debug)]
pub(super) enum ObjectSource {
    /// A row of the table.
    Row(&'static Row),
    /// The highest sub-index of an object with several.
    Highest(u8),
    /// A parameter. For a number with bits, its first bit.
    Parameter(&'static Entry),
}

impl ObjectSource {
    pub fn kind(self) -> Kind {
        match self {
            Self::Row(row) => row.kind,
            Self::Highest(_) => Kind::U8,
            Self::Parameter(entry) => Kind::of_entry(entry),
        }
    }

    pub const fn access(self) -> Access {
        match self {
            Self::Row(row) => row.access,
            Self::Highest(_) => Access::Const,
            Self::Parameter(_) => Access::Both,
        }
    }

    /// Checks whether this number, which fits the kind, may be written.
    ///
    /// # Errors
    /// [`Abort::TooLow`], [`Abort::TooHigh`].
    pub fn admit(self, number: i64) -> Result<(), Abort> {
        let range = match self {
            Self::Row(row) => row.range(),
            Self::Highest(_) => None,
            Self::Parameter(entry) => Some(range_of(entry)),
        };
        match range {
            Some((low, _)) if number < low => Err(Abort::TooLow),
            Some((_, high)) if number > high => Err(Abort::TooHigh),
            _ => Ok(()),
        }
    }
}

/// The source of an object.
///
/// # Errors
/// [`Abort::NoObject`], [`Abort::NoSubIndex`].
pub(super) fn find(object: Object) -> Result<ObjectSource, Abort> {
    let mut highest = None;
    if let PARAMETERS..0x5000 = object.index {
        let no = Entry::number_of(object.index.wrapping_sub(PARAMETERS));
        for entry in Entry::all().iter().filter(|entry| entry.no == no) {
            let sub = sub_of(entry);
            if sub == object.sub {
                return Ok(ObjectSource::Parameter(entry));
            }
            // The tables are sorted.
            highest = Some(sub);
        }
    }
    for row in &ROWS {
        if row.object == object {
            return Ok(ObjectSource::Row(row));
        }
        if row.object.index == object.index {
            highest = Some(row.object.sub);
        }
    }
    match highest {
        Some(highest @ 1..) if object.sub == 0 => Ok(ObjectSource::Highest(highest)),
        Some(_) => Err(Abort::NoSubIndex),
        None => Err(Abort::NoObject),
    }
}

/// All items by index and sub-index. A parameter with two numbers is listed under the first.
pub fn items() -> impl Iterator<Item = Item> {
    let before = table().filter(|item| item.object.index < PARAMETERS);
    let behind = table().filter(|item| item.object.index >= PARAMETERS);
    before.chain(parameters()).chain(behind)
}

fn table() -> impl Iterator<Item = Item> {
    ROWS.iter().enumerate().flat_map(|(place, row)| {
        let Object { index, sub } = row.object;
        let alike = || ROWS.iter().filter(|other| other.object.index == index);
        let first = alike().all(|other| other.object.sub >= sub);
        let highest = alike().map(|other| other.object.sub).max().unwrap_or(0);
        let count = (first && sub != 0).then(|| Item::count(index, highest));
        [count, Some(row.item(place))].into_iter().flatten()
    })
}

/// All parameters; a number with several values is listed once, at its first entry.
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

fn of_entry(index: u16, entry: &'static Entry) -> Item {
    let name = match entry.part {
        Part::Whole | Part::Bit(_) => Name::Parameter,
        Part::Axis(axis) => Name::Axis(axis),
    };
    Item {
        object: Object::new(index, sub_of(entry)),
        name,
        kind: Kind::of_entry(entry),
        access: Access::Both,
        range: Some(range_of(entry)),
        initial: Initial::Unknown,
        mappable: false,
        entry: Some(entry),
    }
}

/// The range of a parameter, including the number for "none". That number is the next one outside of the other values, so
/// that two limits describe all of them [D197].
fn range_of(entry: &Entry) -> (i64, i64) {
    match entry.part {
        Part::Whole | Part::Axis(_) => {
            let (low, high) = (entry.min(), entry.max());
            match none_of(entry) {
                Some(none) => (low.min(none), high.max(none)),
                None => (low, high),
            }
        }
        Part::Bit(_) => (0, entry.byte_mask()),
    }
}

/// The number for "none" in an object: one step outside of the values. In a set it is the largest or the smallest integer.
fn none_of(entry: &Entry) -> Option<i64> {
    entry.none().map(|none| {
        if none > entry.max() {
            entry.max().saturating_add(1)
        } else {
            entry.min().saturating_sub(1)
        }
    })
}

/// The object's number for a value of the set.
pub(super) fn told(entry: &Entry, raw: i64) -> i64 {
    match none_of(entry) {
        Some(none) if entry.none() == Some(raw) => none,
        _ => raw,
    }
}

/// The set's value for a number written to the object.
pub(super) fn taken(entry: &Entry, number: i64) -> i64 {
    match entry.none() {
        Some(none) if none_of(entry) == Some(number) => none,
        _ => number,
    }
}

const fn sub_of(entry: &Entry) -> u8 {
    match entry.part {
        Part::Whole | Part::Bit(_) => 0,
        Part::Axis(Axis::X) => 1,
        Part::Axis(Axis::Z) => 2,
        Part::Axis(Axis::C) => 3,
    }
}

/// The highest sub-index of a number with axes.
fn highest(no: u16) -> u8 {
    let of_number = Entry::all().iter().filter(|entry| entry.no == no);
    of_number.map(sub_of).max().unwrap_or(0)
}
