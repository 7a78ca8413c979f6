//! What stands behind the objects: reads and writes of the dictionary, one transfer at a time.
//!
//! A value is put together in one buffer before it is read and after it is written, so nothing changes in the middle of a
//! transfer and nothing takes effect before its end. Only the parameter image is longer than the buffer: it is made and
//! taken value by value.

use heapless::Deque;

use super::dictionary::{Access, Initial, Item, Kind, find};
use super::door::Door;
use super::inbox::Inbox;
use super::keeper::{Keeper, Progress};
use super::ledger::Ledger;
use super::log::Log;
use super::table::{DROP, HISTORY, LOAD, SAVE};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::board::event::{Command, Event};
use crate::board::snapshot::Snapshot;
use crate::board::store::{Region, StoreError, StoreRequest};
use crate::bus::{
    Abort, BoardFlags, BoardPlace, BoardSpindle, BoardStatus, EmcyProducer, HeartbeatConsumer,
    HeartbeatProducer, HeartbeatWatch, MilliRpm, NodeId, Object, Objects, Order, PdoCommunication,
    Service,
};
use crate::link::{
    BATCH_BYTES, ImageError, ImageReader, ImageWriter, Status, VERSION, encode_alarm, identity,
};
use crate::params::{Entry, PASSWORD, PASSWORD_KEPT, PASSWORD_SLOT, Params, Part, TABLE_KEY};
use crate::signals::Signals;
use crate::units::{Length, TurnRate};

/// Commands on their way to the tick.
const COMMANDS: usize = 8;

/// The image of the parameter set.
const IMAGE: Object = Object::new(0x5010, 1);
/// A batch of calls.
const BATCH: Object = Object::new(0x5020, 1);

/// A percentage that stays as it is.
const AS_IT_IS: u8 = 255;

/// The values behind the objects.
#[derive(Debug)]
pub struct Shelf {
    pub node: NodeId,
    pub inbox: Inbox,
    pub log: Log,
    pub ledger: Ledger,
    pub snapshot: Snapshot,
    /// Ticks since power-up.
    pub tick: u64,
    /// Setpoints that came late for their SYNC.
    pub late: u32,
    pub sync_error: Option<Length>,
    /// Count of the last order taken.
    pub count: u8,
    /// Wanted or told only: the feeds of a call are resolved before it comes.
    pub dry_run: bool,
    pub pdos: Pdos,
    /// 1016h: who has to be heard.
    pub watch: HeartbeatConsumer<1>,
    /// 1017h.
    pub heartbeat: HeartbeatProducer,
    /// 1001h and 1003h.
    pub emcy: EmcyProducer<{ HISTORY as usize }>,
    /// 1018h:04.
    pub serial: u32,
    /// For the tick, in the order they came.
    pub commands: Deque<Command, COMMANDS>,
    /// The inputs, as they were set over the bus and not handed on yet.
    pub signals: Option<Signals>,
    /// The tap journal's record is to be dropped.
    pub drops_tap: bool,
    /// What is stored, and the change that is under way.
    pub keeper: Keeper,
    pub door: Door,
    /// The draft is good and comes into force: the owner takes it before the next frame.
    staged: bool,
    /// Where a changed set is put together, before all of it has been looked at.
    draft: Params,
    image: ImageReader,
    log_from: u32,
    buffer: [u8; BATCH_BYTES],
    /// Bytes of it in use.
    length: usize,
}

/// The communication of the board's PDOs.
#[derive(Debug)]
pub struct Pdos {
    pub command: PdoCommunication,
    pub status: PdoCommunication,
    pub place: PdoCommunication,
    pub spindle: PdoCommunication,
}

impl Pdos {
    pub const fn new(node: NodeId, event_ms: u16) -> Self {
        Self {
            command: PdoCommunication::received(Service::Rpdo1, node),
            status: PdoCommunication::sent(Service::Tpdo1, node, event_ms),
            place: PdoCommunication::sent(Service::Tpdo2, node, event_ms),
            spindle: PdoCommunication::sent(Service::Tpdo3, node, event_ms),
        }
    }

