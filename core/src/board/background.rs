//! The background half of a board: it plans, stores, and speaks on the bus.
//!
//! ```text
//! frames ◄─► Device ─ calls ─► Planner ─ segments ─► (the tick side)
//!               │                    ▲                        │
//!               └── orders ──────────┼───► TickPort ──────────┘
//!                                    └──── notices, entries, snapshots
//! ```
//!
//! The owner runs the background in turn with the tick side, or in a context of its own. What the background wants of the
//! tick goes through a [`TickPort`]; what the tick has to say, the owner hands in. Knows nothing of how either travels.

use super::device::Device;
use super::event::{Command, Event};
use super::kept::{Held, PowerUp};
use super::operator::Operator;
use super::planner::{Planner, Settings};
use super::queue::{Calls, DetourIn, SegmentIn};
use super::reference::Measured;
use super::request::{Content, StoreRequest};
use super::snapshot::Snapshot;
use super::store::{Region, StoreError};
use super::ticker::Notice;
use crate::alarm::Alarm;
use crate::bus::FdFrame;
use crate::bus::{Controller, Frame, NodeId, Periods};
use crate::journal::TapRecord;
use crate::motion::{Epoch, Limits};
use crate::params::Params;
use crate::program::{Call, Position};
use crate::signals::Signals;

/// What the background asks of the tick side. Everything acts in the next tick, in the order in which it was asked for.
pub trait TickPort {
    /// True where there is room for a [`command`](Self::command) and two more wishes.
    fn has_room(&self) -> bool;
    /// As [`Ticker::takes_calls`](super::Ticker::takes_calls).
    fn takes_calls(&self) -> bool;
    /// As [`Ticker::program_begins`](super::Ticker::program_begins), if what is planned in this epoch still counts.
    fn program_begins(&mut self, epoch: Epoch);
    /// As [`Ticker::command`](super::Ticker::command).
    fn command(&mut self, command: Command);
    /// As [`Ticker::signals`](super::Ticker::signals).
    fn signals(&mut self, signals: Signals);
    /// As [`Ticker::discard_tap`](super::Ticker::discard_tap).
    fn discard_tap(&mut self);
    /// As [`Ticker::stored`](super::Ticker::stored).
    fn stored(&mut self, sequence: u32, result: Result<(), StoreError>);
}

/// The background half.
#[derive(Debug)]
pub struct Background {
    journal: Entries,
    limits: Limits,
    device: Device,
    planner: Planner,
    params: Params,
    calls: Calls,
}

/// The tap journal on its way from the tick to the storage.
#[derive(Debug)]
struct Entries {
    /// The newest entry.
    newest: Option<TapRecord>,
    /// It has not been asked for yet.
    wanted: bool,
    /// The entry that is being stored.
    under_way: Option<u32>,
}

/// Puts a call on its way. False, and nothing changes, where that does not go.
fn offer(port: &mut impl TickPort, calls: &mut Calls, epoch: Epoch, call: &Call) -> bool {
    let taken = port.takes_calls() && port.has_room() && calls.enqueue(*call).is_ok();
    if taken {
        port.program_begins(epoch);
    }
    taken
}

impl Background {
    /// As at power-up: at `position`, with the stored entry of the tap journal, and `snapshot` of the tick side.
    // Written straight to where it will be, which the caller says: as a function of
    // its own it would be copied there [D146].
    #[must_use]
    #[inline(always)]
    pub fn new(
        params: &Params,
        position: Position,
        tap: Option<TapRecord>,
        snapshot: Snapshot,
    ) -> Self {
        Self {
            device: Device::new(NodeId::BOARD, params, snapshot),
            params: params.clone(),
            limits: Limits::from_params(params),
            calls: Calls::new(),
            planner: Planner::new(position),
            journal: Entries {
                newest: tap,
                wanted: false,
                under_way: None,
            },
        }
    }

    /// Takes what was found of the parameters at power-up; the tick side is to
    /// [withhold](super::Ticker::withhold) motion by it, now and whenever it begins anew.
    pub fn power_up(&mut self, up: &PowerUp) {
        self.device.power_up(up);
    }

