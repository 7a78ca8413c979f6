//! The values of the objects in the dictionary.
//!
//! `served` knows how they travel, `change` how the parameters change.

use heapless::Deque;

use super::log::Log;
use super::mode::Request;
use super::offset_store::OffsetStore;
use super::operating::Operating;
use super::own_wheel::OwnWheel;
use super::program_buffer::ProgramBuffer;
use super::protection::WriteProtection;
use super::recorder::RunRecorder;
use super::shelf::Shelf;
use super::table::HISTORY;
use crate::alarm::{Alarm, Arg, Code};
use crate::board::kept::Kept;
use crate::board::store::{GUARANTEED_ERASES, WORN};
use crate::bus::{
    Beat, BoardBeat, BoardFlags, BoardPlace, BoardSpindle, BoardStatus, DataRates, EmcyProducer,
    Frame, HeartbeatConsumer, HeartbeatProducer, HeartbeatWatch, MilliRpm, NodeId, Order,
    PdoCommunication, Service,
};
use crate::link::Event;
use crate::link::{BATCH_BYTES, ImageReader, Status, VERSION, identity};
use crate::offsets::InPlace;
use crate::params::{Entry, Params};
use crate::signals::Signals;
use crate::tick::{Command, Measured, Snapshot};
use crate::units::{Axes, Length, TurnRate};

/// Commands on their way to the tick.
const COMMANDS: usize = 8;

/// The values behind the objects.
#[derive(Debug)]
pub struct ObjectValues {
    pub node: NodeId,
    /// Count of the last accepted order.
    pub count: u8,
    /// 5000h:07: the echo for the next order that is written.
    pub(super) echo: Option<Beat>,
    /// Mode, beat and presses.
    pub operating: Operating,
    /// The handwheel at the board's own input.
    pub(super) own_wheel: OwnWheel,
    /// Dry run. It is only stored and read here: the feeds of a call are resolved before it comes.
    pub dry_run: bool,
    /// A request to drop the tap journal's record.
    pub drops_tap: bool,
    /// The draft is good and comes into force. The owner takes it before the next frame.
    pub(super) staged: bool,
    /// The last commit named the draft with its password.
    pub(super) named: bool,
    /// The single value that the last change wrote into the draft; `None` where the change was larger or was
    /// refused.
    pub(super) wrote: Option<&'static Entry>,
    /// The inputs, if they were set over the bus and the owner has not read them yet.
    pub signals: Option<Signals>,
    /// Setpoints that came late for their SYNC.
    pub late: u32,
    /// 1018h:04.
    pub serial: u32,
    /// Which of the board's starts this is, from 1; 0: not known.
    pub start: u32,
    /// How often each page of the storage has been erased.
    pub(super) erases: u32,
    /// Rates that the controller can give the data of CAN FD frames.
    pub data_rates: DataRates,
    pub(super) log_from: u32,
    /// Used bytes of the buffer.
    pub(super) length: usize,
    /// Ticks since power-up.
    pub tick: u64,
    /// The error of the axis that is held to the spindle, while one is.
    pub measured: Option<Measured>,
    /// 1017h.
    pub heartbeat: HeartbeatProducer,
    pub protection: WriteProtection,
    /// 1016h: the nodes to be supervised.
    pub watch: HeartbeatConsumer<1>,
    pub pdos: Pdos,
    pub(super) image: ImageReader,
    pub recorder: RunRecorder,
    /// 1001h and 1003h.
    pub emcy: EmcyProducer<{ HISTORY as usize }>,
    /// The stored sets and the change under way.
    pub parameter_store: Shelf,
    /// The table of offsets and tools.
    pub offset_store: OffsetStore,
    /// The tool in place, by what the machine has carried out since power-up.
    pub in_place: InPlace,
    pub snapshot: Snapshot,
    /// Commands for the tick, in order.
    pub commands: Deque<Command, COMMANDS>,
    pub log: Log,
    pub program_buffer: ProgramBuffer,
    pub(super) buffer: [u8; BATCH_BYTES],
    /// A changed set is put together here before it is checked as a whole.
    pub(super) draft: Params,
}

/// TPDO1 to 3, and TPDO5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    Status,
    Place,
    Spindle,
    Beat,
}

impl Told {
    pub const ALL: [Self; 4] = [Self::Status, Self::Place, Self::Spindle, Self::Beat];
}

/// The communication of the board's PDOs: RPDO1 to 4, TPDO1 to 3, and TPDO5.
#[derive(Debug)]
pub struct Pdos([PdoCommunication; 8]);

impl Pdos {
    #[inline(never)]
    pub const fn new(node: NodeId, event_ms: u16) -> Self {
        // Above that node the identifier belongs to somebody else.
        let has_beat = node.get() <= BoardBeat::LAST_NODE;
        Self([
            PdoCommunication::received(Service::Rpdo1, node),
            PdoCommunication::received(Service::Rpdo2, node),
            PdoCommunication::received(Service::Rpdo3, node),
            PdoCommunication::received(Service::Rpdo4, node),
            PdoCommunication::sent(Service::Tpdo1, node, event_ms),
            PdoCommunication::sent(Service::Tpdo2, node, event_ms),
            PdoCommunication::sent(Service::Tpdo3, node, event_ms),
            PdoCommunication::sent_as(BoardBeat::id(node), has_beat, event_ms),
        ])
    }