    const fn of(&self, index: u16) -> Option<&PdoCommunication> {
        match index {
            0x1400 => Some(&self.command),
            0x1800 => Some(&self.status),
            0x1801 => Some(&self.place),
            0x1802 => Some(&self.spindle),
            _ => None,
        }
    }

    const fn of_mut(&mut self, index: u16) -> Option<&mut PdoCommunication> {
        match index {
            0x1400 => Some(&mut self.command),
            0x1800 => Some(&mut self.status),
            0x1801 => Some(&mut self.place),
            0x1802 => Some(&mut self.spindle),
            _ => None,
        }
    }
}

impl Shelf {
    pub fn new(node: NodeId, params: &Params, snapshot: Snapshot) -> Self {
        Self {
            node,
            inbox: Inbox::new(),
            log: Log::new(),
            ledger: Ledger::new(0),
            snapshot,
            tick: 0,
            late: 0,
            sync_error: None,
            count: 0,
            dry_run: false,
            pdos: Pdos::new(node, ms(params.status_period_ms())),
            watch: watch(params),
            heartbeat: HeartbeatProducer::new(ms(params.heartbeat_ms()), params.tick_us()),
            emcy: EmcyProducer::new(node),
            serial: 0,
            commands: Deque::new(),
            signals: None,
            drops_tap: false,
            keeper: Keeper::default(),
            door: Door::default(),
            staged: false,
            draft: params.clone(),
            image: ImageReader::new(),
            log_from: 0,
            buffer: [0; BATCH_BYTES],
            length: 0,
        }
    }

    /// Another number; the PDOs' times stay.
    pub fn set_node(&mut self, node: NodeId) {
        self.node = node;
        self.pdos = Pdos::new(node, self.pdos.status.event_ms());
        self.emcy = EmcyProducer::new(node);
    }

    /// The communication objects as they are after power-up.
    pub fn reset_communication(&mut self, params: &Params) {
        self.pdos = Pdos::new(self.node, ms(params.status_period_ms()));
        self.watch = watch(params);
        self.heartbeat = HeartbeatProducer::new(ms(params.heartbeat_ms()), params.tick_us());
    }

    /// An order of the operator, from RPDO1 or by SDO. False for a `run` that no program waits for; a warning in the event
    /// log says so [D110]. The others act at once, or when the machine has come to rest.
    pub fn order(&mut self, order: Order) -> bool {
        let command = match order {
            Order::Run => {
                // A program is forgotten with the parameters that it was sent for.
                let waited = !self.is_changing() && self.inbox.run();
                if waited {
                    self.ledger = Ledger::new(self.inbox.program());
                } else {
                    let warning = Alarm::new(Code::NothingToRun, Span::default());
                    self.log.push(self.tick, Event::Warning(warning));
                }
                return waited;
            }
            Order::Hold => Command::Hold,
            Order::Resume => Command::Resume,
            Order::Reset => {
                // What has been sent for the program is forgotten with it.
                self.inbox.close();
                Command::Reset
            }
            Order::Stop => {
                self.inbox.close();
                Command::Stop
            }
        };
        self.command(command);
        true
    }

    /// A command for the tick. Where so many wait that there is no room, the owner does not read them.
    pub fn command(&mut self, command: Command) {
        if self.commands.is_full() {
            self.commands.pop_front();
        }
        // There is room now.
        let _ = self.commands.push_back(command);
    }

    pub fn status(&self) -> BoardStatus {
        let snapshot = &self.snapshot;
        BoardStatus {
            state: snapshot.board_state(),
            flags: BoardFlags {
                hold: snapshot.operator.hold,
                single_block: snapshot.operator.single_block,
                dry_run: self.dry_run,
                program: snapshot.in_program,
                locked: snapshot.setpoint.locked,
            },
            alarm: snapshot.alarm().map(|alarm| alarm.number()),
            count: self.count,
            late: self.late,
            credit: self.inbox.credit().into(),
        }
    }

    pub const fn place(&self) -> BoardPlace {
        BoardPlace {
            line: self.snapshot.setpoint.line,
            number: self.snapshot.setpoint.number,
        }
    }

    pub fn spindle(&self) -> BoardSpindle {
        BoardSpindle {
            angle: self.snapshot.spindle,
            speed: milli_rpm(self.snapshot.speed),
            sync_error: self.sync_error,
        }
    }

