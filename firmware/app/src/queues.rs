//! The queues between the two sides, and how a board comes up.

use core::mem::MaybeUninit;

use heapless::spsc::Queue;
use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::{
    self, Contacts, Detours, Event, Events, Notice, Segments, Snapshot, Ticker,
};
use leadscrew_core::bus::{Frame, NodeId};
use leadscrew_core::call::Position;
use leadscrew_core::journal::TapRecord;
use leadscrew_core::motion::Setpoint;

use crate::background::{BackgroundSide, Ends as BackgroundEnds};
use crate::failure::Failure;
use crate::report::{Order, Report};
use crate::reset::ResetCause;
use crate::tick::{Ends as TickEnds, TickSide};

// One place of a ring stays empty.
const ORDERS: usize = 17;
const REPORTS: usize = 4;
const ENTRIES: usize = 3;
const NOTICES: usize = 3;
const STRANGERS: usize = 17;
const LOANS: usize = 2;

/// Everything that the two sides share. It belongs in a `static`.
pub struct Queues {
    segments: Segments,
    detours: Detours,
    events: Events,
    orders: Queue<Order, ORDERS>,
    reports: Queue<Report, REPORTS>,
    entries: Queue<TapRecord, ENTRIES>,
    notices: Queue<Notice, NOTICES>,
    strangers: Queue<Frame, STRANGERS>,
    given: Queue<&'static mut Ticker, LOANS>,
    returned: Queue<&'static mut Ticker, LOANS>,
}

/// The memory of the tick's side, for good: also a `static`.
pub type TickPlace = MaybeUninit<TickSide>;
/// The memory of a ticker, for good: also a `static`.
pub type TickerPlace = MaybeUninit<Ticker>;
/// The memory of the background's side, for good: also a `static`.
pub type BackgroundPlace = MaybeUninit<BackgroundSide>;

/// What a board has to know at power-up.
#[derive(Clone, Copy, Debug)]
pub struct PowerUp<'a> {
    /// The parameter set, and what is to be reported about it.
    pub set: &'a board::PowerUp,
    /// Where the machine stood, if known; see [`Ticker::new`].
    pub remembered: Option<Position>,
    /// The stored entry of the tap journal.
    pub tap: Option<TapRecord>,
    /// The board's node number on the bus.
    pub node: NodeId,
    /// The board's serial number (1018h:04); 0: none.
    pub serial: u32,
    /// The CAN controller sends frames of CAN FD. Otherwise a set with 9031 = 1 is refused.
    pub fd: bool,
    /// Why the board stopped the last time. Nothing moves before a reset, or any more where the failure is final.
    pub failure: Option<Failure>,
    /// Why the processor started.
    pub cause: ResetCause,
}

impl Queues {
    /// Empty queues.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            segments: Segments::new(),
            detours: Detours::new(),
            events: Events::new(),
            orders: Queue::new(),
            reports: Queue::new(),
            entries: Queue::new(),
            notices: Queue::new(),
            strangers: Queue::new(),
            given: Queue::new(),
            returned: Queue::new(),
        }
    }

    /// Brings a board up, as its two sides. It has joined the bus: an NMT master starts it.
    ///
    /// # Errors
    /// [`Code::ParametersUnusable`] for a set that does not pass its own checks; [`Code::BusOverload`] where the set's
    /// cycle leaves no room on the bus; [`Code::DriveNodeOfBoard`] where a drive has the board's number.
    pub fn power_up(
        &'static mut self,
        tick: &'static mut TickPlace,
        place: &'static mut TickerPlace,
        background: &'static mut BackgroundPlace,
        up: &PowerUp<'_>,
    ) -> Result<(&'static mut TickSide, &'static mut BackgroundSide), Alarm> {
        let ticker = new_ticker(place, up)?;
        let (segments_in, segments_out) = self.segments.split();
        let (detours_in, detours_out) = self.detours.split();
        let (events_in, events_out) = self.events.split();
        let (orders_in, orders_out) = self.orders.split();
        let (reports_in, reports_out) = self.reports.split();
        let (entries_in, entries_out) = self.entries.split();
        let (notices_in, notices_out) = self.notices.split();
        let (strangers_in, strangers_out) = self.strangers.split();
        let (given_in, given_out) = self.given.split();
        let (returned_in, returned_out) = self.returned.split();
        let snapshot = Snapshot::new(ticker, &Setpoint::default(), Contacts::default());
        let tick = tick.write(TickSide::new(
            ticker,
            TickEnds {
                segments: segments_out,
                detours: detours_out,
                events: events_in,
                orders: orders_out,
                reports: reports_in,
                entries: entries_in,
                notices: notices_in,
                strangers: strangers_in,
                given: given_in,
                returned: returned_out,
            },
        ));
        let background = new_background(
            background,
            up,
            snapshot,
            BackgroundEnds {
                segments: segments_in,
                detours: detours_in,
                events: events_out,
                orders: orders_in,
                reports: reports_out,
                entries: entries_out,
                notices: notices_out,
                strangers: strangers_out,
                given: given_out,
                returned: returned_in,
            },
        );
        background.background().power_up(up.set);
        if up.failure.is_none()
            && let Some(warning) = up.cause.warning()
        {
            background.background().note(&Event::Warning(warning));
        }
        background.background().set_serial(up.serial);
        background.background().set_fd(up.fd);
        background.background().join(up.node)?;
        Ok((tick, background))
    }
}

// A function of its own makes each of the two, in its final place. The stack has no room for a copy of one, nor for the
// working space of both at once [D146].

#[inline(never)]
fn new_ticker(
    place: &'static mut TickerPlace,
    up: &PowerUp<'_>,
) -> Result<&'static mut Ticker, Alarm> {
    let Some(ticker) = Ticker::put(place, &up.set.params, up.remembered, up.tap) else {
        return Err(Alarm::new(Code::ParametersUnusable, Span::default()));
    };
    ticker.withhold(up.set.found);
    if let Some(failure) = up.failure {
        ticker.begin_in_alarm(failure.alarm());
    }
    Ok(ticker)
}

#[inline(never)]
fn new_background(
    place: &'static mut BackgroundPlace,
    up: &PowerUp<'_>,
    snapshot: Snapshot,
    ends: BackgroundEnds,
) -> &'static mut BackgroundSide {
    place.write(BackgroundSide::new(up, snapshot, ends))
}

impl Default for Queues {
    fn default() -> Self {
        Self::new()
    }
}
