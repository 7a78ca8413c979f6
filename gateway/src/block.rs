//! What a block of inputs and outputs on the bus (CiA 401) has to be set to, as the set of the board says it [D424].
//!
//! It must not know how the objects are read or written.

use leadscrew_core::bus::{CobId, Mapped, NodeId, Object, Service};
use leadscrew_core::params::Params;

use crate::params::drives::{Kind, NO_REMOTE};

/// How many bytes of inputs it has.
pub const INPUTS: Object = Object::new(0x6000, 0);
/// How many bytes of outputs it has.
pub const OUTPUTS: Object = Object::new(0x6200, 0);
/// Bytes of inputs, and of outputs, that the board uses.
pub const BYTES: u8 = 2;
/// It has a heartbeat so often, and says its inputs so often, in milliseconds.
const EVERY_MS: i64 = 100;
/// What is carried on change.
const ON_CHANGE: i64 = 255;
/// A byte of a PDO that nothing is in.
const DUMMY: Mapped = Mapped::new(0x0005, 0, 8);

/// What the board needs, in the order in which it is written.
pub fn wanted(
    params: &Params,
    board: NodeId,
    node: NodeId,
    inputs: u8,
    outputs: u8,
) -> Vec<(Object, Kind, i64)> {
    let id = |service| i64::from(CobId::of(service, node).get());
    let of = |index, sub, kind, value| (Object::new(index, sub), kind, value);
    let watched = i64::from(board.get()) << 16 | i64::from(params.block_watch_ms());
    let mut all = vec![
        of(0x1017, 0, Kind::U16, EVERY_MS),
        of(0x1016, 1, Kind::U32, watched),
        of(0x1800, 2, Kind::U8, ON_CHANGE),
        of(0x1800, 5, Kind::U16, EVERY_MS),
        of(0x6005, 0, Kind::U8, 1),
    ];
    let byte = |index: u16, at: u8, has: u8| match at <= has {
        true => Mapped::new(index, at, 8),
        false => DUMMY,
    };
    let mut map = |mapping: u16, communication: u16, entries: Vec<Mapped>, service| {
        all.push(of(mapping, 0, Kind::U8, entries.len() as i64));
        for (sub, entry) in (1..).zip(&entries) {
            all.push(of(mapping, sub, Kind::U32, entry.raw().into()));
        }
        all.push(of(communication, 1, Kind::U32, id(service)));
    };
    let told = (1..=inputs).map(|at| byte(0x6000, at, inputs)).collect();
    map(0x1A00, 0x1800, told, Service::Tpdo1);
    if outputs == 0 {
        return all;
    }
    let taken = (1..=BYTES).map(|at| byte(0x6200, at, outputs)).collect();
    map(0x1600, 0x1400, taken, Service::Rpdo1);
    all.push(of(0x1400, 2, Kind::U8, ON_CHANGE));
    let safe = params.block_safe_outputs().to_le_bytes();
    for (at, safe) in (1..=outputs).zip(safe) {
        all.push(of(0x6206, at, Kind::U8, 0xFF));
        all.push(of(0x6207, at, Kind::U8, safe.into()));
    }
    all
}

/// True where an object is what it has to be: the block's answer to remote requests is its own.
pub const fn is_as_wanted(object: Object, found: i64, wanted: i64) -> bool {
    match (object.index, object.sub) {
        (0x1400 | 0x1800, 1) => (found ^ wanted) & !(NO_REMOTE as i64) == 0,
        (0x1400 | 0x1800, 2) => found >= ON_CHANGE - 1,
        _ => found == wanted,
    }
}
