//! The board as a CANopen device: objects, process data, heartbeats, emergencies. Sans-IO, and in the background: the tick
//! knows nothing of it.
//!
//! ```text
//!              frames                    calls (as there is room)
//! gateway ◄──────────────► Device ───────────────────────────────► Planner
//!                            │  ▲
//!                   commands ▼  │ snapshot, events
//!                            Ticker
//! ```
//!
//! - An operator's request (RPDO1, 5000h) becomes a [`Command`] at once: it never waits for a transfer.
//! - A program comes in small batches (5020h) and waits, encoded, in [`PROGRAM_BYTES`]; after `run` its calls go to the
//!   planner one by one [D98]. TPDO1 tells how many bytes fit, so a program of any size goes through [D99].
//! - Parameters (2000h, 5010h) are staged, checked as a set, stored, and come into force all or none, with a restart of
//!   the application [D101], [D116]. Offsets and tools (5011h) are stored the same way, and nothing restarts.
//!
//! The owner gives the device every frame that is not a drive's, every event, and a snapshot of the tick side as often as
//! possible. It takes commands, a changed parameter set and frames from the device. [`Board`](super::Board) does this for
//! owners with one thread.
//!
//! It must not know motion, drives or the meaning of a call.

mod accessors;
mod actual;
mod block;
mod change;
pub mod dictionary;
mod health;
mod item;
mod log;
mod mode;
mod obey;
pub mod objects;
mod offset_store;
mod operating;
mod own_wheel;
mod pass;
mod program_buffer;
mod protection;
mod recorder;
mod ring;
mod served;
mod shelf;
mod steps;
mod table;
mod tell;
mod threads;
mod values;
mod wheel;

pub use offset_store::UNMARKED;
pub use program_buffer::PROGRAM_BYTES;
pub use shelf::CommitState;
pub use table::{DROP, GROUPS, Group, HISTORY, LOAD, PRODUCT, SAVE};

use crate::tick::{Command, DriveNodes, Found, Intrusion, Measured, Snapshot, StoreError};
use heapless::Deque;

use self::block::Block;
pub use self::operating::Asked;
use self::served::Served;
use self::values::{ObjectValues, Told};
use super::kept::PowerUp;
use super::request::StoreRequest;
use super::store::Region;
use crate::alarm::{Alarm, Code};
use crate::bus::{
    Beat, BlockSize, CobId, Controller, Cycle, DataRates, Frame, HeartbeatEvent, HeartbeatWatch,
    NmtSlave, NmtState, NodeId, OrderGate, Periods, SdoServer, Service,
};
use crate::call::{Aux, Call};
use crate::cycle::Forbidden;
use crate::link::Event;
use crate::link::ThreadCertificate;
use crate::offsets::InPlace;
use crate::offsets::image::Image;
use crate::operating::OperatingMode;
use crate::params::Params;
use crate::signals::Signals;
use crate::units::{Axis, Length};

/// Frames that wait to be sent: statuses, heartbeats, emergencies.
const URGENT: usize = 12;
/// Answers of the SDO server that wait to be sent.
const ANSWERS: usize = 16;
/// The longest silence of a client during a transfer.
const PATIENCE_MS: u32 = 1000;

/// The board on the bus, without its drives.
#[derive(Debug)]
pub struct Device {
    nmt: NmtSlave,
    /// It has joined a network, also while it starts again.
    joined: bool,
    sdo: SdoServer,
    patience: Periods,
    gate: OrderGate,
    /// Time since the last TPDO1, 2, 3 and 5.
    since: [Periods; Told::ALL.len()],
    /// The alarm of the last emergency message, which has no more of it than its number.
    told: Option<Code>,
    /// A restart of the application is requested. It waits until the machine stands.
    restarts: bool,
    /// How long the drives may still move, once the setpoints stand.
    drives_move_for: Periods,
    /// The CAN controller.
    controller: Controller,
    /// Late setpoints are counted from here: their number at that time, and the time since.
    lateness: (u32, Periods),
    urgent: Deque<Frame, URGENT>,
    answers: Deque<Frame, ANSWERS>,
    block: Block,
    values: ObjectValues,
}

