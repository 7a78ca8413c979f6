//! The objects of a board that are no parameters, in one list.

use super::item::{Access, Initial, Item, Kind, Name};
use crate::board::station::inbox::PROGRAM_BYTES;
use crate::bus::{
    BoardCommand, BoardPlace, BoardSpindle, BoardStatus, Mapped, NodeId, Object, PdoCommunication,
    Service, SyncProducer,
};
use crate::link::{BATCH_BYTES, VERSION};
use crate::params::TABLE_KEY;
use crate::signals::Signals;

use Access::{Both, Const, Read, Write};
use Kind::{Domain, I16, I32, Text, U8, U16, U32, U64};

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

/// What 1010h:01 reads as: the device stores by itself.
const STORES_ITSELF: u32 = 2;

/// What 1005h reads as: bit 30 says that the board gives the beat.
pub const SENDS_SYNC: u32 = 0x4000_0080;

/// What 1011h:01 reads as: the device restores its own set.
const RESTORES: u32 = 1;

/// A record or array of the table: index, name, and whether its sub-indices are alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Index.
    pub index: u16,
    /// What it is, in English.
    pub name: &'static str,
    /// All sub-indices but 0 are alike: an ARRAY, else a RECORD.
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

/// The objects that have sub-indices.
pub static GROUPS: &[Group] = &[
    array(0x1003, "Error history"),
    array(0x1010, "Store parameters"),
    array(0x1011, "Restore default parameters"),
    array(0x1016, "Consumer heartbeat time"),
    group(0x1018, "Identity"),
    group(0x1020, "Identity of the parameter set"),
    group(0x1200, "SDO server"),
    group(0x1400, "RPDO1 communication"),
    group(0x1600, "RPDO1 mapping"),
    group(0x1800, "TPDO1 communication"),
    group(0x1801, "TPDO2 communication"),
    group(0x1802, "TPDO3 communication"),
    group(0x1803, "TPDO4 communication"),
    group(0x1A00, "TPDO1 mapping"),
    group(0x1A01, "TPDO2 mapping"),
    group(0x1A02, "TPDO3 mapping"),
    group(0x1A03, "TPDO4 mapping"),
    group(0x5000, "Command"),
    group(0x5001, "Status"),
    group(0x5010, "Parameter set"),
    group(0x5020, "Program"),
    group(0x5030, "Tap journal"),
    group(0x5040, "Event log"),
];

/// A line of the list: what a board needs of it, and its name.
struct Line {
    row: Row,
    name: &'static str,
}

/// What a board needs of an object that is no parameter.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub object: Object,
    pub(super) kind: Kind,
    pub(super) access: Access,
    mappable: bool,
    value: Value,
}

/// The value after power-up, or the range: no object has both. In bytes, so that a row has no gaps.
#[derive(Clone, Copy, Debug)]
enum Value {
    Unknown,
    Number([u8; 4]),
    OfNode([u8; 4]),
    DeviceName,
    SoftwareVersion,
    /// The version of the link: the one number that is longer.
    Link,
    Within([u8; 2], [u8; 2]),
}