    fn record(&self, params: &Params) -> Status {
        let snapshot = &self.snapshot;
        let operator = &snapshot.operator;
        Status {
            version: VERSION,
            tick: self.tick,
            state: snapshot.board_state(),
            alarm: snapshot.alarm(),
            in_program: snapshot.in_program,
            line: snapshot.setpoint.line,
            number: snapshot.setpoint.number,
            position: snapshot.setpoint.position,
            spindle: snapshot.spindle,
            speed: snapshot.speed,
            command: snapshot.command,
            hold: operator.hold,
            single_block: operator.single_block,
            feed_percent: operator.feed_percent(),
            rapid_percent: operator.rapid_percent(),
            spindle_percent: operator.spindle_percent(),
            sync_error: self.sync_error,
            late: self.late,
            program: self.inbox.program(),
            next_call: self.inbox.next_call(),
            credit: self.inbox.credit(),
            newest_event: self.log.newest(),
            signals: operator.signals.bits(),
            parameters: identity(params),
        }
    }

    /// A change of the set is under way: no call goes to the planner.
    pub fn is_changing(&self) -> bool {
        self.staged || self.keeper.is_busy()
    }

    /// A change of parameters is refused, and why.
    fn refuse(&mut self, code: Code, abort: Abort) -> Result<(), Abort> {
        self.refuse_with(&Alarm::new(code, Span::default()), abort)
    }

    fn refuse_with(&mut self, reason: &Alarm, abort: Abort) -> Result<(), Abort> {
        self.keeper.refuse(reason);
        Err(abort)
    }

    /// Whether parameters may change now.
    fn admit(&mut self, params: &Params, change: Change) -> Result<(), Abort> {
        if !self.snapshot.is_at_rest() || self.inbox.awaits_more() || self.is_changing() {
            return self.refuse(Code::ParametersAtWork, Abort::State);
        }
        // What is loaded only to be talked to is no set to change: it is decided on as a whole.
        let undecided = self.keeper.found().alarm();
        if let (Change::Value | Change::Switch, Some(alarm)) = (change, undecided) {
            return self.refuse_with(&alarm, Abort::State);
        }
        // The switch itself can be turned back, and what is loaded already can be taken as it is.
        let free = change == Change::Switch || change == Change::Recall && undecided.is_some();
        if !free && !params.parameter_write_enable() {
            return self.refuse(Code::ParametersProtected, Abort::LocalControl);
        }
        if !self.door.is_open(params) {
            return self.refuse(Code::PasswordMissing, Abort::LocalControl);
        }
        Ok(())
    }

    fn current<'a>(&'a self, params: &'a Params) -> &'a Params {
        if self.staged { &self.draft } else { params }
    }

    /// The set that comes into force, once.
    pub fn take_params(&mut self) -> Option<&Params> {
        core::mem::take(&mut self.staged).then_some(&self.draft)
    }

    /// The set in force comes into force once more.
    pub fn begin_anew(&mut self, params: &Params) {
        self.draft.clone_from(params);
        self.staged = true;
    }

