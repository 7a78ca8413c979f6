//! The background's side: the services on the bus, the planning and the storage, a small piece of work at a time.

use heapless::spsc::{Consumer, Producer};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::queue::{put, room, take};
use leadscrew_core::board::{
    Background, Command, DetourIn, Event, Held, Notice, Region, SegmentIn, Snapshot, State,
    StoreError, StoreRequest, TickPort, Ticker,
};
use leadscrew_core::bus::{Controller, Frame, Periods};
use leadscrew_core::call::Call;
use leadscrew_core::journal::TapRecord;
use leadscrew_core::motion::{Epoch, Setpoint};
use leadscrew_core::params::Params;
use leadscrew_core::signals::Signals;

use crate::queues::PowerUp;
use crate::report::{Order, Report};

/// The most orders that one piece of work asks for.
const SPARE_ORDERS: usize = 3;

/// The hardware that a board provides to the background. No function may wait longer than a few milliseconds: planning
/// stands still meanwhile.
pub trait Machine {
    /// The oldest frame from the bus that is not yet read. Frames of drives need not come this way.
    fn receive(&mut self) -> Option<Frame>;
    /// True where there is room for a frame. It leaves after the frames of the tick.
    fn has_room(&self) -> bool;
    /// Sends a frame. There is room.
    fn send(&mut self, frame: &Frame);
    /// Begins to store: the board copies the bytes into a buffer of its own. The previous request is done.
    fn store(&mut self, request: &StoreRequest<'_>);
    /// Continues to store. Gives the result once the request is done.
    fn stored(&mut self) -> Option<Result<(), StoreError>>;
    /// Reads a region of the storage and calls `then` once with its content.
    fn load(&mut self, region: Region, then: &mut dyn FnMut(Held<'_>));
    /// Tells the board an event: for a log, and for the board's switches.
    fn event(&mut self, event: &Event);
    /// The state of the CAN controller.
    fn controller(&mut self) -> Controller;
    /// Takes part in the bus again, after bus-off or where the controller has stopped sending. The machine stands, and
    /// its drives have been let go.
    fn rejoin(&mut self);
    /// The application begins anew with these parameters. They include the time between two SYNCs.
    fn begin_anew(&mut self, params: &Params);
}

/// The ends of the queues that this side owns.
pub(crate) struct Ends {
    pub segments: SegmentIn<'static>,
    pub detours: DetourIn<'static>,
    pub events: Consumer<'static, Event>,
    pub orders: Producer<'static, Order>,
    pub reports: Consumer<'static, Report>,
    pub entries: Consumer<'static, TapRecord>,
    pub notices: Consumer<'static, Notice>,
    pub strangers: Consumer<'static, Frame>,
    pub given: Consumer<'static, &'static mut Ticker>,
    pub returned: Producer<'static, &'static mut Ticker>,
}

/// The background's side of a board.
pub struct BackgroundSide {
    begun: bool,
    /// The ticker is being made anew: nothing is planned meanwhile.
    renewing: bool,
    /// The region that is being stored.
    storing: Option<Region>,
    ends: Ends,
    /// The tick side, as last reported.
    snapshot: Snapshot,
    background: Background,
}

/// The background's way to ask the tick side: a queue of orders.
struct Port<'a> {
    orders: &'a mut Producer<'static, Order>,
    takes_calls: bool,
}

impl Port<'_> {
    fn order(&mut self, order: Order) {
        // The caller has seen that there is room.
        let _ = put(self.orders, order);
    }
}

impl TickPort for Port<'_> {
    fn has_room(&self) -> bool {
        room(self.orders) >= SPARE_ORDERS
    }

    fn takes_calls(&self) -> bool {
        self.takes_calls
    }

    fn program_begins(&mut self, epoch: Epoch) {
        self.order(Order::ProgramBegins(epoch));
    }

    fn command(&mut self, command: Command) {
        self.order(Order::Command(command));
    }

    fn signals(&mut self, signals: Signals) {
        self.order(Order::Signals(signals));
    }

    fn discard_tap(&mut self) {
        self.order(Order::DiscardTap);
    }

    fn stored(&mut self, sequence: u32, result: Result<(), StoreError>) {
        self.order(Order::Stored(sequence, result));
    }
}

impl BackgroundSide {
    #[inline(always)]
    pub(crate) fn new(up: &PowerUp<'_>, snapshot: Snapshot, ends: Ends) -> Self {
        let position = up.remembered.unwrap_or_default();
        Self {
            background: Background::new(&up.set.params, position, up.tap, snapshot),
            ends,
            snapshot,
            begun: false,
            renewing: false,
            storing: None,
        }
    }

    pub(crate) const fn background(&mut self) -> &mut Background {
        &mut self.background
    }

    // The pieces of `step` are functions of their own, so that each needs stack only while it runs.

    /// Does one piece of each kind of work. False where there is nothing to do until the next tick or the next frame.
    pub fn step(&mut self, machine: &mut impl Machine) -> bool {
        let report = take(&mut self.ends.reports);
        // Takes everything that was sent before that report, and perhaps more.
        self.hear(machine);
        self.renew(machine);
        let mut worked = report.is_some();
        if worked && room(&self.ends.orders) > SPARE_ORDERS {
            // There is room.
            let _ = put(&mut self.ends.orders, Order::Alive);
        }
        worked |= self.receive(machine);
        if report.is_some() {
            self.look_at_bus(machine);
        }
        worked |= self.serve(report);
        worked |= self.plan(machine);
        worked |= self.store(machine);
        while machine.has_room()
            && let Some(frame) = self.background.transmit()
        {
            machine.send(&frame);
        }
        worked
    }

