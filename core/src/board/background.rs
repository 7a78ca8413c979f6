//! The background side of a board: it plans, stores parameters, and communicates on the bus, a small piece of work at a
//! time.
//!
//! ```text
//! frames ◄─► Device ─ calls ─► Planner ─ segments ─► (the tick side)
//!              │                  ▲                        │
//!              └── orders ────────┼────────────────────────┤
//!                                 └── notices, entries, ───┘
//!                                     events, reports
//!
//! hear ─► event until there is none ─► receive each frame ─► serve ─► plan ─► store, load ─► transmit
//! ```
//!
//! Firmware runs this in a context of its own; an owner with one thread runs it in turn with the tick side. It knows the
//! tick side as that was last reported. It must not know hardware, sockets, clocks or flash.

mod carry_out;
mod orders;
mod press;
mod store;

use self::orders::Orders;
use super::device::Device;
use super::kept::PowerUp;
use super::planner::{Calls, Planner, Settings};
use super::store::Region;
use crate::alarm::Alarm;
use crate::bus::{CobId, Controller, DataRates, Frame, NodeId, Periods};
use crate::call::{Call, Position};
use crate::journal::TapRecord;
use crate::link::Event;
use crate::motion::Limits;
use crate::operating::OperatingMode;
use crate::params::Params;
use crate::tick::queue::{drop_oldest, take};
use crate::tick::{BackgroundEnds, Measured, Snapshot, State};

/// The state of the background side.
#[derive(Debug)]
pub struct Background {
    /// The tick side as last reported.
    pub(super) snapshot: Snapshot,
    /// The oldest segment is under way, as last reported.
    begun: bool,
    /// Of the reports that the device has not seen: SYNC periods, and the last error.
    elapsed: u32,
    /// All SYNC periods so far; it wraps.
    now: u32,
    measured: Option<Measured>,
    orders: Orders,
    /// The set in force is not on its way to the tick yet: an earlier one is.
    setup_waits: bool,
    /// The application has begun anew, and the owner does not know.
    has_begun_anew: bool,
    journal: Entries,
    /// What is being stored.
    storing: Option<Region>,
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

/// The background side: its state and its ends of the queues.
pub struct BackgroundSide<'a> {
    state: &'a mut Background,
    ends: BackgroundEnds<'a>,
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
            snapshot,
            begun: false,
            elapsed: 0,
            now: 0,
            measured: None,
            orders: Orders::default(),
            setup_waits: false,
            has_begun_anew: false,
            storing: None,
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

    /// Takes what was found of the parameters at power-up. The tick side's [`Setup`](super::Setup) has to say the same.
    pub fn power_up(&mut self, up: &PowerUp) {
        self.device.power_up(up);
    }

    /// Takes how often each page of the storage has been erased, where it has become more.
    pub fn set_erases(&mut self, erases: u32) {
        self.device.set_erases(erases);
    }

    /// Sets the serial number of 1018h.
    pub const fn set_serial(&mut self, serial: u32) {
        self.device.set_serial(serial);
    }