    /// RPDO1, 2, 3 and 4.
    pub const fn received(&self) -> [&PdoCommunication; 4] {
        let [command, jog, step, wheel, ..] = &self.0;
        [command, jog, step, wheel]
    }

    /// The PDOs of [`Told::ALL`].
    pub fn sent(&self, place: usize) -> Option<&PdoCommunication> {
        let [_, _, _, _, sent @ ..] = &self.0;
        sent.get(place)
    }

    /// Event timer of the status.
    pub const fn event_ms(&self) -> u16 {
        let [_, _, _, _, status, ..] = &self.0;
        status.event_ms()
    }

    /// The place of an index.
    const fn place(index: u16) -> usize {
        match index {
            0x1400 => 0,
            0x1401 => 1,
            0x1402 => 2,
            0x1403 => 3,
            0x1800 => 4,
            0x1801 => 5,
            0x1802 => 6,
            0x1804 => 7,
            _ => usize::MAX,
        }
    }

    pub(super) fn of(&self, index: u16) -> Option<&PdoCommunication> {
        self.0.get(Self::place(index))
    }

    pub(super) fn of_mut(&mut self, index: u16) -> Option<&mut PdoCommunication> {
        self.0.get_mut(Self::place(index))
    }
}

impl ObjectValues {
    // Part of the background, which is written where it will be [D146].
    #[inline(always)]
    pub fn new(node: NodeId, params: &Params, snapshot: Snapshot) -> Self {
        Self {
            node,
            program_buffer: ProgramBuffer::new(),
            log: Log::new(),
            recorder: RunRecorder::new(),
            snapshot,
            tick: 0,
            late: 0,
            measured: None,
            count: 0,
            echo: None,
            operating: Operating::default(),
            own_wheel: OwnWheel::default(),
            dry_run: false,
            pdos: Pdos::new(node, ms(params.status_period_ms())),
            watch: watch(params),
            heartbeat: HeartbeatProducer::new(ms(params.heartbeat_ms()), params.tick_us()),
            emcy: EmcyProducer::new(node),
            serial: 0,
            start: 0,
            erases: 0,
            data_rates: DataRates::ALL,
            commands: Deque::new(),
            signals: None,
            drops_tap: false,
            parameter_store: Shelf::new(Kept::Parameters),
            offset_store: OffsetStore::new(),
            in_place: InPlace::default(),
            protection: WriteProtection::default(),
            staged: false,
            named: false,
            wrote: None,
            draft: params.clone(),
            image: ImageReader::new(),
            log_from: 0,
            buffer: [0; BATCH_BYTES],
            length: 0,
        }
    }

    /// Sets another node number. The PDOs' times stay.
    pub fn set_node(&mut self, node: NodeId) {
        self.node = node;
        self.pdos = Pdos::new(node, self.pdos.event_ms());
        self.emcy = EmcyProducer::new(node);
    }

    /// The communication objects as they are after power-up.
    pub fn reset_communication(&mut self, params: &Params) {
        self.pdos = Pdos::new(self.node, ms(params.status_period_ms()));
        self.watch = watch(params);
        self.heartbeat = HeartbeatProducer::new(ms(params.heartbeat_ms()), params.tick_us());
    }

    /// An order of the operator, by RPDO1 or by SDO, that is not too old.
    ///
    /// # Errors
    /// Why it is not carried out; the event log says so too [D110].
    pub fn order(&mut self, order: Order, params: &Params) -> Result<(), Alarm> {
        let done = self.carry_out(order, params);
        match &done {
            Ok(()) => self.accept(),
            Err(alarm) => self.deny(alarm),
        }
        done
    }

    fn carry_out(&mut self, order: Order, params: &Params) -> Result<(), Alarm> {
        let command = match order {
            Order::Run => {
                let begun = self.begin_program();
                // Nobody is to begin it later, when what has refused it is forgotten [D316].
                if begun.is_err() && self.program_buffer.is_loading() {
                    self.program_buffer.close();
                }
                return begun;
            }
            Order::Mode(mode) => return self.change_mode(mode),
            Order::Home(axes) => {
                self.let_in(Request::Home)?;
                self.out_of_hole()?;
                self.door_is_closed()?;
                let all = axes.is_empty();
                Command::Home(if all { Axes::ALL } else { axes })
            }
            Order::Cancel => {
                self.end_press();
                Command::Cancel
            }
            Order::Hold => {
                self.operating.hold_back();
                Command::Hold
            }
            Order::Resume => self.resume(params)?,
            Order::Reset => {
                // The calls of the program are dropped with it.
                self.program_buffer.close();
                Command::Reset
            }
            Order::Stop => {
                self.program_buffer.close();
                Command::Stop
            }
        };
        self.command(command);
        Ok(())
    }

