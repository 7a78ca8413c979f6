//! The objects of a board that are no parameters: one row for each.
//!
//! A row is the whole definition of an object: its constant, index and sub-index, name, kind, access and value after
//! power-up, and what a read (`get` for a number, `bytes` for a domain) and a write (`set`) do. The dictionary, the EDS,
//! the board's answers and the gateway's constants come from here. A row without a clause that its access promises
//! does not compile.
//!
//! Exceptions: the PDOs themselves read and write their communication objects (1400h–1403h, 1800h–1802h, 1804h), and
//! `served` reads and writes the image of the parameter set and a batch of calls piece by piece.

use super::item::{Access, Kind};
use super::program_buffer::PROGRAM_BYTES;
use super::table::{
    Line, PRODUCT, SENDS_SYNC, Value, cob_id, event_timer, fixed, item, map, mapped, of_node,
    own_id, text, transmission, with, within,
};
use super::values::ObjectValues;
use crate::alarm::Alarm;
use crate::bus::{
    Abort, Beat, BoardBeat, BoardCommand, BoardPlace, BoardSpindle, BoardStatus, HeartbeatWatch,
    Object, Order, Service, SyncProducer,
};
use crate::link::{BATCH_BYTES, VERSION, identity};
use crate::params::{Params, TABLE_KEY};
use crate::signals::Signals;
use crate::units::Axis;

use Access::{Both, Const, Read, Write};
use Kind::{Domain, I16, I32, U8, U16, U32, U64};

/// What 1010h:01 reads as: the device stores by itself.
const STORES_ITSELF: u32 = 2;

/// What 1011h:01 reads as: the device restores its own set.
const RESTORES: u32 = 1;

/// What 1803h:01 reads as, on node 0, while the frame with all setpoints is not used.
const SETPOINTS_UNUSED: u32 = 0xC000_0480;

/// True where a clause is there.
macro_rules! there {
    () => {
        false
    };
    ($clause:expr) => {
        true
    };
}

macro_rules! objects {
    ($(
        $name:ident = $line:expr
        $(, get |$get_shelf:tt, $get_params:tt| $get:expr)?
        $(, set |$set_shelf:tt, $value:tt, $set_params:tt| $set:expr)?
        $(, bytes |$bytes_shelf:tt, $bytes_params:tt| $bytes:expr)?
    ;)*) => {
        $(
            #[doc = concat!("`", stringify!($line), "`")]
            pub const $name: Object = $line.object();

            const _: () = assert!(
                $line.is_whole(there!($($get)?), there!($($set)?), there!($($bytes)?)),
                "what the access of an object promises has no clause"
            );
        )*

        /// Every row, by index and sub-index.
        pub(super) const LINES: &[Line] = &[$($line),*];

        /// The number that an object is now; `None` for one that only its row knows.
        pub(super) fn get(values: &ObjectValues, object: Object, params: &Params) -> Result<Option<i64>, Abort> {
            Ok(Some(match object {
                $($(
                    $name => {
                        let ($get_shelf, $get_params) = (values, params);
                        i64::from($get)
                    }
                )?)*
                _ => return Ok(None),
            }))
        }

        /// Puts a number into effect. Its kind and range are right.
        pub(super) fn set(values: &mut ObjectValues, object: Object, value: u32, params: &Params) -> Result<(), Abort> {
            match object {
                $($(
                    $name => {
                        let ($set_shelf, $value, $set_params) = (values, value, params);
                        $set
                    }
                )?)*
                _ => Err(Abort::ReadOnly),
            }
        }

        /// Puts what a domain holds into the buffer; how many bytes that are comes back.
        pub(super) fn bytes(values: &mut ObjectValues, object: Object, params: &Params) -> Result<usize, Abort> {
            match object {
                $($(
                    $name => {
                        let ($bytes_shelf, $bytes_params) = (values, params);
                        $bytes
                    }
                )?)*
                _ => Err(Abort::NoData),
            }
        }
    };
}

