//! The background half of a board: it plans, stores parameters, and communicates on the bus.
//!
//! ```text
//! frames ◄─► Device ─ calls ─► Planner ─ segments ─► (the tick side)
//!              │                  ▲                        │
//!              └── orders ────────┼───► TickPort ──────────┘
//!                                 └──── notices, entries, snapshots
//! ```
//!
//! The owner runs the background in turn with the tick side, or in a context of its own. The background's requests to the
//! tick go through a [`TickPort`]; the owner hands the tick's messages to the background. Knows nothing of how either
//! travels.

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
use crate::call::{Call, Position};
use crate::journal::TapRecord;
use crate::motion::{Epoch, Limits};
use crate::params::Params;
use crate::signals::Signals;

/// Requests of the background to the tick side. Each acts in the next tick, in the order of the requests.
pub trait TickPort {
    /// True where there is room for a [`command`](Self::command) and two more requests.
    fn has_room(&self) -> bool;
    /// As [`Ticker::takes_calls`](super::Ticker::takes_calls).
    fn takes_calls(&self) -> bool;
    /// As [`Ticker::program_begins`](super::Ticker::program_begins), if segments of this epoch still count.
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
    /// The entry has not been given to the storage yet.
    wanted: bool,
    /// The entry that is being stored.
    under_way: Option<u32>,
}

/// Hands a call over to the planner. Returns false and changes nothing where that is not possible.
fn offer(port: &mut impl TickPort, calls: &mut Calls, epoch: Epoch, call: &Call) -> bool {
    let taken = port.takes_calls() && port.has_room() && calls.enqueue(*call).is_ok();
    if taken {
        port.program_begins(epoch);
    }
    taken
}

impl Background {
    /// The state at power-up: at `position`, with the stored entry of the tap journal and a `snapshot` of the tick side.
    // Written straight to the place that the caller names. As a function of its own, the value would be copied there
    // [D146].
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

    /// Takes what was found of the parameters at power-up. The tick side must [withhold](super::Ticker::withhold) motion
    /// accordingly, now and whenever it starts again.
    pub fn power_up(&mut self, up: &PowerUp) {
        self.device.power_up(up);
    }

    /// Sets the serial number of 1018h.
    pub const fn set_serial(&mut self, serial: u32) {
        self.device.set_serial(serial);
    }

    /// Says whether the controller sends frames of CAN FD. A board without such a controller refuses a set that asks for
    /// them.
    pub const fn set_fd(&mut self, sends_fd: bool) {
        self.device.set_fd(sends_fd);
    }

    /// Joins a network as `node`: from now on the board hears and sends frames. An NMT master starts it.
    ///
    /// # Errors
    /// [`Code::BusOverload`](crate::alarm::Code::BusOverload) where the cycle leaves no room on the bus;
    /// [`Code::DriveNodeOfBoard`](crate::alarm::Code::DriveNodeOfBoard) where a drive has this number.
    pub fn join(&mut self, node: NodeId) -> Result<(), Alarm> {
        self.device.set_node(node);
        self.device.join(&self.params)
    }

    /// Takes a message of the tick. The background obeys it before any other work, and after the journal's entry of the
    /// same tick.
    pub fn heed(&mut self, notice: &Notice, detours: &mut DetourIn<'_>) {
        let (_, mut calls) = self.calls.split();
        let tap = self.journal.newest.as_ref();
        self.planner
            .heed(notice, &mut calls, detours, &self.limits, tap);
    }

    /// Takes a new entry of the tap journal. Of the entries that are not stored yet, only the newest counts.
    pub const fn enter(&mut self, record: TapRecord) {
        self.journal.newest = Some(record);
        self.journal.wanted = true;
    }

    /// Hands a call over. Returns false and changes nothing where there is no room now, or while the machine starts, stops
    /// or stands on an alarm, because such a call would have to be dropped.
    #[must_use]
    pub fn offer(&mut self, call: &Call, port: &mut impl TickPort) -> bool {
        !self.device.is_changing() && offer(port, &mut self.calls, self.planner.epoch(), call)
    }

    /// Does one piece of planning. False where no planning can be done now. Returns a warning too. `begun`: the oldest
    /// segment is under way.
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

    /// Takes a frame from the bus. True for a frame of the tick side. Requests of the frame wait for
    /// [`carry_out`](Self::carry_out).
    #[must_use]
    pub fn receive(&mut self, frame: &Frame) -> bool {
        !self.device.receive(frame, &self.params)
    }

    /// Takes a frame of CAN FD from the bus.
    pub fn receive_fd(&mut self, frame: &FdFrame) {
        self.device.receive_fd(frame, &self.params);
    }

    /// Runs the device, `elapsed` periods after the last call. `measured`: what the [`Reference`](super::Reference) says of
    /// the last period. True where a call went to the planner. Requests wait for [`carry_out`](Self::carry_out).
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

    /// Carries out the device's requests. True where a parameter set came with them: the set is in force here. The owner
    /// then restarts the tick side with [`params`](Self::params) and calls [`begin_anew`](Self::begin_anew).
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
            // Where this is not possible, the device has refused it already.
            port.discard_tap();
        }
        let Some(params) = self.device.take_params() else {
            return false;
        };
        self.params.clone_from(params);
        self.limits = Limits::from_params(&self.params);
        true
    }

    /// The tick side has started again, at `position` if it is known.
    pub fn begin_anew(&mut self, position: Option<Position>) {
        self.calls = Calls::new();
        self.planner
            .begin_anew(position.unwrap_or_default(), Epoch::default());
    }

    /// The next write for the storage; the owner answers it with [`stored`](Self::stored). `None` where nothing is to be
    /// stored, or where the last write has not been answered yet. Of entries that come meanwhile, only the newest counts.
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

    /// The next region to read; the owner answers with [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.device.load()
    }

    /// The content of the region that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Held<'_>) {
        self.device.loaded(held);
    }

    /// The last write of [`store`](Self::store) has been done, or has failed. A parameter set may come into force with it:
    /// [`carry_out`](Self::carry_out) says so.
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

    /// Takes an event. The owner hands over every event, in order.
    pub fn note(&mut self, event: &Event) {
        self.device.note(event);
    }

    /// The next frame of the device to send.
    pub fn transmit(&mut self) -> Option<Frame> {
        self.device.transmit()
    }

    /// True while a call has not been planned and queued.
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

    /// True where the next call of a running program has not come and would have room, or where the gateway must read what
    /// would be overwritten. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.device.awaits_program() && !self.calls.is_full() || self.device.awaits_reader()
    }

    /// Sets the number of setpoints that were late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.device.set_late(late);
    }

    /// Sets the state of the CAN controller; see [`Device::set_controller`]. Requests wait for
    /// [`carry_out`](Self::carry_out).
    pub fn set_controller(&mut self, controller: Controller) {
        self.device.set_controller(controller, &self.params);
    }

    /// The board as a CANopen device.
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