impl Device {
    /// A device that has not joined a network: it neither hears nor sends.
    // Written straight to the place that the caller names. As a function of its own, the value would be copied there
    // [D146].
    #[must_use]
    #[inline(always)]
    pub fn new(node: NodeId, params: &Params, snapshot: Snapshot) -> Self {
        let patience = Periods::from_ms(PATIENCE_MS, params.tick_us()).unwrap_or_default();
        Self {
            values: ObjectValues::new(node, params, snapshot),
            nmt: NmtSlave::new(node),
            joined: false,
            sdo: SdoServer::new(node, patience, BlockSize::MAX),
            patience,
            gate: OrderGate::new(),
            since: [Periods::new(0); Told::ALL.len()],
            urgent: Deque::new(),
            answers: Deque::new(),
            told: None,
            restarts: false,
            drives_move_for: Periods::new(0),
            controller: Controller::default(),
            block: Block::default(),
            lateness: (0, Periods::new(0)),
        }
    }

    /// Takes the result of power-up. Call it once, before the device joins.
    pub fn power_up(&mut self, up: &PowerUp) {
        self.values.parameter_store.power_up(up.found, up.shelved);
        self.values.offset_store.power_up(&up.offsets);
        self.values.start = up.start;
        self.values.set_erases(up.erases);
    }

    /// Takes how often each page of the storage has been erased. A warning is given where that is much.
    pub fn set_erases(&mut self, erases: u32) {
        self.values.set_erases(erases);
    }

    /// The state of the stored parameters, at power-up or after a later decision. The tick side withholds motion
    /// accordingly.
    #[must_use]
    pub const fn found(&self) -> Found {
        self.values.parameter_store.found()
    }

    /// True while a change of the parameter set, or of offsets, is being stored, or waits for its owner. No call goes to
    /// the planner.
    #[must_use]
    pub fn is_changing(&self) -> bool {
        self.values.is_changing() || self.values.offset_store.shelf.is_busy()
    }

    /// The image of the table of offsets and tools in force.
    #[must_use]
    pub const fn offsets(&self) -> &Image {
        &self.values.offset_store.in_force
    }

    /// The tool in place, by what the machine has carried out since power-up.
    #[must_use]
    pub const fn in_place(&self) -> InPlace {
        self.values.in_place
    }

    /// What is moved by hand has to keep out of.
    pub(in crate::board) fn forbidden(&self, params: &Params) -> Forbidden {
        self.values.forbidden(params)
    }

    /// How the last change of the parameter set ended: 5010h:02.
    #[must_use]
    pub const fn commit_state(&self) -> CommitState {
        self.values.parameter_store.state()
    }