    /// The number an item has now.
    fn number(&self, item: &Item, params: &Params) -> Result<i64, Abort> {
        if let Some(entry) = item.entry {
            let told = self.current(params).told_slot(entry.place());
            return Ok(told.unwrap_or(0));
        }
        let Object { index, sub } = item.object;
        if let Some(pdo) = self.pdos.of(index) {
            return pdo.read(sub).map(i64::from);
        }
        let operator = &self.snapshot.operator;
        Ok(match (index, sub) {
            (0x1001, _) => i64::from(self.emcy.register()),
            (0x1003, sub) => i64::from(self.emcy.history(sub)?),
            (0x1006, _) => i64::from(params.tick_us()),
            (0x1016, 1) => self.watch.get(0).map_or(0, |watch| i64::from(watch.raw())),
            (0x1017, _) => i64::from(self.heartbeat.ms()),
            (0x1018, 4) => i64::from(self.serial),
            (0x1020, 1) => i64::from(identity(params)),
            (0x5010, 2) => self.keeper.state() as i64,
            (0x5010, 3) => i64::from(self.keeper.stored()),
            (0x5010, 4) => i64::from(self.keeper.before()),
            (0x5010, 7) => self
                .keeper
                .reason()
                .map_or(0, |alarm| alarm.number().into()),
            (0x5000, 1) => i64::from(self.count),
            (0x5000, 3) => i64::from(operator.single_block) | i64::from(self.dry_run) << 1,
            (0x5000, 4) => i64::from(operator.feed_percent()),
            (0x5000, 5) => i64::from(operator.rapid_percent()),
            (0x5000, 6) => i64::from(operator.spindle_percent()),
            (0x5020, 3) => i64::from(self.inbox.program()),
            (0x5020, 4) => i64::from(self.inbox.next_call()),
            (0x5020, 5) => i64::from(self.inbox.credit()),
            (0x5040, 1) => i64::from(self.log.newest()),
            (0x5040, 2) => i64::from(self.log_from),
            (0x5060, _) => i64::from(operator.signals.bits()),
            (0x5001, sub @ 2..) => self.fact(sub),
            _ => match item.initial {
                Initial::Number(number) => number,
                Initial::OfNode(base) => i64::from(base.saturating_add(self.node.get().into())),
                Initial::Unknown | Initial::Text(_) => 0,
            },
        })
    }

    /// A fact of 5001h: the bytes of the PDO it stands in.
    fn fact(&self, sub: u8) -> i64 {
        let (frame, mapping) = match sub {
            ..=7 => (self.status().frame(self.node), &BoardStatus::MAPPING[..]),
            8 | 9 => (self.place().frame(self.node), &BoardPlace::MAPPING[..]),
            _ => (self.spindle().frame(self.node), &BoardSpindle::MAPPING[..]),
        };
        let mut bytes = frame.payload();
        for mapped in mapping {
            let length = usize::from(mapped.bits >> 3);
            let Some((value, rest)) = bytes.split_at_checked(length) else {
                break;
            };
            if mapped.object.sub == sub {
                let mut raw = [0; 8];
                if let Some(place) = raw.get_mut(..length) {
                    place.copy_from_slice(value);
                }
                return i64::from_le_bytes(raw);
            }
            bytes = rest;
        }
        0
    }

    /// Puts a number into effect. Its kind and range are right.
    fn take_number(&mut self, item: &Item, number: i64, params: &Params) -> Result<(), Abort> {
        if let Some(entry) = item.entry {
            return self.take_parameter(entry, number, params);
        }
        let Object { index, sub } = item.object;
        let value = number as u32;
        if let Some(pdo) = self.pdos.of_mut(index) {
            return pdo.write(sub, value);
        }
        match (index, sub) {
            (0x1003, sub) => self.emcy.write_history(sub, value)?,
            (0x1010, 1) => return self.save(value, params),
            (0x1011, 1) => return self.restore(value, params),
            (0x5010, 5) => {
                self.admit(params, Change::Recall)?;
                return self.keeper.recall();
            }
            (0x5010, 6) => return self.password(value, params),
            (0x1016, 1) => {
                let watch = HeartbeatWatch::from_raw(value);
                if watch.is_none() && value != 0 {
                    return Err(Abort::Value);
                }
                self.watch.set(0, watch, params.tick_us())?;
            }
            (0x1017, _) => {
                self.heartbeat = HeartbeatProducer::new(value as u16, params.tick_us());
            }
            (0x5000, 1) => self.count = value as u8,
            (0x5000, 2) => {
                if let Some(place) = usize::from(value as u8).checked_sub(1)
                    && let Some(&order) = Order::ALL.get(place)
                    && !self.order(order)
                {
                    return Err(Abort::State);
                }
            }
            (0x5000, sub) => self.setting(sub, value as u8),
            (0x5030, 2) => {
                if value != DROP {
                    return Err(Abort::Value);
                }
                if self.snapshot.tap.is_none_or(|tap| !tap.in_hole) {
                    return Err(Abort::NoData);
                }
                if !self.snapshot.is_at_rest() {
                    return Err(Abort::State);
                }
                self.drops_tap = true;
            }
            (0x5040, 2) => self.log_from = value,
            (0x5060, _) => {
                let signals = Signals::from_bits(value as u16).ok_or(Abort::Value)?;
                self.signals = Some(signals);
            }
            _ => return Err(Abort::ReadOnly),
        }
        Ok(())
    }

