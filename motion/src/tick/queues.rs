//! Everything that the two contexts of a board share: single-producer queues, and nothing else.
//!
//! | datum | from | to | where the queue is full |
//! |---|---|---|---|
//! | segments, detours | background | tick | wait in the background |
//! | orders: commands, inputs, answers of the storage, a new beginning | background | tick | wait in the background |
//! | setups: what the tick needs of another parameter set | background | tick | never full |
//! | events | tick | background | the newest is lost |
//! | entries of the tap journal | tick | background | wait in the tick; only the newest counts |
//! | notices: start again from here, plan a way | tick | background | wait in the tick; only the newest counts |
//! | strangers: frames that are not a drive's | tick | background | the newest is lost, as on a flooded bus |
//! | reports: the tick side after each tick | tick | background | this report is lost; the next counts its periods too |
//!
//! Neither side takes a lock, and the tick never waits.

use heapless::spsc::{Consumer, Producer, Queue};

use super::message::{Order, Report};
use super::queue::{DetourIn, Detours, Events, SegmentIn, Segments};
use super::ticker::{Ends as TickerEnds, Notice, Setup};
use crate::bus::Frame;
use crate::journal::TapRecord;
use crate::motion::Press;
use crate::tick::Event;

// One place of a ring stays empty.
const ORDERS: usize = 17;
const SETUPS: usize = 2;
/// Presses: a press and its renewals, and the place that stays empty.
const PRESSES: usize = 4;
/// The reports that wait at most, and the place that stays empty.
const REPORTS: usize = 4;
const ENTRIES: usize = 3;
const NOTICES: usize = 3;
const STRANGERS: usize = 17;

/// The queues between the two contexts of a board. In firmware they lie in a `static`.
#[derive(Debug)]
pub struct Queues {
    segments: Segments,
    detours: Detours,
    orders: Queue<Order, ORDERS>,
    setups: Queue<Setup, SETUPS>,
    presses: Queue<Press, PRESSES>,
    events: Events,
    entries: Queue<TapRecord, ENTRIES>,
    notices: Queue<Notice, NOTICES>,
    strangers: Queue<Frame, STRANGERS>,
    reports: Queue<Report, REPORTS>,
}

/// The ends that the tick side owns.
pub struct TickEnds<'q> {
    pub(super) ticker: TickerEnds<'q>,
    pub(super) orders: Consumer<'q, Order>,
    pub(super) setups: Consumer<'q, Setup>,
    pub(super) presses: Consumer<'q, Press>,
    pub(super) entries: Producer<'q, TapRecord>,
    pub(super) notices: Producer<'q, Notice>,
    pub(super) strangers: Producer<'q, Frame>,
    pub(super) reports: Producer<'q, Report>,
}

/// The ends that the background side owns.
pub struct BackgroundEnds<'q> {
    /// Planned segments go in here.
    pub segments: SegmentIn<'q>,
    /// Ways away from the contour and back go in here.
    pub detours: DetourIn<'q>,
    /// Orders go in here.
    pub orders: Producer<'q, Order>,
    /// What the tick needs of another parameter set goes in here.
    pub setups: Producer<'q, Setup>,
    /// Presses of jog, and their renewals, go in here.
    pub presses: Producer<'q, Press>,
    /// Events come out here.
    pub events: Consumer<'q, Event>,
    /// Entries of the tap journal come out here.
    pub entries: Consumer<'q, TapRecord>,
    /// Notices to the planner come out here.
    pub notices: Consumer<'q, Notice>,
    /// Frames that are not of a drive come out here.
    pub strangers: Consumer<'q, Frame>,
    /// The tick side after each tick comes out here.
    pub reports: Consumer<'q, Report>,
}

impl Queues {
    /// Empty queues.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            segments: Segments::new(),
            detours: Detours::new(),
            orders: Queue::new(),
            setups: Queue::new(),
            presses: Queue::new(),
            events: Events::new(),
            entries: Queue::new(),
            notices: Queue::new(),
            strangers: Queue::new(),
            reports: Queue::new(),
        }
    }

    /// Segments that are planned and not begun.
    #[must_use]
    pub const fn segments(&self) -> &Segments {
        &self.segments
    }

    /// The ends of both sides.
    pub fn split(&mut self) -> (TickEnds<'_>, BackgroundEnds<'_>) {
        let (segments_in, segments_out) = self.segments.split();
        let (detours_in, detours_out) = self.detours.split();
        let (orders_in, orders_out) = self.orders.split();
        let (setups_in, setups_out) = self.setups.split();
        let (presses_in, presses_out) = self.presses.split();
        let (events_in, events_out) = self.events.split();
        let (entries_in, entries_out) = self.entries.split();
        let (notices_in, notices_out) = self.notices.split();
        let (strangers_in, strangers_out) = self.strangers.split();
        let (reports_in, reports_out) = self.reports.split();
        let tick = TickEnds {
            ticker: TickerEnds {
                segments: segments_out,
                detours: detours_out,
                events: events_in,
            },
            orders: orders_out,
            setups: setups_out,
            presses: presses_out,
            entries: entries_in,
            notices: notices_in,
            strangers: strangers_in,
            reports: reports_in,
        };
        let background = BackgroundEnds {
            segments: segments_in,
            detours: detours_in,
            orders: orders_in,
            setups: setups_in,
            presses: presses_in,
            events: events_out,
            entries: entries_out,
            notices: notices_out,
            strangers: strangers_out,
            reports: reports_out,
        };
        (tick, background)
    }
}

impl Default for Queues {
    fn default() -> Self {
        Self::new()
    }
}