objects! {
    DEVICE_TYPE = fixed(0x1000, 0, "Device type", U32, 0);
    ERROR_REGISTER = mapped(0x1001, 0, "Error register", U8, Read),
        get |values, _| values.emcy.register();
    ERROR_COUNT = within(item(0x1003, 0, "number of errors", U8, Both), 0, 0),
        get |values, _| values.emcy.history(0)?,
        set |values, value, _| values.emcy.write_history(0, value);
    ERROR_1 = item(0x1003, 1, "error", U32, Read),
        get |values, _| values.emcy.history(1)?;
    ERROR_2 = item(0x1003, 2, "error", U32, Read),
        get |values, _| values.emcy.history(2)?;
    ERROR_3 = item(0x1003, 3, "error", U32, Read),
        get |values, _| values.emcy.history(3)?;
    ERROR_4 = item(0x1003, 4, "error", U32, Read),
        get |values, _| values.emcy.history(4)?;
    ERROR_5 = item(0x1003, 5, "error", U32, Read),
        get |values, _| values.emcy.history(5)?;
    ERROR_6 = item(0x1003, 6, "error", U32, Read),
        get |values, _| values.emcy.history(6)?;
    ERROR_7 = item(0x1003, 7, "error", U32, Read),
        get |values, _| values.emcy.history(7)?;
    ERROR_8 = item(0x1003, 8, "error", U32, Read),
        get |values, _| values.emcy.history(8)?;
    SYNC_COB_ID = with(item(0x1005, 0, "COB-ID of SYNC", U32, Read), Value::Number(SENDS_SYNC)),
        get |_, _| SENDS_SYNC;
    CYCLE_PERIOD = item(0x1006, 0, "Communication cycle period", U32, Read),
        get |_, params| params.tick_us();
    DEVICE_NAME = text(0x1008, "Device name", Value::DeviceName);
    SOFTWARE_VERSION = text(0x100A, "Software version", Value::SoftwareVersion);
    STORE = with(item(0x1010, 1, "store all parameters", U32, Both), Value::Number(STORES_ITSELF)),
        get |_, _| STORES_ITSELF,
        set |values, value, params| values.save(value, params);
    RESTORE = with(item(0x1011, 1, "restore all parameters", U32, Both), Value::Number(RESTORES)),
        get |_, _| RESTORES,
        set |values, value, params| values.restore(value, params);
    EMCY_COB_ID = of_node(0x1014, 0, "COB-ID of EMCY", Const, 0x80);
    GATEWAY_WATCH = item(0x1016, 1, "gateway", U32, Both),
        get |values, _| values.watch.get(0).map_or(0, HeartbeatWatch::raw),
        set |values, value, params| values.watch_gateway(value, params);
    HEARTBEAT = item(0x1017, 0, "Producer heartbeat time", U16, Both),
        get |values, _| values.heartbeat.ms(),
        set |values, value, params| values.beat_every(value, params);
    VENDOR = fixed(0x1018, 1, "vendor", U32, 0);
    PRODUCT_CODE = fixed(0x1018, 2, "product code", U32, PRODUCT);
    REVISION = fixed(0x1018, 3, "revision", U32, (VERSION.number as u32) << 16);
    SERIAL_NUMBER = item(0x1018, 4, "serial number", U32, Read),
        get |values, _| values.serial;
    SYNC_OVERFLOW = fixed(0x1019, 0, "Synchronous counter overflow", U8, SyncProducer::LAST as u32);
    SET_CHECKSUM = item(0x1020, 1, "checksum of the set", U32, Read),
        get |_, params| identity(params);
    TABLE_CHECKSUM = fixed(0x1020, 2, "key of the table", U32, TABLE_KEY);
    SDO_REQUEST = of_node(0x1200, 1, "COB-ID client to server", Const, 0x600);
    SDO_ANSWER = of_node(0x1200, 2, "COB-ID server to client", Const, 0x580);
    RPDO1_COB_ID = cob_id(0x1400, Service::Rpdo1);
    RPDO1_TRANSMISSION = transmission(0x1400);
    RPDO2_COB_ID = cob_id(0x1401, Service::Rpdo2);
    RPDO2_TRANSMISSION = transmission(0x1401);
    RPDO3_COB_ID = cob_id(0x1402, Service::Rpdo3);
    RPDO3_TRANSMISSION = transmission(0x1402);
    RPDO4_COB_ID = cob_id(0x1403, Service::Rpdo4);
    RPDO4_TRANSMISSION = transmission(0x1403);
    RPDO1_MAPPED_1 = map(0x1600, 1, &BoardCommand::MAPPING);
    RPDO1_MAPPED_2 = map(0x1600, 2, &BoardCommand::MAPPING);
    RPDO1_MAPPED_3 = map(0x1600, 3, &BoardCommand::MAPPING);
    RPDO1_MAPPED_4 = map(0x1600, 4, &BoardCommand::MAPPING);
    RPDO1_MAPPED_5 = map(0x1600, 5, &BoardCommand::MAPPING);
    RPDO1_MAPPED_6 = map(0x1600, 6, &BoardCommand::MAPPING);
    RPDO1_MAPPED_7 = map(0x1600, 7, &BoardCommand::MAPPING);
    // A press, a step and a wheel are no objects: alone, none of their bytes means anything.
    RPDO2_COUNT = fixed(0x1601, 0, "mapped objects", U8, 0);
    RPDO3_COUNT = fixed(0x1602, 0, "mapped objects", U8, 0);
    RPDO4_COUNT = fixed(0x1603, 0, "mapped objects", U8, 0);
    TPDO1_COB_ID = cob_id(0x1800, Service::Tpdo1);
    TPDO1_TRANSMISSION = transmission(0x1800);
    TPDO1_EVENT_TIMER = event_timer(0x1800);
    TPDO2_COB_ID = cob_id(0x1801, Service::Tpdo2);
    TPDO2_TRANSMISSION = transmission(0x1801);
    TPDO2_EVENT_TIMER = event_timer(0x1801);
    TPDO3_COB_ID = cob_id(0x1802, Service::Tpdo3);
    TPDO3_TRANSMISSION = transmission(0x1802);
    TPDO3_EVENT_TIMER = event_timer(0x1802);
    // The frame with all setpoints, not used unless the parameters say so.
    TPDO4_COB_ID = of_node(0x1803, 1, "COB-ID", Read, SETPOINTS_UNUSED),
        get |values, params| values.setpoints_cob_id(SETPOINTS_UNUSED, params);
    TPDO4_TRANSMISSION = fixed(0x1803, 2, "transmission type", U8, 1);
    TPDO5_COB_ID = own_id(0x1804, BoardBeat::BASE);
    TPDO5_TRANSMISSION = transmission(0x1804);
    TPDO5_EVENT_TIMER = event_timer(0x1804);
    TPDO1_MAPPED_1 = map(0x1A00, 1, &BoardStatus::MAPPING);
    TPDO1_MAPPED_2 = map(0x1A00, 2, &BoardStatus::MAPPING);
    TPDO1_MAPPED_3 = map(0x1A00, 3, &BoardStatus::MAPPING);
    TPDO1_MAPPED_4 = map(0x1A00, 4, &BoardStatus::MAPPING);
    TPDO1_MAPPED_5 = map(0x1A00, 5, &BoardStatus::MAPPING);
    TPDO1_MAPPED_6 = map(0x1A00, 6, &BoardStatus::MAPPING);
    TPDO2_MAPPED_1 = map(0x1A01, 1, &BoardPlace::MAPPING);
    TPDO2_MAPPED_2 = map(0x1A01, 2, &BoardPlace::MAPPING);
    TPDO3_MAPPED_1 = map(0x1A02, 1, &BoardSpindle::MAPPING);
    TPDO3_MAPPED_2 = map(0x1A02, 2, &BoardSpindle::MAPPING);
    TPDO3_MAPPED_3 = map(0x1A02, 3, &BoardSpindle::MAPPING);
    // What it carries are objects of the drives, and none of the board's.
    TPDO4_COUNT = fixed(0x1A03, 0, "mapped objects", U8, 0);
    TPDO5_MAPPED_1 = map(0x1A04, 1, &BoardBeat::MAPPING);
    TPDO5_MAPPED_2 = map(0x1A04, 2, &BoardBeat::MAPPING);
    TPDO5_MAPPED_3 = map(0x1A04, 3, &BoardBeat::MAPPING);
    TPDO5_MAPPED_4 = map(0x1A04, 4, &BoardBeat::MAPPING);
    TPDO5_MAPPED_5 = map(0x1A04, 5, &BoardBeat::MAPPING);
    TPDO5_MAPPED_6 = map(0x1A04, 6, &BoardBeat::MAPPING);
    COMMAND_COUNT = mapped(0x5000, 1, "count", U8, Both),
        get |values, _| values.count,
        set |values, value, _| values.put_count(value);
    COMMAND_ORDER = within(mapped(0x5000, 2, "order", U8, Both), 0, Order::LAST as u16),
        get |_, _| 0,
        set |values, value, params| values.order_number(value, params);
    COMMAND_SWITCHES = mapped(0x5000, 3, "switches", U8, Both),
        get |values, _| values.switches_now(),
        set |values, value, _| values.put_setting(3, value);
    FEED_OVERRIDE = mapped(0x5000, 4, "feed override", U8, Both),
        get |values, _| values.snapshot.operator.feed_percent(),
        set |values, value, _| values.put_setting(4, value);
    RAPID_OVERRIDE = mapped(0x5000, 5, "rapid override", U8, Both),
        get |values, _| values.snapshot.operator.rapid_percent(),
        set |values, value, _| values.put_setting(5, value);
    SPINDLE_OVERRIDE = mapped(0x5000, 6, "spindle override", U8, Both),
        get |values, _| values.snapshot.operator.spindle_percent(),
        set |values, value, _| values.put_setting(6, value);
    ORDER_ECHO = mapped(0x5000, 7, "echo", U16, Both),
        get |values, _| values.echo.map_or(0, Beat::ms),
        set |values, value, _| values.put_echo(value);
    STATUS_RECORD = item(0x5001, 1, "record", Domain, Read),
        bytes |values, params| values.status_bytes(params);
    STATE = mapped(0x5001, 2, "state", U8, Read),
        get |values, _| values.fact(2);
    FLAGS = mapped(0x5001, 3, "flags", U8, Read),
        get |values, _| values.fact(3);
    ALARM = mapped(0x5001, 4, "alarm", U16, Read),
        get |values, _| values.fact(4);
    ORDER_COUNT = mapped(0x5001, 5, "count of the last order", U8, Read),
        get |values, _| values.fact(5);
    LATE_SETPOINTS = mapped(0x5001, 6, "late setpoints", U8, Read),
        get |values, _| values.fact(6);
    STATUS_CREDIT = mapped(0x5001, 7, "program credit", U16, Read),
        get |values, _| values.fact(7);
    LINE = mapped(0x5001, 8, "line", U32, Read),
        get |values, _| values.fact(8);
    MOVE = mapped(0x5001, 9, "move", U32, Read),
        get |values, _| values.fact(9);
    SPINDLE_ANGLE = mapped(0x5001, 10, "spindle angle", U16, Read),
        get |values, _| values.fact(10);
    SPINDLE_SPEED = mapped(0x5001, 11, "spindle speed", I32, Read),
        get |values, _| values.fact(11);
    SYNC_ERROR = mapped(0x5001, 12, "synchronism error", I16, Read),
        get |values, _| values.fact(12);
    BEAT = mapped(0x5002, 1, "beat", U16, Read),
        get |values, _| values.beat_fact(1);
    MODE = mapped(0x5002, 2, "mode", U8, Read),
        get |values, _| values.beat_fact(2);
    SESSION = mapped(0x5002, 3, "session that moves by hand", U8, Read),
        get |values, _| values.beat_fact(3);
    PRESS = mapped(0x5002, 4, "last press, step or claim", U8, Read),
        get |values, _| values.beat_fact(4);
    PRESS_STATE = mapped(0x5002, 5, "what became of it", U8, Read),
        get |values, _| values.beat_fact(5);
    REFUSED = mapped(0x5002, 6, "why the last request was refused", U16, Read),
        get |values, _| values.beat_fact(6);
    BY_WHEEL = within(item(0x5002, 7, "the next program follows the handwheel", U8, Both), 0, 1),
        get |values, _| u8::from(values.operating.by_wheel()),
        set |values, value, _| values.put_by_wheel(value);
    TOOL = item(0x5002, 8, "tool in place", U16, Read),
        get |values, _| values.in_place.code();
    IMAGE = item(0x5010, 1, "image", Domain, Both);
    CHANGE_STATE = item(0x5010, 2, "state of the last change", U8, Read),
        get |values, _| values.parameter_store.state() as u8;
    STORED_SET = item(0x5010, 3, "checksum of the stored set", U32, Read),
        get |values, _| values.parameter_store.stored();
    LAST_GOOD_SET = item(0x5010, 4, "checksum of the last good set before", U32, Read),
        get |values, _| values.parameter_store.before();
    SET_COMMAND = within(item(0x5010, 5, "command", U8, Write), 1, 1),
        set |values, _, params| values.recall(params);
    SET_PASSWORD = item(0x5010, 6, "password", U32, Write),
        set |values, value, params| values.password(value, params);
    REFUSAL_NUMBER = item(0x5010, 7, "why the last change was refused", U16, Read),
        get |values, _| values.parameter_store.reason().map_or(0, Alarm::number);
    REFUSAL = item(0x5010, 8, "why, with its figures", Domain, Read),
        bytes |values, _| values.refusal();
    STAGED_IMAGE = item(0x5010, 9, "image to be staged", Domain, Write);
    STAGED_CHANGES = item(0x5010, 10, "what the staged set would change", Domain, Read),
        bytes |values, params| values.staged_changes(params);
    COMMIT = item(0x5010, 11, "checksum: commit the staged set", U32, Write),
        set |values, value, params| values.commit(value, params);
    OFFSETS = item(0x5011, 1, "image", Domain, Read),
        bytes |_, _| Err(Abort::Internal)?;
    OFFSETS_STATE = item(0x5011, 2, "state of the last change", U8, Read),
        get |values, _| values.offset_store.shelf.state() as u8;
    OFFSETS_REVISION = item(0x5011, 3, "last revision given", U32, Read),
        get |values, _| values.offset_store.shelf.number();
    OFFSETS_FOUND = item(0x5011, 4, "what was found at power-up", U8, Read),
        get |values, _| values.offset_store.shelf.found().number();
    OFFSETS_REFUSAL = item(0x5011, 5, "why the last change was refused", Domain, Read),
        bytes |values, _| values.offsets_refusal();
    STAGED_OFFSETS = item(0x5011, 6, "image to be staged", Domain, Write);
    COMMIT_OFFSETS = item(0x5011, 7, "checksum: commit the staged image", U32, Write),
        set |values, value, _| values.commit_offsets(value);
    MARK_X = item(0x5011, 8, "marked position of X", I32, Both),
        get |values, _| values.offset_store.mark_x,
        set |values, value, _| values.mark_position(Axis::X, value);
    MARK_Z = item(0x5011, 9, "marked position of Z", I32, Both),
        get |values, _| values.offset_store.mark_z,
        set |values, value, _| values.mark_position(Axis::Z, value);
    BATCH = item(0x5020, 1, "batch of calls", Domain, Write);
    LINK_VERSION = with(item(0x5020, 2, "version of the link", U64, Const), Value::Link);
    PROGRAM = item(0x5020, 3, "program", U32, Read),
        get |values, _| values.program_buffer.program();
    NEXT_CALL = item(0x5020, 4, "next call", U32, Read),
        get |values, _| values.program_buffer.next_call();
    CREDIT = item(0x5020, 5, "credit", U16, Read),
        get |values, _| values.program_buffer.credit();
    LONGEST_BATCH = fixed(0x5020, 6, "longest batch", U16, BATCH_BYTES as u32);
    TAP_RECORD = item(0x5030, 1, "record", Domain, Read),
        bytes |values, _| values.tap_bytes();
    TAP_DISCARD = item(0x5030, 2, "discard", U32, Write),
        set |values, value, _| values.discard_tap(value);
    NEWEST_EVENT = item(0x5040, 1, "newest", U32, Read),
        get |values, _| values.log.newest();
    EVENTS_FROM = item(0x5040, 2, "read from", U32, Both),
        get |values, _| values.log_from,
        set |values, value, _| values.read_events_from(value);
    EVENTS = item(0x5040, 3, "entries", Domain, Read),
        bytes |values, _| values.events();
    CERTIFICATES = item(0x5041, 0, "Certificates of the run and of its threads", Domain, Read),
        bytes |values, _| values.certificates();
    THREADS_TAKEN = item(0x5042, 0, "Certificates of threads taken", U32, Both),
        get |values, _| values.recorder.threads.taken(),
        set |values, value, _| values.recorder.threads.take(value);
    START = item(0x5043, 0, "Number of this start", U32, Read),
        get |values, _| values.start;
    ERASES = item(0x5044, 0, "Erases of each page of the storage", U32, Read),
        get |values, _| values.erases;
    SIGNALS = within(item(0x5060, 0, "Signals", U16, Both), 0, Signals::BITS | Signals::MIRRORED),
        get |values, _| values.snapshot.signals(),
        set |values, value, _| values.put_signals(value);
    MACHINE_INPUTS = item(0x5061, 0, "Machine inputs", U32, Read),
        get |values, _| values.snapshot.machine();
    MACHINE_OUTPUTS = item(0x5062, 0, "Machine outputs", U32, Read),
        get |values, _| values.snapshot.machine_out();
    BLOCK_INPUTS = item(0x5063, 0, "Inputs of the block", U32, Read),
        get |values, _| values.snapshot.block();
    BLOCK_OUTPUTS = item(0x5064, 0, "Outputs of the block", U16, Read),
        get |values, _| (values.snapshot.machine_outputs >> 16) as u16;
}

const _: () = assert!(PROGRAM_BYTES <= u16::MAX as usize, "the credit has 16 bits");
