//! The parts of a row in the list of objects, and the list in the form that a board and an EDS need.
//!
//! Knows nothing of reads and writes: they stand with each row, in `objects`.

use super::item::{Access, Initial, Item, Kind, Name};
use super::objects::LINES;
use crate::bus::{Mapped, NodeId, Object, PdoCommunication, Service};
use crate::link::VERSION;

use Access::{Both, Const};
use Kind::{Domain, Text, U8, U16, U32};

/// Entries of 1003h.
pub const HISTORY: u8 = 8;

/// Product code in 1018h: `LSCW`.
pub const PRODUCT: u32 = 0x4C53_4357;

/// Written to 5030h:02, it drops the tap journal's record: the letters `drop`, little-endian.
pub const DROP: u32 = u32::from_le_bytes(*b"drop");

/// Written to 1010h:01: the letters `save`, little-endian.
pub const SAVE: u32 = u32::from_le_bytes(*b"save");

/// Written to 1011h:01: the letters `load`, little-endian.
pub const LOAD: u32 = u32::from_le_bytes(*b"load");

/// Value of 1005h: bit 30 says that the board sends SYNC.
pub const SENDS_SYNC: u32 = 0x4000_0080;

/// A record or array of the table: index, name, and whether its sub-indices are alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Index.
    pub index: u16,
    /// Its English name.
    pub name: &'static str,
    /// All sub-indices but 0 are alike: an ARRAY. Otherwise a RECORD.
    pub array: bool,
}

const fn group(index: u16, name: &'static str) -> Group {
    Group {
        index,
        name,
        array: false,
    }
}

const fn array(index: u16, name: &'static str) -> Group {
    Group {
        index,
        name,
        array: true,
    }
}

/// The objects with sub-indices.
pub static GROUPS: &[Group] = &[
    array(0x1003, "Error history"),
    array(0x1010, "Store parameters"),
    array(0x1011, "Restore default parameters"),
    array(0x1016, "Consumer heartbeat time"),
    group(0x1018, "Identity"),
    group(0x1020, "Identity of the parameter set"),
    group(0x1200, "SDO server"),
    group(0x1400, "RPDO1 communication"),
    group(0x1401, "RPDO2 communication"),
    group(0x1402, "RPDO3 communication"),
    group(0x1403, "RPDO4 communication"),
    group(0x1600, "RPDO1 mapping"),
    group(0x1601, "RPDO2 mapping"),
    group(0x1602, "RPDO3 mapping"),
    group(0x1603, "RPDO4 mapping"),
    group(0x1800, "TPDO1 communication"),
    group(0x1801, "TPDO2 communication"),
    group(0x1802, "TPDO3 communication"),
    group(0x1803, "TPDO4 communication"),
    group(0x1804, "TPDO5 communication"),
    group(0x1A00, "TPDO1 mapping"),
    group(0x1A01, "TPDO2 mapping"),
    group(0x1A02, "TPDO3 mapping"),
    group(0x1A03, "TPDO4 mapping"),
    group(0x1A04, "TPDO5 mapping"),
    group(0x5000, "Command"),
    group(0x5001, "Status"),
    group(0x5002, "Operation by hand"),
    group(0x5010, "Parameter set"),
    group(0x5011, "Offsets and tools"),
    group(0x5020, "Program"),
    group(0x5030, "Tap journal"),
    group(0x5040, "Event log"),
];

/// A line of the list: the row for a board, and the name.
pub(super) struct Line {
    row: Row,
    name: &'static str,
}

impl Line {
    /// Index and sub-index.
    pub(super) const fn object(&self) -> Object {
        self.row.object
    }

    /// True where the row has every clause that its access promises: a clause to get a number, to set a number, or for the
    /// bytes of a domain.
    pub(super) const fn is_whole(&self, get: bool, set: bool, bytes: bool) -> bool {
        let read = matches!(self.row.access, Access::Read | Access::Both);
        let written = matches!(self.row.access, Access::Write | Access::Both);
        // The PDOs read and write their own communication objects.
        if let 0x1400..=0x1802 | 0x1804 = self.row.object.index {
            return !get && !set && !bytes;
        }
        match self.row.kind {
            // A domain is written in pieces. A domain that is read and written is read in pieces too.
            Domain => bytes == (read && !written) && !get && !set,
            _ => get == read && set == written && !bytes,
        }
    }
}

/// Name and version are one piece of the image, so that a file of it tells its version without a board.
const NAMED: &str = concat!("Leadscrew board ", env!("CARGO_PKG_VERSION"));
const DEVICE_NAME: &str = NAMED.split_at("Leadscrew board".len()).0;
const SOFTWARE_VERSION: &str = NAMED.split_at("Leadscrew board ".len()).1;

/// The data of an object that a board needs. Parameters have their own table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub object: Object,
    pub(super) kind: Kind,
    pub(super) access: Access,
    mappable: bool,
    value: Value,
}

/// The value after power-up, or the range: no object has both.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Unknown,
    Number(u32),
    OfNode(u32),
    DeviceName,
    SoftwareVersion,
    /// The version of the link: the only number with 64 bits.
    Link,
    Within(u16, u16),
}