    /// Says at which rates the controller can send the data of CAN FD frames. The board refuses a set that asks for
    /// another one.
    pub const fn set_data_rates(&mut self, rates: DataRates) {
        self.device.set_data_rates(rates);
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

    /// Takes an event that no tick has made.
    pub fn note(&mut self, event: &Event) {
        self.device.note(event);
    }

    /// The tick side, as last reported.
    #[must_use]
    pub const fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// The newest entry of the tap journal, stored or on its way there.
    #[must_use]
    pub const fn tap_record(&self) -> Option<&TapRecord> {
        self.journal.newest.as_ref()
    }

    /// True where the next call of a running program has not come and would have room, or where the gateway must read what
    /// would be overwritten. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.device.awaits_program() && !self.calls.is_full() || self.device.awaits_reader()
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

    /// The next frame of the device to send.
    pub fn transmit(&mut self) -> Option<Frame> {
        self.device.transmit()
    }

    /// True while work is under way in the background or in the tick, as far as the background knows. What waits in the
    /// queues comes on top.
    pub(super) fn is_busy(&self) -> bool {
        let at_rest = matches!(self.snapshot.state, State::Idle | State::Alarm(_));
        let is_storing =
            self.journal.wanted || self.journal.under_way.is_some() || self.device.is_changing();
        let waits = self.is_planning() || self.is_renewing();
        !at_rest
            || is_storing
            || waits
            || self.orders.wait()
            || self.device.will_restart()
            || self.snapshot.operator.reset_waits()
    }

    /// True while a call has not been planned and queued.
    fn is_planning(&self) -> bool {
        self.planner.is_busy() || !self.calls.is_empty()
    }

    /// True while the tick has not begun anew with the set in force: nothing is planned meanwhile.
    const fn is_renewing(&self) -> bool {
        self.orders.begin_anew() || self.setup_waits
    }

    /// What comes is a line that was typed.
    fn is_mdi(&self) -> bool {
        self.device.mode() == OperatingMode::Mdi
    }

    /// True where the machine takes calls, as far as the background knows.
    const fn takes_calls(&self) -> bool {
        self.snapshot.takes_calls() && !self.is_renewing()
    }
}

impl<'a> BackgroundSide<'a> {
    /// The side with this state.
    #[inline]
    pub const fn new(state: &'a mut Background, ends: BackgroundEnds<'a>) -> Self {
        Self { state, ends }
    }

    /// Its state, to read from.
    #[must_use]
    pub const fn state(&self) -> &Background {
        self.state
    }

    /// Its state, for the work that needs no queue.
    pub const fn state_mut(&mut self) -> &mut Background {
        self.state
    }

    /// Hears what the tick has told: one report, and everything that was told before it. True where there was a report.
    #[inline(never)]
    pub fn hear(&mut self) -> bool {
        // Looked at while it is in the queue: it is large.
        let report = self.ends.reports.peek();
        let heard = report.is_some();
        if let Some(report) = report {
            let state = &mut *self.state;
            state.snapshot = report.snapshot;
            state.begun = report.begun;
            state.elapsed = state.elapsed.saturating_add(report.elapsed);
            state.now = state.now.wrapping_add(report.elapsed);
            state.measured = report.measured;
            state.has_begun_anew |= state.orders.hear(report.orders);
            state.device.set_late(report.late);
            drop_oldest(&mut self.ends.reports);
        }
        // Takes everything that was told before that report, and perhaps more.
        while let Some(notice) = take(&mut self.ends.notices) {
            // The entry of the same tick goes first.
            self.enter();
            let state = &mut *self.state;
            let (_, mut calls) = state.calls.split();
            let tap = state.journal.newest.as_ref();
            let detours = &mut self.ends.detours;
            state
                .planner
                .heed(&notice, &mut calls, detours, &state.limits, tap);
        }
        self.enter();
        heard
    }

    /// Takes new entries of the tap journal. Of those that are not stored yet, only the newest counts.
    #[inline(never)]
    fn enter(&mut self) {
        while let Some(record) = take(&mut self.ends.entries) {
            self.state.journal.newest = Some(record);
            self.state.journal.wanted = true;
        }
    }

    /// The tick's oldest event that was not read yet.
    pub fn event(&mut self) -> Option<Event> {
        let event = take(&mut self.ends.events)?;
        self.state.device.note(&event);
        Some(event)
    }

    /// The parameter set, once, after the application has begun anew with it. It includes the time between two SYNCs.
    pub const fn begun_anew(&mut self) -> Option<&Params> {
        let state = &mut *self.state;
        let has_begun = core::mem::replace(&mut state.has_begun_anew, false);
        if !has_begun || state.snapshot.state.stays_at_rest() {
            return None;
        }
        Some(&state.params)
    }