    /// A switch or an override of 5000h.
    pub fn setting(&mut self, sub: u8, value: u8) {
        if sub == 3 {
            let on = |bit: u8| (value >> bit & 0x10 != 0).then_some(value >> bit & 1 != 0);
            self.switches(on(0), on(1));
            return;
        }
        if value == AS_IT_IS {
            return;
        }
        match sub {
            4 => self.command(Command::FeedOverride(value)),
            5 => self.command(Command::RapidOverride(value)),
            6 => self.command(Command::SpindleOverride(value)),
            _ => {}
        }
    }

    pub fn switches(&mut self, single_block: Option<bool>, dry_run: Option<bool>) {
        if let Some(on) = single_block {
            self.command(Command::SingleBlock(on));
        }
        self.dry_run = dry_run.unwrap_or(self.dry_run);
    }

    fn take_parameter(
        &mut self,
        entry: &'static Entry,
        number: i64,
        params: &Params,
    ) -> Result<(), Abort> {
        let change = if entry.is_number(PARAMETER_WRITE_ENABLE) {
            Change::Switch
        } else {
            Change::Value
        };
        self.admit(params, change)?;
        self.draft.clone_from(params);
        match entry.part {
            Part::Bit(_) => {
                if number & !entry.byte_mask() != 0 {
                    return Err(Abort::Value);
                }
                self.draft.put_slot(entry.place(), number);
            }
            Part::Whole | Part::Axis(_) => {
                self.draft.set(entry, number).map_err(|_| Abort::Value)?;
            }
        }
        self.stage(params)
    }

    /// The draft is stored and comes into force, if it can work.
    fn stage(&mut self, params: &Params) -> Result<(), Abort> {
        if self.draft.slot(PASSWORD_SLOT) == Some(PASSWORD_KEPT) {
            let kept = params.slot(PASSWORD_SLOT).unwrap_or(0);
            if kept == 0 {
                return self.refuse_with(&out_of_range(PASSWORD), Abort::Value);
            }
            self.draft.put_slot(PASSWORD_SLOT, kept);
        }
        if let Err(alarm) = self.draft.validate() {
            return self.refuse_with(&alarm, Abort::Incompatible);
        }
        if self.draft == *params && self.keeper.is_stored() {
            self.keeper.nothing_to_do();
        } else {
            self.keeper.begin();
        }
        Ok(())
    }

    fn refuse_image(&mut self, error: ImageError) -> Result<(), Abort> {
        let (alarm, abort) = match error {
            ImageError::Table(key) => (
                Alarm::new(Code::ImageForeign, Span::default()).with([
                    Arg::Key(key),
                    Arg::Key(TABLE_KEY),
                    Arg::None,
                    Arg::None,
                ]),
                Abort::Incompatible,
            ),
            ImageError::Length => (incomplete(), Abort::Length),
            ImageError::Checksum => (incomplete(), Abort::Crc),
            ImageError::Range(no) => (out_of_range(no), Abort::Value),
        };
        self.refuse_with(&alarm, abort)
    }

    /// 1010h: every change is stored by itself; only the built-in set of a new board can be left.
    fn save(&mut self, signature: u32, params: &Params) -> Result<(), Abort> {
        if signature != SAVE {
            return Err(Abort::NotStored);
        }
        if let Some(alarm) = self.keeper.found().alarm() {
            return self.refuse_with(&alarm, Abort::State);
        }
        if self.keeper.is_stored() || self.is_changing() {
            return Ok(());
        }
        self.admit(params, Change::Whole)?;
        self.draft.clone_from(params);
        self.stage(params)
    }

    /// 1011h: the built-in set.
    fn restore(&mut self, signature: u32, params: &Params) -> Result<(), Abort> {
        if signature != LOAD {
            return Err(Abort::NotStored);
        }
        self.admit(params, Change::Whole)?;
        self.draft = Params::slant_bed();
        // A password is not taken away by this.
        let kept = params.slot(PASSWORD_SLOT).unwrap_or(0);
        self.draft.put_slot(PASSWORD_SLOT, kept);
        self.stage(params)
    }