    /// Hands a call over, for a board that runs a program of its own. False, and nothing changes, where there is no
    /// room now, or while the machine starts, stops or stands on an alarm.
    #[must_use]
    pub fn offer(&mut self, call: &Call) -> bool {
        let mut port = Port {
            takes_calls: self.snapshot.takes_calls() && !self.renewing,
            orders: &mut self.ends.orders,
        };
        self.background.offer(call, &mut port)
    }

    /// True where a running program has not given its next call, and there is room for it. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.background.awaits_program()
    }

    /// True while a call or a request that was handed over is not carried out, as far as the background knows.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let at_rest = matches!(self.snapshot.state, State::Idle | State::Alarm(_));
        !at_rest || self.background.is_planning() || self.background.is_storing() || self.renewing
    }

    /// The tick side, as last reported.
    #[must_use]
    pub const fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    #[inline(never)]
    fn hear(&mut self, machine: &mut impl Machine) {
        while let Some(notice) = take(&mut self.ends.notices) {
            self.enter();
            self.background.heed(&notice, &mut self.ends.detours);
        }
        self.enter();
        while let Some(event) = take(&mut self.ends.events) {
            self.background.note(&event);
            machine.event(&event);
        }
    }

    /// A controller that has left the bus joins again only after the machine has come to rest [D124].
    #[inline(never)]
    fn look_at_bus(&mut self, machine: &mut impl Machine) {
        self.background.set_controller(machine.controller());
        self.carry_out();
        if self.background.device().may_rejoin() {
            machine.rejoin();
        }
    }

    /// Takes new entries of the tap journal.
    fn enter(&mut self) {
        while let Some(entry) = take(&mut self.ends.entries) {
            self.background.enter(entry);
        }
    }

    /// Makes the ticker anew where it has been handed over.
    #[inline(never)]
    fn renew(&mut self, machine: &mut impl Machine) {
        let Some(ticker) = take(&mut self.ends.given) else {
            return;
        };
        // The old ticker's last notices go with it.
        while take(&mut self.ends.notices).is_some() {}
        let found = self.background.device().found();
        if let Some(position) = ticker.begin_anew(self.background.params(), found) {
            self.background.begin_anew(position);
            machine.begin_anew(self.background.params());
        }
        self.snapshot = Snapshot::new(ticker, &Setpoint::default(), self.snapshot.contacts);
        self.renewing = false;
        // There is one ticker and room for it. Should this ever fail, nothing moves any more.
        let _ = put(&mut self.ends.returned, ticker);
    }

    #[inline(never)]
    fn receive(&mut self, machine: &mut impl Machine) -> bool {
        let mut worked = false;
        while let Some(frame) = take(&mut self.ends.strangers).or_else(|| machine.receive()) {
            // What is not for the board as a node is a drive's, and has gone to the tick.
            let _ = self.background.receive(&frame);
            self.carry_out();
            worked = true;
        }
        worked
    }

    #[inline(never)]
    fn serve(&mut self, report: Option<Report>) -> bool {
        let (mut elapsed, mut measured) = (0, None);
        if let Some(report) = report {
            (elapsed, measured) = (report.elapsed, report.measured);
            self.background.set_late(report.late);
            if !self.renewing {
                self.snapshot = report.snapshot;
                self.begun = report.begun;
            }
        }
        // A call that has been handed over counts, even where the tick has not seen it yet.
        let mut snapshot = self.snapshot;
        snapshot.in_program |= snapshot.takes_calls() && self.background.is_planning();
        let mut port = Port {
            orders: &mut self.ends.orders,
            takes_calls: self.snapshot.takes_calls() && !self.renewing,
        };
        let worked = self
            .background
            .serve(Periods::new(elapsed), snapshot, measured, &mut port);
        self.carry_out();
        worked
    }

    #[inline(never)]
    fn carry_out(&mut self) {
        if self.renewing {
            // The ticker is here to be made anew: the tick side takes no orders.
            return;
        }
        let mut port = Port {
            orders: &mut self.ends.orders,
            takes_calls: false,
        };
        if port.has_room() && self.background.carry_out(&mut port) {
            self.renewing = true;
            port.order(Order::HandOver);
        }
    }

    #[inline(never)]
    fn plan(&mut self, machine: &mut impl Machine) -> bool {
        if self.renewing {
            return false;
        }
        let (worked, warning) =
            self.background
                .plan(&mut self.ends.segments, &self.snapshot.operator, self.begun);
        if let Some(warning) = warning {
            self.warn(warning, machine);
        }
        worked
    }

    #[inline(never)]
    fn warn(&mut self, warning: Alarm, machine: &mut impl Machine) {
        let event = Event::Warning(warning);
        self.background.note(&event);
        machine.event(&event);
    }

    #[inline(never)]
    fn store(&mut self, machine: &mut impl Machine) -> bool {
        let mut port = Port {
            orders: &mut self.ends.orders,
            takes_calls: false,
        };
        if let Some(region) = self.storing {
            // The answer needs room.
            if !port.has_room() {
                return false;
            }
            let Some(result) = machine.stored() else {
                return false;
            };
            self.storing = None;
            self.background.stored(region, result, &mut port);
        }
        if let Some(region) = self.background.load() {
            machine.load(region, &mut |held| self.background.loaded(held));
        }
        let Some(request) = self.background.store() else {
            return false;
        };
        self.storing = Some(request.region);
        machine.store(&request);
        true
    }
}