    /// Takes a frame from the bus. True for a frame of the tick side.
    #[must_use]
    pub fn receive(&mut self, frame: &Frame) -> bool {
        let taken = self.state.device.receive(frame, &self.state.params);
        self.carry_out();
        !taken
    }

    /// The handwheel at the board's own input stands at `count`, which wraps; 9048 says which inputs choose what it leads.
    pub fn own_wheel(&mut self, count: u16) {
        if self.state.device.own_wheel(count, &self.state.params) {
            self.carry_out();
        }
    }

    /// Somebody has sent a frame of CAN FD with this identifier.
    pub fn receive_fd(&mut self, id: CobId) {
        self.state.device.receive_fd(id, &self.state.params);
        self.carry_out();
    }

    /// Sets the state of the CAN controller; see [`Device::set_controller`]. True where a controller that has left the bus
    /// may be started again: only after the machine has come to rest [D124].
    pub fn set_controller(&mut self, controller: Controller) -> bool {
        let state = &mut *self.state;
        state.device.set_controller(controller, &state.params);
        self.carry_out();
        self.state.device.may_rejoin()
    }

    /// Runs the device, for the periods that were reported since the last call. True where there was anything to do until
    /// the next report or the next frame.
    #[inline(never)]
    pub fn serve(&mut self) -> bool {
        let mut worked = false;
        while let Some(frame) = take(&mut self.ends.strangers) {
            // What is not for the board as a node is a drive's, and has gone to the tick.
            let _ = self.receive(&frame);
            worked = true;
        }
        let state = &mut *self.state;
        let elapsed = Periods::new(core::mem::take(&mut state.elapsed));
        if elapsed != Periods::new(0) {
            state.device.set_measured(state.measured.take());
        }
        // A call that has been handed over counts, even where the tick has not seen it yet.
        let mut snapshot = state.snapshot;
        snapshot.in_program |=
            snapshot.takes_calls() && (state.is_planning() || state.orders.begin_program());
        let takes_calls = state.takes_calls();
        let work = (state.planner.epoch(), state.is_mdi());
        let (orders, calls) = (&mut state.orders, &mut state.calls);
        let ends = &mut self.ends;
        let mut offer = |call: &_| takes_calls && orders.offer(ends, calls, work, call);
        worked |= state
            .device
            .poll(elapsed, snapshot, &state.params, &mut offer);
        self.carry_out();
        worked
    }

    /// Hands a call over. False, and nothing changes, where there is no room now, or while the machine starts, stops or
    /// stands on an alarm, because such a call would have to be dropped.
    #[must_use]
    pub fn offer(&mut self, call: &Call) -> bool {
        let state = &mut *self.state;
        let takes_calls = state.takes_calls() && !state.device.is_changing();
        let work = (state.planner.epoch(), state.is_mdi());
        takes_calls
            && state
                .orders
                .offer(&mut self.ends, &mut state.calls, work, call)
    }

    /// Does one piece of planning. False where no planning can be done now. Returns a warning too.
    #[inline(never)]
    pub fn plan(&mut self) -> (bool, Option<Event>) {
        let state = &mut *self.state;
        if state.is_renewing() {
            return (false, None);
        }
        let operator = &state.snapshot.operator;
        let settings = Settings {
            params: &state.params,
            limits: &state.limits,
            spindle_percent: operator.spindle_percent(),
            begun: state.begun,
            signals: operator.signals,
            tap: state.journal.newest.as_ref(),
            tool: state.device.in_place(),
            offsets: state.device.offsets(),
            now: state.now,
        };
        let (_, mut calls) = state.calls.split();
        let (worked, warning) = state
            .planner
            .step(&mut calls, &mut self.ends.segments, &settings);
        let warning = warning.map(Event::Warning);
        if let Some(warning) = &warning {
            state.device.note(warning);
        }
        (worked, warning)
    }

    /// True while a call or a request that was handed over is not carried out, as far as the background knows.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.state.is_busy() || self.ends.segments.filled() > 0
    }
}