    fn password(&mut self, password: u32, params: &Params) -> Result<(), Abort> {
        self.door.knock(password, params).or_else(|alarm| {
            self.log.push(self.tick, Event::Warning(alarm));
            self.refuse_with(&alarm, Abort::LocalControl)
        })
    }

    /// See [`Keeper::loaded`].
    pub fn loaded(&mut self, held: Result<Option<&[u8]>, StoreError>) {
        let progress = self.keeper.loaded(held, &mut self.draft);
        self.go_on(progress);
    }

    /// See [`Keeper::store`].
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        self.keeper.store(&self.draft)
    }

    /// See [`Keeper::has_stored`].
    pub fn has_stored(&mut self, region: Region, result: Result<(), StoreError>) {
        let progress = self.keeper.has_stored(region, result, &self.draft);
        self.go_on(progress);
    }

    fn go_on(&mut self, progress: Progress) {
        self.staged |= progress.in_force;
        if let Some(warning) = progress.warning {
            self.log.push(self.tick, Event::Warning(warning));
        }
    }
}

/// What somebody wants to change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    /// One value.
    Value,
    /// The write enable itself.
    Switch,
    /// All of them.
    Whole,
    /// Back to the last good set.
    Recall,
}

fn incomplete() -> Alarm {
    Alarm::new(Code::ParametersIncomplete, Span::default())
}

fn out_of_range(no: u16) -> Alarm {
    let args = [Arg::Int(no.into()), Arg::None, Arg::None, Arg::None];
    Alarm::new(Code::ParametersOutOfRange, Span::default()).with(args)
}

/// Number of the parameter that allows writing the others.
const PARAMETER_WRITE_ENABLE: u16 = 9026;

/// Who is watched after power-up.
fn watch(params: &Params) -> HeartbeatConsumer<1> {
    let watch = HeartbeatWatch {
        node: NodeId::GATEWAY,
        ms: ms(params.gateway_silence_ms()),
    };
    let mut consumer = HeartbeatConsumer::new();
    // The one entry there is.
    let _ = consumer.set(0, (watch.ms > 0).then_some(watch), params.tick_us());
    consumer
}

/// Milliseconds of an object with 16 bits.
fn ms(ms: u32) -> u16 {
    u16::try_from(ms).unwrap_or(u16::MAX)
}

/// Thousandths of a turn per minute of 2⁻³² turns per second.
const fn milli_rpm(rate: TurnRate) -> MilliRpm {
    let raw = rate.raw() as i128;
    let milli = raw.saturating_mul(60_000).saturating_add(1 << 31) >> 32;
    MilliRpm::new(milli as i32)
}

/// The shelf together with the set in force: what an SDO server serves.
pub struct Served<'a> {
    pub shelf: &'a mut Shelf,
    pub params: &'a Params,
}