    /// Sets the serial number of 1018h.
    pub const fn set_serial(&mut self, serial: u32) {
        self.device.set_serial(serial);
    }

    /// Says whether the controller sends frames of CAN FD. A board whose controller does not takes no set that asks for
    /// them.
    pub const fn set_fd(&mut self, sends_fd: bool) {
        self.device.set_fd(sends_fd);
    }

    /// Joins a network as `node`: from now on it hears and says something. An NMT master starts it.
    ///
    /// # Errors
    /// [`Code::BusOverload`](crate::alarm::Code::BusOverload) where the cycle leaves no room on the bus;
    /// [`Code::DriveNodeOfBoard`](crate::alarm::Code::DriveNodeOfBoard) where a drive has this number.
    pub fn join(&mut self, node: NodeId) -> Result<(), Alarm> {
        self.device.set_node(node);
        self.device.join(&self.params)
    }

    /// What the tick has said; it comes before everything else the background does, and after the entry of the same tick.
    pub fn heed(&mut self, notice: &Notice, detours: &mut DetourIn<'_>) {
        let (_, mut calls) = self.calls.split();
        let tap = self.journal.newest.as_ref();
        self.planner
            .heed(notice, &mut calls, detours, &self.limits, tap);
    }

    /// A new entry of the tap journal: of those not yet stored only the newest counts.
    pub const fn enter(&mut self, record: TapRecord) {
        self.journal.newest = Some(record);
        self.journal.wanted = true;
    }

    /// Hands a call over. False, and nothing changes, where there is no room for it now, or while the machine starts, stops
    /// or stands on an alarm: whatever it is given then belongs to what has to be forgotten.
    #[must_use]
    pub fn offer(&mut self, call: &Call, port: &mut impl TickPort) -> bool {
        !self.device.is_changing() && offer(port, &mut self.calls, self.planner.epoch(), call)
    }

    /// One piece of planning: false where there is none that can be done now. A warning comes back too. `begun`: the oldest
    /// of the segments is under way.
    pub fn plan(
        &mut self,
        segments: &mut SegmentIn<'_>,
        operator: &Operator,
        begun: bool,
    ) -> (bool, Option<Alarm>) {
        let settings = Settings {
            params: &self.params,
            limits: &self.limits,
            spindle_percent: operator.spindle_percent(),
            begun,
            signals: operator.signals,
            tap: self.journal.newest.as_ref(),
        };
        let (_, mut calls) = self.calls.split();
        self.planner.step(&mut calls, segments, &settings)
    }

    /// Takes a frame from the bus. True where it is not for the board as a node: it belongs to the tick side. What it asks
    /// for waits for [`carry_out`](Self::carry_out).
    #[must_use]
    pub fn receive(&mut self, frame: &Frame) -> bool {
        !self.device.receive(frame, &self.params)
    }

    /// Takes a frame of CAN FD from the bus.
    pub fn receive_fd(&mut self, frame: &FdFrame) {
        self.device.receive_fd(frame, &self.params);
    }

    /// Lets the device go on: `elapsed` periods after the last call; `measured` as
    /// the [`Reference`](super::Reference) says of the last of them. True where a call
    /// went to the planner. What it asks for waits for [`carry_out`](Self::carry_out).
    pub fn serve(
        &mut self,
        elapsed: Periods,
        snapshot: Snapshot,
        measured: Option<Measured>,
        port: &mut impl TickPort,
    ) -> bool {
        if elapsed != Periods::new(0) {
            self.device.set_measured(measured);
        }
        let (calls, epoch) = (&mut self.calls, self.planner.epoch());
        let mut offer = |call: &_| offer(port, calls, epoch, call);
        self.device
            .poll(elapsed, snapshot, &self.params, &mut offer)
    }