impl Row {
    /// The item; `place` is that of the row.
    pub fn item(&self, place: usize) -> Item {
        let initial = match self.value {
            Value::Unknown | Value::Within(..) => Initial::Unknown,
            Value::Number(number) => Initial::Number(u32::from_le_bytes(number).into()),
            Value::OfNode(base) => Initial::OfNode(u32::from_le_bytes(base)),
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

    /// The numbers it takes; `None`: all that the kind has.
    pub const fn range(&self) -> Option<(i64, i64)> {
        match self.value {
            Value::Within(low, high) => Some((
                u16::from_le_bytes(low) as i64,
                u16::from_le_bytes(high) as i64,
            )),
            _ => None,
        }
    }

    /// The text it is; empty for a number.
    pub const fn text(&self) -> &'static str {
        match self.value {
            Value::DeviceName => "Leadscrew board",
            Value::SoftwareVersion => env!("CARGO_PKG_VERSION"),
            _ => "",
        }
    }

    /// The number it is on a node, where nothing else knows it; 0: unknown.
    pub const fn number(&self, node: NodeId) -> i64 {
        match self.value {
            Value::Number(number) => u32::from_le_bytes(number) as i64,
            Value::OfNode(base) => {
                u32::from_le_bytes(base).saturating_add(node.get() as u32) as i64
            }
            Value::Link => VERSION.raw() as i64,
            _ => 0,
        }
    }
}

const fn item(index: u16, sub: u8, name: &'static str, kind: Kind, access: Access) -> Line {
    let row = Row {
        object: Object::new(index, sub),
        kind,
        access,
        mappable: false,
        value: Value::Unknown,
    };
    Line { row, name }
}

const fn number(value: u32) -> Value {
    Value::Number(value.to_le_bytes())
}

const fn with(line: Line, value: Value) -> Line {
    Line {
        row: Row { value, ..line.row },
        name: line.name,
    }
}

const fn fixed(index: u16, sub: u8, name: &'static str, kind: Kind, value: u32) -> Line {
    with(item(index, sub, name, kind, Const), number(value))
}

const fn of_node(index: u16, sub: u8, name: &'static str, access: Access, base: u32) -> Line {
    let value = Value::OfNode(base.to_le_bytes());
    with(item(index, sub, name, U32, access), value)
}

const fn mapped(index: u16, sub: u8, name: &'static str, kind: Kind, access: Access) -> Line {
    let line = item(index, sub, name, kind, access);
    Line {
        row: Row {
            mappable: true,
            ..line.row
        },
        name: line.name,
    }
}

const fn within(line: Line, low: u16, high: u16) -> Line {
    with(line, Value::Within(low.to_le_bytes(), high.to_le_bytes()))
}

const fn map(index: u16, sub: u8, mapping: &[Mapped]) -> Line {
    let mut rest = mapping;
    let mut at = 1;
    while let [first, behind @ ..] = rest {
        if at == sub {
            return fixed(index, sub, "mapped object", U32, first.raw());
        }
        at = at.saturating_add(1);
        rest = behind;
    }
    // Not reached, and a test says so: 0 is no object.
    fixed(index, sub, "mapped object", U32, 0)
}

const fn cob_id(index: u16, service: Service) -> Line {
    let rtr = match service {
        Service::Rpdo1 => 0,
        _ => 1 << 30,
    };
    of_node(index, 1, "COB-ID", Both, rtr | service as u32)
}

const fn transmission(index: u16) -> Line {
    let line = item(index, 2, "transmission type", U8, Both);
    with(line, number(PdoCommunication::EVENT as u32))
}

const fn event_timer(index: u16) -> Line {
    within(item(index, 5, "event timer", U16, Both), 0, 0xFFFF)
}

const fn text(index: u16, name: &'static str, value: Value) -> Line {
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

/// The names of the [rows](ROWS). A board does not ask for them: its image is without.
pub static NAMES: [&str; LINES.len()] = {
    let mut names = [""; LINES.len()];
    let (mut places, mut lines): (&mut [&str], _) = (&mut names, LINES);
    while let ([place, more @ ..], [line, rest @ ..]) = (places, lines) {
        *place = line.name;
        (places, lines) = (more, rest);
    }
    names
};

/// The list, by index and sub-index. Everything else is made of it before the program runs.
const LINES: &[Line] = &[
    fixed(0x1000, 0, "Device type", U32, 0),
    mapped(0x1001, 0, "Error register", U8, Read),
    within(item(0x1003, 0, "number of errors", U8, Both), 0, 0),
    item(0x1003, 1, "error", U32, Read),
    item(0x1003, 2, "error", U32, Read),
    item(0x1003, 3, "error", U32, Read),
    item(0x1003, 4, "error", U32, Read),
    item(0x1003, 5, "error", U32, Read),
    item(0x1003, 6, "error", U32, Read),
    item(0x1003, 7, "error", U32, Read),
    item(0x1003, 8, "error", U32, Read),
    with(
        item(0x1005, 0, "COB-ID of SYNC", U32, Read),
        number(SENDS_SYNC),
    ),
    item(0x1006, 0, "Communication cycle period", U32, Read),
    text(0x1008, "Device name", Value::DeviceName),
    text(0x100A, "Software version", Value::SoftwareVersion),
    with(
        item(0x1010, 1, "store all parameters", U32, Both),
        number(STORES_ITSELF),
    ),
    with(
        item(0x1011, 1, "restore all parameters", U32, Both),
        number(RESTORES),
    ),
    of_node(0x1014, 0, "COB-ID of EMCY", Const, 0x80),
    item(0x1016, 1, "gateway", U32, Both),
    item(0x1017, 0, "Producer heartbeat time", U16, Both),
    fixed(0x1018, 1, "vendor", U32, 0),
    fixed(0x1018, 2, "product code", U32, PRODUCT),
    fixed(0x1018, 3, "revision", U32, (VERSION.number as u32) << 16),
    item(0x1018, 4, "serial number", U32, Read),
    fixed(
        0x1019,
        0,
        "Synchronous counter overflow",
        U8,
        SyncProducer::LAST as u32,
    ),
    item(0x1020, 1, "checksum of the set", U32, Read),
    fixed(0x1020, 2, "key of the table", U32, TABLE_KEY),
    of_node(0x1200, 1, "COB-ID client to server", Const, 0x600),
    of_node(0x1200, 2, "COB-ID server to client", Const, 0x580),
    cob_id(0x1400, Service::Rpdo1),
    transmission(0x1400),
    map(0x1600, 1, &BoardCommand::MAPPING),
    map(0x1600, 2, &BoardCommand::MAPPING),
    map(0x1600, 3, &BoardCommand::MAPPING),
    map(0x1600, 4, &BoardCommand::MAPPING),
    map(0x1600, 5, &BoardCommand::MAPPING),
    map(0x1600, 6, &BoardCommand::MAPPING),
    cob_id(0x1800, Service::Tpdo1),
    transmission(0x1800),
    event_timer(0x1800),
    cob_id(0x1801, Service::Tpdo2),
    transmission(0x1801),
    event_timer(0x1801),
    cob_id(0x1802, Service::Tpdo3),
    transmission(0x1802),
    event_timer(0x1802),
    // The frame with all setpoints, not used unless the parameters say so.
    of_node(0x1803, 1, "COB-ID", Read, 0xC000_0480),
    fixed(0x1803, 2, "transmission type", U8, 1),
    map(0x1A00, 1, &BoardStatus::MAPPING),
    map(0x1A00, 2, &BoardStatus::MAPPING),
    map(0x1A00, 3, &BoardStatus::MAPPING),
    map(0x1A00, 4, &BoardStatus::MAPPING),
    map(0x1A00, 5, &BoardStatus::MAPPING),
    map(0x1A00, 6, &BoardStatus::MAPPING),
    map(0x1A01, 1, &BoardPlace::MAPPING),
    map(0x1A01, 2, &BoardPlace::MAPPING),
    map(0x1A02, 1, &BoardSpindle::MAPPING),
    map(0x1A02, 2, &BoardSpindle::MAPPING),
    map(0x1A02, 3, &BoardSpindle::MAPPING),
    // What it carries are objects of the drives, and none of the board's.
    fixed(0x1A03, 0, "mapped objects", U8, 0),
    mapped(0x5000, 1, "count", U8, Both),
    within(mapped(0x5000, 2, "order", U8, Both), 0, 5),
    mapped(0x5000, 3, "switches", U8, Both),
    mapped(0x5000, 4, "feed override", U8, Both),
    mapped(0x5000, 5, "rapid override", U8, Both),
    mapped(0x5000, 6, "spindle override", U8, Both),
    item(0x5001, 1, "record", Domain, Read),
    mapped(0x5001, 2, "state", U8, Read),
    mapped(0x5001, 3, "flags", U8, Read),
    mapped(0x5001, 4, "alarm", U16, Read),
    mapped(0x5001, 5, "count of the last order", U8, Read),
    mapped(0x5001, 6, "late setpoints", U8, Read),
    mapped(0x5001, 7, "program credit", U16, Read),
    mapped(0x5001, 8, "line", U32, Read),
    mapped(0x5001, 9, "move", U32, Read),
    mapped(0x5001, 10, "spindle angle", U16, Read),
    mapped(0x5001, 11, "spindle speed", I32, Read),
    mapped(0x5001, 12, "synchronism error", I16, Read),
    item(0x5010, 1, "image", Domain, Both),
    item(0x5010, 2, "state of the last change", U8, Read),
    item(0x5010, 3, "checksum of the stored set", U32, Read),
    item(0x5010, 4, "checksum of the last good set before", U32, Read),
    within(item(0x5010, 5, "command", U8, Write), 1, 1),
    item(0x5010, 6, "password", U32, Write),
    item(0x5010, 7, "why the last change was refused", U16, Read),
    item(0x5010, 8, "why, with its figures", Domain, Read),
    item(0x5010, 9, "image to be staged", Domain, Write),
    item(0x5010, 10, "what the staged set would change", Domain, Read),
    item(0x5010, 11, "checksum: commit the staged set", U32, Write),
    item(0x5020, 1, "batch of calls", Domain, Write),
    with(
        item(0x5020, 2, "version of the link", U64, Const),
        Value::Link,
    ),
    item(0x5020, 3, "program", U32, Read),
    item(0x5020, 4, "next call", U32, Read),
    item(0x5020, 5, "credit", U16, Read),
    fixed(0x5020, 6, "longest batch", U16, BATCH_BYTES as u32),
    item(0x5030, 1, "record", Domain, Read),
    item(0x5030, 2, "discard", U32, Write),
    item(0x5040, 1, "newest", U32, Read),
    item(0x5040, 2, "read from", U32, Both),
    item(0x5040, 3, "entries", Domain, Read),
    item(
        0x5041,
        0,
        "Certificates of the run and of its threads",
        Domain,
        Read,
    ),
    item(0x5042, 0, "Certificates of threads taken", U32, Both),
    within(
        item(0x5060, 0, "Signals", U16, Both),
        0,
        Signals::BITS | Signals::MIRRORED,
    ),
];

const _: () = assert!(PROGRAM_BYTES <= u16::MAX as usize, "the credit has 16 bits");