impl Row {
    /// The item; `place` is that of the row.
    pub fn item(&self, place: usize) -> Item {
        let initial = match self.value {
            Value::Unknown | Value::Within(..) => Initial::Unknown,
            Value::Number(number) => Initial::Number(number.into()),
            Value::OfNode(base) => Initial::OfNode(base),
            Value::DeviceName | Value::SoftwareVersion => Initial::Text(self.text()),
            Value::Link => Initial::Number(VERSION.raw() as i64),
        };
        Item {
            object: self.object,
            name: Name::Line(place),
            kind: self.kind,
            access: self.access,
            range: self.range(),
            initial,
            mappable: self.mappable,
            entry: None,
        }
    }

    /// The range; `None`: all numbers of the data type.
    pub const fn range(&self) -> Option<(i64, i64)> {
        match self.value {
            Value::Within(low, high) => Some((low as i64, high as i64)),
            _ => None,
        }
    }

    /// The text; empty for a number.
    pub const fn text(&self) -> &'static str {
        match self.value {
            Value::DeviceName => DEVICE_NAME,
            Value::SoftwareVersion => SOFTWARE_VERSION,
            _ => "",
        }
    }

    /// The number on a node, if it is known from the row alone; otherwise 0.
    pub const fn number(&self, node: NodeId) -> i64 {
        match self.value {
            Value::Number(number) => number as i64,
            Value::OfNode(base) => base.saturating_add(node.get() as u32) as i64,
            Value::Link => VERSION.raw() as i64,
            _ => 0,
        }
    }
}

pub(super) const fn item(
    index: u16,
    sub: u8,
    name: &'static str,
    kind: Kind,
    access: Access,
) -> Line {
    let row = Row {
        object: Object::new(index, sub),
        kind,
        access,
        mappable: false,
        value: Value::Unknown,
    };
    Line { row, name }
}

pub(super) const fn with(line: Line, value: Value) -> Line {
    Line {
        row: Row { value, ..line.row },
        name: line.name,
    }
}

pub(super) const fn fixed(index: u16, sub: u8, name: &'static str, kind: Kind, value: u32) -> Line {
    with(item(index, sub, name, kind, Const), Value::Number(value))
}

pub(super) const fn of_node(
    index: u16,
    sub: u8,
    name: &'static str,
    access: Access,
    base: u32,
) -> Line {
    with(item(index, sub, name, U32, access), Value::OfNode(base))
}

pub(super) const fn mapped(
    index: u16,
    sub: u8,
    name: &'static str,
    kind: Kind,
    access: Access,
) -> Line {
    let line = item(index, sub, name, kind, access);
    Line {
        row: Row {
            mappable: true,
            ..line.row
        },
        name: line.name,
    }
}

pub(super) const fn within(line: Line, low: u16, high: u16) -> Line {
    with(line, Value::Within(low, high))
}

pub(super) const fn map(index: u16, sub: u8, mapping: &[Mapped]) -> Line {
    let mut rest = mapping;
    let mut at = 1;
    while let [first, behind @ ..] = rest {
        if at == sub {
            return fixed(index, sub, "mapped object", U32, first.raw());
        }
        at = at.saturating_add(1);
        rest = behind;
    }
    // Not reached, as a test shows: 0 is no object.
    fixed(index, sub, "mapped object", U32, 0)
}

pub(super) const fn cob_id(index: u16, service: Service) -> Line {
    let rtr = match service {
        Service::Rpdo1 | Service::Rpdo2 | Service::Rpdo3 | Service::Rpdo4 => 0,
        _ => 1 << 30,
    };
    of_node(index, 1, "COB-ID", Both, rtr | service as u32)
}

/// A PDO that is sent with an identifier outside the default set.
pub(super) const fn own_id(index: u16, base: u16) -> Line {
    of_node(index, 1, "COB-ID", Both, 1 << 30 | base as u32)
}

pub(super) const fn transmission(index: u16) -> Line {
    let line = item(index, 2, "transmission type", U8, Both);
    with(line, Value::Number(PdoCommunication::EVENT as u32))
}

pub(super) const fn event_timer(index: u16) -> Line {
    within(item(index, 5, "event timer", U16, Both), 0, 0xFFFF)
}

pub(super) const fn text(index: u16, name: &'static str, value: Value) -> Line {
    with(item(index, 0, name, Text, Const), value)
}

/// The rows, by index and sub-index.
pub static ROWS: [Row; LINES.len()] = {
    let mut rows = [item(0, 0, "", U8, Const).row; LINES.len()];
    let (mut places, mut lines): (&mut [Row], _) = (&mut rows, LINES);
    while let ([place, more @ ..], [line, rest @ ..]) = (places, lines) {
        *place = line.row;
        (places, lines) = (more, rest);
    }
    rows
};

/// The names of the [rows](ROWS). A board does not need them, and its image has none.
pub static NAMES: [&str; LINES.len()] = {
    let mut names = [""; LINES.len()];
    let (mut places, mut lines): (&mut [&str], _) = (&mut names, LINES);
    while let ([place, more @ ..], [line, rest @ ..]) = (places, lines) {
        *place = line.name;
        (places, lines) = (more, rest);
    }
    names
};