    /// Carries out what the device asks for. True where a parameter set came with it: it is in force here, and the owner
    /// restarts the tick side with [`params`](Self::params), then says so with [`begin_anew`](Self::begin_anew).
    #[must_use]
    pub fn carry_out(&mut self, port: &mut impl TickPort) -> bool {
        while port.has_room()
            && let Some(command) = self.device.command()
        {
            port.command(command);
        }
        if port.has_room()
            && let Some(signals) = self.device.signals()
        {
            port.signals(signals);
        }
        if port.has_room() && self.device.drops_tap() {
            // Refused at the bus where that does not go.
            port.discard_tap();
        }
        let Some(params) = self.device.take_params() else {
            return false;
        };
        self.params.clone_from(params);
        self.limits = Limits::from_params(&self.params);
        true
    }

    /// The tick side has begun anew: from `position`, as far as that is known.
    pub fn begin_anew(&mut self, position: Option<Position>) {
        self.calls = Calls::new();
        self.planner
            .begin_anew(position.unwrap_or_default(), Epoch::default());
    }

    /// What is to be stored now: to be given back by [`stored`](Self::stored). `None` where nothing is, or where the last
    /// write has not been answered yet; of entries that come meanwhile only the newest counts.
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        match self.journal.newest.as_ref() {
            Some(record) if self.journal.wanted && self.journal.under_way.is_none() => {
                self.journal.wanted = false;
                self.journal.under_way = Some(record.sequence);
                Some(StoreRequest {
                    region: Region::TapJournal,
                    content: Content::Tap(record.encode()),
                })
            }
            _ => self.device.store(),
        }
    }

    /// A region that is to be read now: what it holds is to be given back by [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.device.load()
    }

    /// What the region holds that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Held<'_>) {
        self.device.loaded(held);
    }

    /// The last write that [`store`](Self::store) asked for has been done, or could not be. A parameter set may come
    /// with it: [`carry_out`](Self::carry_out) says so.
    pub fn stored(
        &mut self,
        region: Region,
        result: Result<(), StoreError>,
        port: &mut impl TickPort,
    ) {
        match region {
            Region::TapJournal => {
                if let Some(sequence) = self.journal.under_way.take() {
                    port.stored(sequence, result);
                }
            }
            Region::ParametersA | Region::ParametersB | Region::ParametersMark => {
                self.device.has_stored(region, result);
            }
        }
    }

    /// The newest entry of the tap journal, stored or on its way there.
    #[must_use]
    pub const fn tap_record(&self) -> Option<&TapRecord> {
        self.journal.newest.as_ref()
    }

    /// Takes what has happened: every event, in order.
    pub fn note(&mut self, event: &Event) {
        self.device.note(event);
    }

    /// The next frame of the device to send.
    pub fn transmit(&mut self) -> Option<Frame> {
        self.device.transmit()
    }

    /// True while a call has not been planned and handed over.
    #[must_use]
    pub fn is_planning(&self) -> bool {
        self.planner.is_busy() || !self.calls.is_empty()
    }

    /// True while an entry of the tap journal, or a change of the parameter set, is not known to be stored.
    #[must_use]
    pub fn is_storing(&self) -> bool {
        self.journal.wanted || self.journal.under_way.is_some() || self.device.is_changing()
    }

    /// True while a transfer is under way.
    #[must_use]
    pub const fn is_transferring(&self) -> bool {
        self.device.is_transferring()
    }

    /// True where a program runs whose next call has not come, and there would be room for it, or whose gateway has to take
    /// what would be overwritten. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.device.awaits_program() && !self.calls.is_full() || self.device.awaits_reader()
    }

    /// Says how many setpoints have come late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.device.set_late(late);
    }

    /// Says how the CAN controller is; see [`Device::set_controller`]. What it asks for waits for
    /// [`carry_out`](Self::carry_out).
    pub fn set_controller(&mut self, controller: Controller) {
        self.device.set_controller(controller, &self.params);
    }

    /// The board as a node.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// The parameter set in force.
    #[must_use]
    pub const fn params(&self) -> &Params {
        &self.params
    }

    /// The limits in force.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }
}
