//! The board as a CANopen node: objects, process data, heartbeats, emergencies. Sans-IO, and in the background: the tick
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
//! - What an operator wants (RPDO1, 5000h) becomes [`Command`]s at once: it never waits behind a transfer.
//! - A program comes in small batches (5020h) and waits, encoded, in [`PROGRAM_BYTES`]; `run` lets its calls go to the
//!   planner one by one [D98]. How many bytes fit is told in TPDO1, so a program of any size goes through [D99].
//! - Parameters (2000h, 5010h) are staged, checked as a set, stored, and come into force all or none, with a restart of
//!   the application [D101], [D116].
//!
//! The owner of a device gives it every frame that is not a drive's, every event, and a snapshot of the tick side as
//! often as possible, and takes commands, a changed parameter set and frames from it. [`Board`](super::Board) does all of
//! that for owners with one thread.
//!
//! It must not know motion, drives or what a call means.

mod accessors;
mod change;
pub mod dictionary;
mod health;
mod item;
mod log;
mod obey;
pub mod objects;
mod parameter_store;
mod program_buffer;
mod protection;
mod recorder;
mod ring;
mod served;
mod table;
mod tell;
mod threads;
mod values;

pub use parameter_store::CommitState;
pub use program_buffer::PROGRAM_BYTES;
pub use table::{DROP, GROUPS, Group, HISTORY, LOAD, PRODUCT, SAVE};

use heapless::Deque;

use self::served::Served;
use self::values::ObjectValues;
use super::event::{Command, Event};
use super::kept::{Found, PowerUp};
use super::nodes::DriveNodes;
use super::reference::Measured;
use super::request::StoreRequest;
use super::snapshot::Snapshot;
use super::store::{Region, StoreError};
use super::trouble::Intrusion;
use crate::alarm::{Alarm, Code};
use crate::bus::FdFrame;
use crate::bus::{
    BlockSize, CobId, Controller, Cycle, Frame, HeartbeatEvent, HeartbeatWatch, NmtSlave, NmtState,
    NodeId, OrderGate, Periods, SdoServer, Service,
};
use crate::link::ThreadCertificate;
use crate::params::Params;
use crate::program::Call;
use crate::signals::Signals;

/// Frames that wait to be sent: statuses, heartbeats, emergencies.
const URGENT: usize = 12;
/// Answers of the SDO server that wait to be sent.
const ANSWERS: usize = 16;
/// For so long a client may be silent in a transfer.
const PATIENCE_MS: u32 = 1000;
/// Drives that get a setpoint in every tick: X, Z, C and one spindle.
const DRIVES: u32 = 4;

/// A board's side of the bus, but for its drives.
#[derive(Debug)]
pub struct Device {
    nmt: NmtSlave,
    /// It is on a network, starting again or not.
    joined: bool,
    sdo: SdoServer,
    patience: Periods,
    gate: OrderGate,
    /// Since the last of TPDO1–3.
    since: [Periods; 3],
    /// The alarm that has been told: an emergency message says no more than its number.
    told: Option<Code>,
    /// A restart of the application is asked for; it waits until the machine stands.
    restarts: bool,
    /// The CAN controller.
    controller: Controller,
    /// Late setpoints are counted from here: how many there had been, and how long ago.
    lateness: (u32, Periods),
    urgent: Deque<Frame, URGENT>,
    answers: Deque<Frame, ANSWERS>,
    values: ObjectValues,
}