    /// The next region to read; the owner answers with [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.values.parameter_store.load()
    }

    /// The content of the region that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Result<Option<&[u8]>, StoreError>) {
        self.values.loaded(held);
    }

    /// The next write for the storage; the owner answers with [`has_stored`](Self::has_stored).
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        self.values.store()
    }

    /// The write of [`store`](Self::store) has been done, or has failed. [`take_params`](Self::take_params) returns a
    /// stored set.
    pub fn has_stored(&mut self, region: Region, result: Result<(), StoreError>) {
        self.values.has_stored(region, result);
    }

    /// Takes another node number, only before it joins.
    pub fn set_node(&mut self, node: NodeId) {
        if self.has_joined() {
            return;
        }
        self.nmt = NmtSlave::new(node);
        self.sdo = SdoServer::new(node, self.patience, BlockSize::MAX);
        self.values.set_node(node);
    }

    /// Joins the network: sends the boot-up message and waits for an NMT start.
    ///
    /// # Errors
    /// [`Code::BusOverload`] where the cycle leaves no room on the bus; [`Code::DriveNodeOfBoard`] where a drive has its
    /// number.
    pub fn join(&mut self, params: &Params) -> Result<(), Alarm> {
        Cycle::of(params).check()?;
        DriveNodes::of(params).spare(self.node())?;
        self.joined = true;
        let boot_up = self.nmt.boot();
        self.say(boot_up);
        Ok(())
    }

    /// True once it has joined.
    #[must_use]
    pub const fn has_joined(&self) -> bool {
        self.joined
    }

    /// Its node number.
    #[must_use]
    pub const fn node(&self) -> NodeId {
        self.nmt.node()
    }

    /// Its NMT state.
    #[must_use]
    pub const fn state(&self) -> NmtState {
        self.nmt.state()
    }

    /// Sets the serial number of 1018h.
    pub const fn set_serial(&mut self, serial: u32) {
        self.values.serial = serial;
    }

    /// Says at which rates the controller can send the data of CAN FD frames. The board refuses a set that asks for
    /// another one.
    pub const fn set_data_rates(&mut self, rates: DataRates) {
        self.values.data_rates = rates;
    }

    /// Takes a frame. False for a frame of a drive, or of a service that the board does not have.
    pub fn receive(&mut self, frame: &Frame, params: &Params) -> bool {
        if !self.has_joined() {
            return false;
        }
        let intrusion = Intrusion::of(frame, &DriveNodes::of(params));
        let intrusion = intrusion.or_else(|| self.setpoints_of_others(frame.id(), params));
        if let Some(intrusion) = intrusion {
            self.resist(intrusion);
        }
        if frame.id() == CobId::NMT {
            self.block.manage(frame, params);
            if let Some(event) = self.nmt.receive(frame) {
                self.obey(event, params);
            }
            return true;
        }
        let Some((service, node)) = frame.id().service() else {
            return false;
        };
        if self.block.is_at(node) {
            self.block.hear(service, frame);
            return true;
        }
        if node == NodeId::GATEWAY && service == Service::Heartbeat
            || node == self.node() && service == Service::SdoRequest
        {
            self.values.protection.hear();
        }
        if let Some((_, event)) = self.values.watch.receive(frame) {
            match event {
                // The sender of the program has forgotten it.
                HeartbeatEvent::Restarted => self.lose(params),
                HeartbeatEvent::Found(_) if self.told.is_none() => self.values.emcy.clear(),
                HeartbeatEvent::Found(_) | HeartbeatEvent::Entered(_) => {}
            }
            return true;
        }
        if node != self.node() {
            return false;
        }
        match service {
            Service::SdoRequest if self.nmt.state().allows_sdo() => {
                let mut served = Served {
                    values: &mut self.values,
                    params,
                };
                if let Some(answer) = self.sdo.receive(frame, &mut served) {
                    self.answer(answer);
                }
            }
            Service::Rpdo1 | Service::Rpdo2 | Service::Rpdo3 | Service::Rpdo4
                if self.nmt.state().allows_pdo() =>
            {
                self.process(service, frame, params);
            }
            // Only a node with this number sends these frames, and this is the board itself.
            Service::Tpdo1 | Service::Heartbeat | Service::SdoReply | Service::Emcy => {
                self.values.command(Command::Halt(Code::NodeTwice));
            }
            _ => {}
        }
        true
    }

    /// The handwheel at the board's own input. True where it asks for anything.
    pub fn own_wheel(&mut self, count: u16, params: &Params) -> bool {
        self.values.own_wheel(count, params)
    }

    /// Somebody has sent a frame of CAN FD with this identifier. No such frame is for a board, but it may have setpoints
    /// of another node for the board's drives.
    pub fn receive_fd(&mut self, id: CobId, params: &Params) {
        if self.has_joined()
            && let Some(intrusion) = self.setpoints_of_others(id, params)
        {
            self.resist(intrusion);
        }
    }

    /// Takes an event of the tick: every event, in order.
    pub fn note(&mut self, event: &Event) {
        self.values.log.push(self.values.tick, event);
        self.values.recorder.note(event);
        if let Event::Aux(Aux::T(code)) = event {
            self.values.in_place = self.values.in_place.after(*code);
        }
        if let Event::Reset | Event::Finished | Event::Alarm(_) | Event::Refused(_) = event {
            self.values.program_buffer.close();
            self.values.operating.end_by_wheel();
        }
    }

    /// Sets the error of the axis that is held to the spindle; `None`: no axis is held.
    pub const fn set_measured(&mut self, measured: Option<Measured>) {
        self.values.measured = measured;
    }

    /// Sets the number of setpoints that were late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.values.late = late;
    }

    /// Runs the device. `elapsed`: time since the last call; the present tick side; `offer` takes a call and returns false
    /// where it has no room. Returns true where a call was taken.
    pub fn poll(
        &mut self,
        elapsed: Periods,
        snapshot: Snapshot,
        params: &Params,
        offer: &mut impl FnMut(&Call) -> bool,
    ) -> bool {
        // 64 bits of ticks do not overflow.
        self.values.tick = self.values.tick.wrapping_add(elapsed.get().into());
        self.values.forget_marks(snapshot.referenced);
        if !snapshot.is_at_rest() {
            self.drives_move_for = drives_lag(params).plus(Periods::new(1));
        } else if self.values.snapshot.is_at_rest() {
            // Not where rest has just begun: nobody knows in which of these periods.
            self.drives_move_for = self.drives_move_for.minus(elapsed);
        }
        self.values.snapshot = snapshot;
        self.values.elapse(elapsed, params);
        let (measured, late) = (self.values.measured.as_ref(), self.values.late);
        if elapsed != Periods::new(0) {
            // Only a network asks for the hash, which takes time.
            if self.joined {
                self.values.recorder.write(elapsed, &snapshot);
            }
            self.values
                .recorder
                .judge(elapsed, &snapshot, measured, late, params);
        }
        if !snapshot.takes_calls() {
            self.values.program_buffer.close();
        }
        // A set that is being stored comes into force while the machine stands.
        let worked = !self.is_changing() && self.values.program_buffer.hand_over(offer);
        let stands = self.drives_stand() && !self.values.is_about_to_move();
        if self.restarts && stands && !self.is_changing() {
            self.restart(params);
        }
        if !self.has_joined() {
            return worked;
        }
        self.values.protection.elapse(elapsed, params);
        self.watch_bus(elapsed, params);
        self.tell_alarms();
        self.transfer(elapsed, params);
        self.heartbeat(elapsed, params);
        self.serve_block(elapsed, params);
        self.tell_status(elapsed, params);
        worked
    }

    /// True where the drives have been told where they stand, and have had the dead time to do it: a drive does
    /// later by its latency what it is told (9003), and a board that began anew at once would throw away the end
    /// of its stop.
    #[must_use]
    pub const fn drives_stand(&self) -> bool {
        self.drives_move_for.get() == 0
    }

    /// True where the node is to be reset, and waits until the machine stands.
    #[must_use]
    pub const fn will_restart(&self) -> bool {
        self.restarts
    }

    /// True where the program runs and its next part has not come: in lock-step, time waits for it.
    #[must_use]
    pub const fn awaits_program(&self) -> bool {
        self.values.program_buffer.awaits_more()
    }

    /// True where a gateway that reads the certificates of threads (5042h), and is present, would miss a certificate if
    /// time went on: in lock-step, time waits.
    #[must_use]
    pub fn awaits_reader(&self) -> bool {
        let watch = &self.values.watch;
        let is_there = |gateway: HeartbeatWatch| watch.state(gateway.node).is_some();
        let full = self.values.snapshot.in_program && self.values.recorder.threads.is_full();
        full && watch.get(0).is_some_and(is_there)
    }

    /// The certificates of the last threads, the newest first.
    pub fn threads(&self) -> impl Iterator<Item = ThreadCertificate> {
        self.values.recorder.threads.certificates()
    }

    /// True while a transfer is under way. In virtual time its client is only as fast as virtual time.
    #[must_use]
    pub const fn is_transferring(&self) -> bool {
        self.sdo.is_busy()
    }

    /// The next command for the tick. Read all of them after every [`receive`](Self::receive) and [`poll`](Self::poll).
    pub fn command(&mut self) -> Option<Command> {
        self.values.commands.pop_front()
    }

    /// What is asked of the axes by hand, once. Read it after the commands.
    pub const fn asked(&mut self) -> Option<Asked> {
        self.values.operating.take()
    }

    /// How far a handwheel has been turned that leads the program, once.
    pub fn turned(&mut self) -> Option<Length> {
        self.values.operating.take_turned()
    }

    /// The board's time, as TPDO5 tells it.
    #[must_use]
    pub const fn beat(&self) -> Beat {
        self.values.operating.beat()
    }

    /// The mode of the machine.
    #[must_use]
    pub const fn mode(&self) -> OperatingMode {
        self.values.operating.mode()
    }

    /// The inputs, if they were set over the bus.
    pub const fn signals(&mut self) -> Option<Signals> {
        self.values.signals.take()
    }

    /// True, once, where the tap journal's record must be dropped.
    pub const fn drops_tap(&mut self) -> bool {
        core::mem::replace(&mut self.values.drops_tap, false)
    }

    /// A parameter set that comes into force. The owner restarts the application with it. The machine stands.
    pub fn take_params(&mut self) -> Option<&Params> {
        self.values.take_params()
    }
}

/// How long after its setpoints the last drive stands, in whole ticks.
fn drives_lag(params: &Params) -> Periods {
    let latency = Axis::ALL
        .map(|axis| params.latency_us(axis))
        .into_iter()
        .max();
    let lag = latency.and_then(|us| Periods::from_ms(us.div_ceil(1000), params.tick_us()));
    // Without a tick nothing has moved.
    lag.unwrap_or_default()
}
