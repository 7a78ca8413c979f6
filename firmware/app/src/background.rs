//! The background's side: the bus, planning and the storage, a piece at a time.

use heapless::spsc::{Consumer, Producer};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::queue::{put, room, take};
use leadscrew_core::board::{
    Background, Command, DetourIn, Event, Held, Notice, Region, SegmentIn, Snapshot, State,
    StoreError, StoreRequest, TickPort, Ticker,
};
use leadscrew_core::bus::{Controller, Frame, Periods};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::motion::{Epoch, Setpoint};
use leadscrew_core::params::Params;
use leadscrew_core::program::Call;
use leadscrew_core::signals::Signals;

use crate::queues::PowerUp;
use crate::report::{Order, Report};

/// Orders that any one piece of work asks for at most.
const SPARE_ORDERS: usize = 3;

/// What a board brings for the background. Nothing may wait longer than a few
/// milliseconds: planning stands still meanwhile.
pub trait Machine {
    /// The oldest frame from the bus not yet read. Drives' frames need not come this way.
    fn receive(&mut self) -> Option<Frame>;
    /// True where there is room for a frame to be sent, behind those of the tick.
    fn has_room(&self) -> bool;
    /// Sends a frame. There is room.
    fn send(&mut self, frame: &Frame);
    /// Begins to store: its bytes are put into a buffer of the board's. The one before is done.
    fn store(&mut self, request: &StoreRequest<'_>);
    /// Goes on with it; once it is done, how it went.
    fn stored(&mut self) -> Option<Result<(), StoreError>>;
    /// Reads a region of the storage, and gives what it holds to `then`, once.
    fn load(&mut self, region: Region, then: &mut dyn FnMut(Held<'_>));
    /// Something has happened: for a log, and for what a board switches.
    fn event(&mut self, event: &Event);
    /// How the CAN controller is.
    fn controller(&mut self) -> Controller;
    /// Takes part in the bus again, behind bus-off or where it has stopped sending: the machine stands, and its drives
    /// have been let go.
    fn rejoin(&mut self);
    /// The application begins anew with these parameters, the time between two SYNCs among them.
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
    /// What is being stored.
    storing: Option<Region>,
    ends: Ends,
    /// The tick side, as it was told last.
    snapshot: Snapshot,
    background: Background,
}

/// What is asked of the tick side goes through a queue.
struct Port<'a> {
    orders: &'a mut Producer<'static, Order>,
    takes_calls: bool,
}

impl Port<'_> {
    fn order(&mut self, order: Order) {
        // Whoever asks has seen that there is room.
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

    // Its pieces are functions of their own: what one needs on the stack, the others have no use for.

    /// One piece of everything there is to do. False where there is nothing until the next tick or the next frame.
    pub fn step(&mut self, machine: &mut impl Machine) -> bool {
        let report = take(&mut self.ends.reports);
        // All that was said before that report, and perhaps more.
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
    /// room for it now, or while the machine starts, stops or stands on an alarm.
    #[must_use]
    pub fn offer(&mut self, call: &Call) -> bool {
        let mut port = Port {
            takes_calls: self.snapshot.takes_calls() && !self.renewing,
            orders: &mut self.ends.orders,
        };
        self.background.offer(call, &mut port)
    }

    /// True where a program runs whose next call has not come, and there would be room for it. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.background.awaits_program()
    }

    /// True while anything handed over has not been carried out, as far as is known here.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let at_rest = matches!(self.snapshot.state, State::Idle | State::Alarm(_));
        !at_rest || self.background.is_planning() || self.background.is_storing() || self.renewing
    }

    /// The tick side, as it was told last.
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

    /// A controller that has left the bus stays away until the machine stands [D124].
    #[inline(never)]
    fn look_at_bus(&mut self, machine: &mut impl Machine) {
        self.background.set_controller(machine.controller());
        self.carry_out();
        if self.background.device().may_rejoin() {
            machine.rejoin();
        }
    }

    /// New entries of the tap journal.
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
        // What it has said last is part of what is forgotten.
        while take(&mut self.ends.notices).is_some() {}
        let found = self.background.device().found();
        if let Some(position) = ticker.begin_anew(self.background.params(), found) {
            self.background.begin_anew(position);
            machine.begin_anew(self.background.params());
        }
        self.snapshot = Snapshot::new(ticker, &Setpoint::default(), self.snapshot.contacts);
        self.renewing = false;
        // There is one ticker and room for it; should that ever fail, nothing moves any more.
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
        // What has been handed over counts, also where the tick has not seen it yet.
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
            // The tick side is away: it can be asked for nothing.
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