impl Device {
    /// A node that has not joined a network: it hears nothing and says nothing.
    // Written straight to where it will be, which the caller says: as a function of
    // its own it would be copied there [D146].
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
            since: [Periods::new(0); 3],
            urgent: Deque::new(),
            answers: Deque::new(),
            told: None,
            restarts: false,
            controller: Controller::default(),
            lateness: (0, Periods::new(0)),
        }
    }

    /// Takes what was found at power-up. Once, before it joins.
    pub fn power_up(&mut self, up: &PowerUp) {
        self.values.parameter_store.power_up(up);
    }

    /// What was found at power-up, or has been decided since: the tick side withholds motion by it.
    #[must_use]
    pub const fn found(&self) -> Found {
        self.values.parameter_store.found()
    }

    /// A change of the parameter set is being stored, or waits to be taken: no call goes to the planner.
    #[must_use]
    pub fn is_changing(&self) -> bool {
        self.values.is_changing()
    }

    /// How the last change of the parameter set ended: 5010h:02.
    #[must_use]
    pub const fn commit_state(&self) -> CommitState {
        self.values.parameter_store.state()
    }

    /// The region that has to be read now; its bytes are given back by [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.values.parameter_store.load()
    }

    /// What the region holds that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Result<Option<&[u8]>, StoreError>) {
        self.values.loaded(held);
    }

    /// What is to be stored now; the end is told by [`has_stored`](Self::has_stored).
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        self.values.store()
    }

    /// The write that [`store`](Self::store) asked for has been done, or could not be. A set that is stored is behind
    /// [`take_params`](Self::take_params).
    pub fn has_stored(&mut self, region: Region, result: Result<(), StoreError>) {
        self.values.has_stored(region, result);
    }

    /// Takes another number. Only before it joins.
    pub fn set_node(&mut self, node: NodeId) {
        if self.has_joined() {
            return;
        }
        self.nmt = NmtSlave::new(node);
        self.sdo = SdoServer::new(node, self.patience, BlockSize::MAX);
        self.values.set_node(node);
    }

    /// Joins the network: says so, and waits to be started.
    ///
    /// # Errors
    /// [`Code::BusOverload`] where the cycle leaves no room on the bus; [`Code::DriveNodeOfBoard`] where a drive has its
    /// number.
    pub fn join(&mut self, params: &Params) -> Result<(), Alarm> {
        let cycle = Cycle {
            tick_us: params.tick_us(),
            kbit: params.bus_kbit(),
            drives: DRIVES,
            further: u32::from(params.tap_spindles()).saturating_sub(1),
            drive_syncs: params.drive_status_syncs(),
            status_ms: params.status_period_ms(),
            fd_kbit: if params.setpoint_frame() == 1 {
                params.fd_kbit()
            } else {
                0
            },
        };
        cycle.check()?;
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

    /// The number others reach it by.
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

    /// Says whether the controller sends frames of CAN FD. A board whose controller does not takes no set that asks for
    /// them.
    pub const fn set_fd(&mut self, sends_fd: bool) {
        self.values.sends_fd = sends_fd;
    }

    /// Takes a frame. False for one that is not for a board: a drive's, or of a service it does not have.
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
            if let Some(event) = self.nmt.receive(frame) {
                self.obey(event, params);
            }
            return true;
        }
        let Some((service, node)) = frame.id().service() else {
            return false;
        };
        if node == NodeId::GATEWAY && service == Service::Heartbeat
            || node == self.node() && service == Service::SdoRequest
        {
            self.values.protection.hear();
        }
        if let Some((_, event)) = self.values.watch.receive(frame) {
            match event {
                // Whoever fed the program has forgotten it.
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
            Service::Rpdo1 if self.nmt.state().allows_pdo() => self.command_of(frame),
            // Only a node of this number sends these, and that is this one.
            Service::Tpdo1 | Service::Heartbeat | Service::SdoReply | Service::Emcy => {
                self.values.command(Command::Halt(Code::NodeTwice));
            }
            _ => {}
        }
        true
    }

    /// Takes a frame of CAN FD. Nothing in one is for a board; it can be setpoints of somebody else for its drives.
    pub fn receive_fd(&mut self, frame: &FdFrame, params: &Params) {
        if self.has_joined()
            && let Some(intrusion) = self.setpoints_of_others(frame.id(), params)
        {
            self.resist(intrusion);
        }
    }

    /// Takes what has happened in the tick: every event, in order.
    pub fn note(&mut self, event: &Event) {
        self.values.log.push(self.values.tick, event);
        self.values.recorder.note(event);
        if let Event::Reset | Event::Finished | Event::Alarm(_) = event {
            self.values.program_buffer.close();
        }
    }

    /// Says how far the axis that is held to the spindle was from where it should have been; `None`: none is held.
    pub const fn set_measured(&mut self, measured: Option<Measured>) {
        self.values.measured = measured;
    }

    /// Says how many setpoints have come late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.values.late = late;
    }

    /// Goes on: `elapsed` since the last call, the tick side as it is now, and where calls go; `offer` says whether it took
    /// one. True where a call went.
    pub fn poll(
        &mut self,
        elapsed: Periods,
        snapshot: Snapshot,
        params: &Params,
        offer: &mut impl FnMut(&Call) -> bool,
    ) -> bool {
        // Ticks do not come to the end of 64 bits.
        self.values.tick = self.values.tick.wrapping_add(elapsed.get().into());
        self.values.snapshot = snapshot;
        let (measured, late) = (self.values.measured.as_ref(), self.values.late);
        if elapsed != Periods::new(0) {
            // Nobody else asks for the hash, which takes its time.
            if self.joined {
                self.values.recorder.write(elapsed, &snapshot);
            }
            self.values.recorder.judge(&snapshot, measured, late);
        }
        if !snapshot.takes_calls() {
            self.values.program_buffer.close();
        }
        // A set that is on its way comes into force while the machine stands.
        let worked = !self.values.is_changing() && self.values.program_buffer.hand_over(offer);
        if self.restarts && snapshot.is_at_rest() && !self.values.is_changing() {
            self.restart(params);
        }
        if !self.has_joined() {
            return worked;
        }
        self.values.protection.elapse(elapsed, params);
        self.watch_bus(elapsed, params);
        self.tell_alarms();
        self.transfer(elapsed, params);
        self.beat(elapsed, params);
        self.tell_status(elapsed, params);
        worked
    }

    /// True where the program is running and the rest of it has not come: in lock-step, time waits for it.
    #[must_use]
    pub const fn awaits_program(&self) -> bool {
        self.values.program_buffer.awaits_more()
    }

    /// True where a gateway that takes the certificates of threads (5042h), and is
    /// there, would miss one if time went on: in lock-step, time waits.
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

    /// True while a transfer is under way: in virtual time, its client can only be as fast as it is.
    #[must_use]
    pub const fn is_transferring(&self) -> bool {
        self.sdo.is_busy()
    }

    /// The next command for the tick. Read all of them after every [`receive`](Self::receive) and [`poll`](Self::poll).
    pub fn command(&mut self) -> Option<Command> {
        self.values.commands.pop_front()
    }

    /// The inputs, where they have been set over the bus.
    pub const fn signals(&mut self) -> Option<Signals> {
        self.values.signals.take()
    }

    /// True, once, where the tap journal's record is to be dropped.
    pub const fn drops_tap(&mut self) -> bool {
        core::mem::replace(&mut self.values.drops_tap, false)
    }

    /// A parameter set that is to come into force: the owner restarts the application with it. The machine stands.
    pub fn take_params(&mut self) -> Option<&Params> {
        self.values.take_params()
    }
}