    /// Begins the program whose calls wait.
    fn begin_program(&mut self) -> Result<(), Alarm> {
        self.let_in(Request::Run)?;
        self.same_offsets()?;
        self.let_in_referenced()?;
        self.let_in_guarded()?;
        self.let_in_off_limits()?;
        // A program is dropped together with the parameters for which it was sent.
        if self.is_changing() || !self.program_buffer.run() {
            return Err(Alarm::of(Code::NothingToRun, &[]));
        }
        self.recorder.begin(self.program_buffer.program());
        Ok(())
    }

    /// A waiting program runs with the table of offsets that it was resolved with. With a tap in its hole only the way
    /// out can move, and no offset counts for it.
    fn same_offsets(&self) -> Result<(), Alarm> {
        if self.offset_store.shelf.is_busy() {
            return Err(Alarm::of(Code::OffsetsAtWork, &[]));
        }
        let in_hole = self.snapshot.tap.is_some_and(|tap| tap.in_hole);
        if in_hole || !self.program_buffer.is_loading() {
            return Ok(());
        }
        let refused = self.offset_store.refuses(self.program_buffer.offsets());
        refused.map_or(Ok(()), Err)
    }

    /// A warning without figures, for the event log.
    #[inline(never)]
    pub fn warn(&mut self, code: Code) {
        let warning = Alarm::of(code, &[]);
        self.log.push(self.tick, &Event::Warning(warning));
    }

    /// Takes how often each page of the storage has been erased, and warns once where it is worn.
    #[inline(never)]
    pub fn set_erases(&mut self, erases: u32) {
        if self.erases < WORN && erases >= WORN {
            let figures = [erases, GUARANTEED_ERASES].map(|figure| Arg::Int(figure.into()));
            let warning = Alarm::of(Code::StorageWorn, &figures);
            self.log.push(self.tick, &Event::Warning(warning));
        }
        self.erases = erases;
    }

    /// A command for the tick. Where there is no room, the owner does not read the commands.
    pub fn command(&mut self, command: Command) {
        if self.commands.is_full() {
            self.commands.pop_front();
        }
        // There is room now.
        let _ = self.commands.push_back(command);
    }

    fn status(&self) -> BoardStatus {
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
            alarm: snapshot.alarm().map(Alarm::number),
            count: self.count,
            late: self.late,
            credit: self.program_buffer.credit().into(),
        }
    }

    const fn place(&self) -> BoardPlace {
        BoardPlace {
            line: self.snapshot.setpoint.line,
            number: self.snapshot.setpoint.number,
        }
    }

    fn sync_error(&self) -> Option<Length> {
        self.measured.as_ref().map(|measured| measured.error)
    }

    fn spindle(&self) -> BoardSpindle {
        BoardSpindle {
            angle: self.snapshot.spindle,
            speed: milli_rpm(self.snapshot.speed),
            sync_error: self.sync_error(),
        }
    }

    /// The present content of a TPDO.
    #[inline(never)]
    pub fn tell(&self, told: Told) -> Frame {
        match told {
            Told::Status => self.status().frame(self.node),
            Told::Place => self.place().frame(self.node),
            Told::Spindle => self.spindle().frame(self.node),
            Told::Beat => self.told_beat().frame(self.node),
        }
    }

    pub(super) fn record(&self, params: &Params) -> Status {
        let snapshot = &self.snapshot;
        let operator = &snapshot.operator;
        Status {
            version: VERSION,
            tick: self.tick,
            state: snapshot.board_state(),
            alarm: snapshot.alarm().copied(),
            in_program: snapshot.in_program,
            left: self.operating.point().filter(|_| snapshot.has_left),
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
            sync_error: self.sync_error(),
            late: self.late,
            program: self.program_buffer.program(),
            next_call: self.program_buffer.next_call(),
            credit: self.program_buffer.credit(),
            newest_event: self.log.newest(),
            signals: self.snapshot.signals(),
            referenced: snapshot.referenced,
            unreferenced: snapshot.unreferenced,
            parameters: identity(params),
        }
    }
}

/// The supervised nodes after power-up.
fn watch(params: &Params) -> HeartbeatConsumer<1> {
    let watch = HeartbeatWatch {
        node: NodeId::GATEWAY,
        ms: ms(params.gateway_silence_ms()),
    };
    let mut consumer = HeartbeatConsumer::new();
    // The only entry.
    let _ = consumer.set(0, (watch.ms > 0).then_some(watch), params.tick_us());
    consumer
}

/// Milliseconds of an object with 16 bits.
fn ms(ms: u32) -> u16 {
    u16::try_from(ms).unwrap_or(u16::MAX)
}

/// Thousandths of a turn per minute.
const fn milli_rpm(rate: TurnRate) -> MilliRpm {
    let raw = rate.raw() as i128;
    let milli = raw.saturating_mul(60_000).saturating_add(1 << 31) >> 32;
    MilliRpm::new(milli as i32)
}