impl Objects for Served<'_> {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        let item = find(object)?;
        if item.access == Access::Write {
            return Err(Abort::WriteOnly);
        }
        let shelf = &mut *self.shelf;
        let length = match (item.kind, object.index) {
            (Kind::Text, _) => {
                let text = match item.initial {
                    Initial::Text(text) => text.as_bytes(),
                    _ => &[],
                };
                let length = text.len().min(BATCH_BYTES);
                for (place, &byte) in shelf.buffer.iter_mut().zip(text) {
                    *place = byte;
                }
                length
            }
            (Kind::Domain, 0x5010) if object == IMAGE => return Ok(ImageWriter::BYTES),
            (Kind::Domain, 0x5010) => {
                let reason = shelf.keeper.reason();
                encode_alarm(reason, &mut shelf.buffer).map_err(|_| Abort::Internal)?
            }
            (Kind::Domain, 0x5001) => {
                let status = shelf.record(self.params);
                let bytes = status
                    .encode(&mut shelf.buffer)
                    .map_err(|_| Abort::Internal)?;
                bytes.len()
            }
            (Kind::Domain, 0x5030) => {
                let record = shelf.snapshot.tap.ok_or(Abort::NoData)?.encode();
                for (place, &byte) in shelf.buffer.iter_mut().zip(&record) {
                    *place = byte;
                }
                record.len()
            }
            (Kind::Domain, 0x5041) => {
                let certificate = shelf.ledger.certificate(shelf.late);
                let bytes = certificate
                    .encode(&mut shelf.buffer)
                    .map_err(|_| Abort::Internal)?;
                bytes.len()
            }
            (Kind::Domain, 0x5040) => shelf.log.read(shelf.log_from, &mut shelf.buffer),
            (Kind::Domain, _) => return Err(Abort::NoData),
            (kind, _) => {
                let number = shelf.number(&item, self.params)?;
                for (place, byte) in shelf.buffer.iter_mut().zip(number.to_le_bytes()) {
                    *place = byte;
                }
                kind.bytes().unwrap_or(0)
            }
        };
        shelf.length = length;
        u32::try_from(length).map_err(|_| Abort::Internal)
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        if object == IMAGE {
            let params = self.shelf.current(self.params);
            return Ok(ImageWriter::new(params).read(offset, into));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let bytes = self
            .shelf
            .buffer
            .get(start..self.shelf.length)
            .unwrap_or(&[]);
        for (place, &byte) in into.iter_mut().zip(bytes) {
            *place = byte;
        }
        Ok(bytes.len().min(into.len()))
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        let item = find(object)?;
        if matches!(item.access, Access::Read | Access::Const) {
            return Err(Abort::ReadOnly);
        }
        let shelf = &mut *self.shelf;
        shelf.length = 0;
        shelf.buffer = [0; BATCH_BYTES];
        if object == IMAGE {
            shelf.admit(self.params, Change::Whole)?;
            shelf.image = ImageReader::new();
        }
        let Some(size) = size else { return Ok(()) };
        let most = match item.kind.bytes() {
            Some(bytes) => bytes as u32,
            None if object == IMAGE => ImageWriter::BYTES,
            None => BATCH_BYTES as u32,
        };
        if size > most {
            return Err(Abort::TooLong);
        }
        if item.kind.bytes().is_some() && size < most {
            return Err(Abort::TooShort);
        }
        Ok(())
    }

    fn write(&mut self, object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        let shelf = &mut *self.shelf;
        if object == IMAGE {
            let taken = shelf.image.take(bytes, &mut shelf.draft);
            return taken.or_else(|error| shelf.refuse_image(error));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = start.saturating_add(bytes.len());
        let place = shelf.buffer.get_mut(start..end).ok_or(Abort::TooLong)?;
        for (place, &byte) in place.iter_mut().zip(bytes) {
            *place = byte;
        }
        shelf.length = end;
        Ok(())
    }

    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort> {
        let item = find(object)?;
        let shelf = &mut *self.shelf;
        if object == IMAGE {
            shelf.admit(self.params, Change::Whole)?;
            if let Err(error) = shelf.image.finish(&shelf.draft) {
                return shelf.refuse_image(error);
            }
            return shelf.stage(self.params);
        }
        if object == BATCH {
            let snapshot = &shelf.snapshot;
            let (ready, at_rest) = (snapshot.takes_calls(), snapshot.is_at_rest());
            let bytes = shelf.buffer.get(..shelf.length).unwrap_or(&[]);
            return shelf.inbox.take(bytes, ready, at_rest);
        }
        let bytes = item.kind.bytes().ok_or(Abort::Access)?;
        match (length as usize).cmp(&bytes) {
            core::cmp::Ordering::Greater => return Err(Abort::TooLong),
            core::cmp::Ordering::Less => return Err(Abort::TooShort),
            core::cmp::Ordering::Equal => {}
        }
        let raw = shelf.buffer.first_chunk::<8>().copied().unwrap_or_default();
        let number = item.kind.number(raw);
        let none = item.entry.is_some_and(|entry| entry.none == Some(number));
        if let Some((low, high)) = item.range
            && !none
        {
            if number < low {
                return Err(Abort::TooLow);
            }
            if number > high {
                return Err(Abort::TooHigh);
            }
        }
        shelf.take_number(&item, number, self.params)
    }

    fn abandon(&mut self, _object: Object) {
        self.shelf.length = 0;
    }
}
