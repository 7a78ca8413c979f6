//! The board: calls, frames and encoder samples in; frames, events and setpoints out. Sans-IO.
//!
//! Two contexts. The **tick** ([`Ticker`], one SYNC period, bounded) observes the spindle, supervises the drives, executes
//! segments and makes frames. The **background** ([`Background`]) communicates on the bus ([`Device`]), stores parameters,
//! and expands and plans calls ([`Planner`]). Single-producer queues join the two contexts. In the other direction goes one
//! message: start again from here, or plan this way. A planned segment carries the [`Epoch`] in which it was planned, and
//! the tick drops segments that are older than its last start, so the two contexts need not agree on the moment. The
//! background obeys the tick's message before it takes further calls.
//!
//! ```text
//!          calls          segments                       SYNC, RPDOs
//! gateway ──────► Planner ────────► Ticker ────────────────────► drives
//!                    ▲                │ ▲
//!                    └──── notice ────┘ └── encoder sample, TPDOs
//! ```
//!
//! Terms: a *period* is the time between two SYNCs; a *setpoint* computed in period k takes effect at SYNC(k+1) plus the
//! drive's latency; the board *pauses* between segments (single block) and *holds* anywhere (feed hold).
//!
//! It must not know hardware, sockets, clocks or flash.

mod background;
mod detour;
pub mod device;
mod drives;
mod event;
mod guard;
mod kept;
mod node;
mod nodes;
mod operator;
mod planner;
pub mod queue;
mod reference;
mod request;
mod snapshot;
mod spindles;
mod store;
mod ticker;
mod trouble;

pub use background::{Background, TickPort};
pub use detour::Route;
pub use device::Device;
pub use drives::FRAMES;
pub use event::{Command, Event, Switching};
pub use guard::Guard;
pub use kept::{Found, Held, KeptError, KeptSet, Mark, PowerUp, Slot};
pub use nodes::DriveNodes;
pub use operator::{Operator, overridden};
pub use planner::{Planner, Settings};
pub use reference::{Measured, Reference};
pub use request::StoreRequest;
pub use snapshot::{Contacts, Snapshot};
pub use store::{Region, StoreError};
pub use ticker::{Ends, Notice, Outcome, Output, State, Ticker};
pub use trouble::{BusTrouble, Intrusion, Victim};

use crate::alarm::{Alarm, Code, Span};
use crate::bus::Frame;
use crate::call::{Call, Position};
use crate::journal::TapRecord;
use crate::motion::{Epoch, Helix, Law, Limits, Setpoint, TapLine};
use crate::params::Params;
use crate::signals::Signals;
use crate::spindle::EncoderSample;
pub use queue::{Calls, DetourIn, DetourOut, Detours, Events, SegmentIn, SegmentOut, Segments};

/// A motion board with both contexts, called in turn from one thread (simulation, tests). Firmware runs the same two halves
/// in two contexts.
#[derive(Debug)]
pub struct Board {
    segments: Segments,
    detours: Detours,
    events: Events,
    ticker: Ticker,
    background: Background,
    /// The data for judging the next measured angle.
    reference: Reference,
}

/// With one thread there is no queue between the two halves.
impl TickPort for Ticker {
    fn has_room(&self) -> bool {
        true
    }

    fn takes_calls(&self) -> bool {
        Self::takes_calls(self)
    }

    fn program_begins(&mut self, epoch: Epoch) {
        if epoch == self.epoch() {
            Self::program_begins(self);
        }
    }

    fn command(&mut self, command: Command) {
        Self::command(self, command);
    }

    fn signals(&mut self, signals: Signals) {
        Self::signals(self, signals);
    }

    fn discard_tap(&mut self) {
        // Where this is not possible, nothing changes.
        let _ = Self::discard_tap(self);
    }

    fn stored(&mut self, sequence: u32, result: Result<(), StoreError>) {
        Self::stored(self, sequence, result);
    }
}

impl Board {
    /// A board at power-up. `remembered`: the last position of the machine, if known; it counts where the drives' positions
    /// agree with it to their increment. `tap`: the stored entry of the tap journal. If it says that a tap is in its hole,
    /// the reference of the tap axis counts as lost: whatever its drive says, the axis stands at the bottom [D26].
    ///
    /// # Errors
    /// [`Code::ParametersUnusable`] for a set that does not pass its own checks.
    pub fn new(
        params: &Params,
        remembered: Option<Position>,
        tap: Option<TapRecord>,
    ) -> Result<Self, Alarm> {
        let Some(ticker) = Ticker::new(params, remembered, tap) else {
            return Err(Alarm::new(Code::ParametersUnusable, Span::default()));
        };
        let snapshot = Snapshot::new(&ticker, &Setpoint::default(), Contacts::default());
        Ok(Self {
            background: Background::new(params, remembered.unwrap_or_default(), tap, snapshot),
            reference: Reference::default(),
            segments: Segments::new(),
            detours: Detours::new(),
            events: Events::new(),
            ticker,
        })
    }

    /// A board at power-up with its stored parameters. It starts with that set. If the set is faulty, an alarm withholds
    /// all motion until the board has accepted a set. `remembered` and `tap`: as for [`new`](Self::new).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn power_up(
        up: &PowerUp,
        remembered: Option<Position>,
        tap: Option<TapRecord>,
    ) -> Result<Self, Alarm> {
        let mut board = Self::new(&up.params, remembered, tap)?;
        board.background.power_up(up);
        board.ticker.withhold(up.found);
        Ok(board)
    }

    /// Hands a call over. Returns false and changes nothing where there is no room now, or while the machine starts, stops
    /// or stands on an alarm, because such a call would have to be dropped.
    #[must_use]
    pub fn offer(&mut self, call: &Call) -> bool {
        self.heed();
        self.background.offer(call, &mut self.ticker)
    }

    /// Does one piece of background work. False where no work can be done now.
    pub fn background(&mut self) -> bool {
        self.heed();
        let (operator, begun) = (self.ticker.operator(), self.ticker.has_begun());
        let (mut segments, _) = self.segments.split();
        let (worked, warning) = self.background.plan(&mut segments, operator, begun);
        if let Some(warning) = warning
            && self.events.enqueue(Event::Warning(warning)).is_err()
        {
            // The queue of events is full; `check` has shown this before.
        }
        worked
    }

    /// One SYNC period; see [`Ticker::tick`].
    pub fn tick(&mut self, sample: EncoderSample, received: &[Frame], output: &mut Output) {
        let (_, mut segments) = self.segments.split();
        let (_, mut detours) = self.detours.split();
        let (mut events, _) = self.events.split();
        let mut ends = Ends {
            segments: &mut segments,
            detours: &mut detours,
            events: &mut events,
        };
        self.ticker.tick(sample, received, &mut ends, output);
        if let Some(record) = output.journal {
            self.background.enter(record);
        }
    }

    /// The background obeys the tick's message before any other work.
    fn heed(&mut self) {
        if let Some(notice) = self.ticker.notice() {
            let (mut detours, _) = self.detours.split();
            self.background.heed(notice, &mut detours);
            self.ticker.notice_heard();
        }
    }

    /// Takes an operator's command; it acts in the next tick.
    pub const fn command(&mut self, command: Command) {
        self.ticker.command(command);
    }

    /// Sets the inputs. They act in the next tick, and on the next call that is opened.
    pub const fn signals(&mut self, signals: Signals) {
        self.ticker.signals(signals);
    }

    /// The next write for the storage; the owner answers it with [`stored`](Self::stored). `None` where nothing is to be
    /// stored, or where the last write has not been answered yet. Of entries that come meanwhile, only the newest counts.
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        self.background.store()
    }

    /// The next region to read; the owner answers with [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.background.load()
    }

    /// The content of the region that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Held<'_>) {
        self.background.loaded(held);
    }

    /// The last write of [`store`](Self::store) has been done, or has failed.
    pub fn stored(&mut self, region: Region, result: Result<(), StoreError>) {
        self.background.stored(region, result, &mut self.ticker);
        self.carry_out();
    }

    /// The newest entry of the tap journal, stored or on its way there.
    #[must_use]
    pub const fn tap_record(&self) -> Option<&TapRecord> {
        self.background.tap_record()
    }

    /// Drops the entry of a tap in its hole: the caller says that the tap is out. It acts with the next tick. Returns false
    /// and changes nothing where there is no entry, or while the machine moves.
    pub fn discard_tap(&mut self) -> bool {
        self.ticker.discard_tap()
    }

    /// The oldest event not yet read.
    pub fn event(&mut self) -> Option<Event> {
        let event = self.events.dequeue()?;
        self.background.note(&event);
        Some(event)
    }

    /// True while a call that was handed over has not been carried out.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let forgotten = matches!(self.ticker.notice(), Some(Notice::Restart(..)));
        (!forgotten && self.background.is_planning())
            || !self.segments.is_empty()
            || self.background.is_storing()
            || self.ticker.operator().reset_waits()
            || !matches!(self.ticker.state(), State::Idle | State::Alarm(_))
    }

    /// The tick side, to read from.
    #[must_use]
    pub const fn ticker(&self) -> &Ticker {
        &self.ticker
    }

    /// The exact helix that the pass under way follows; `None` outside.
    #[must_use]
    pub fn helix(&self) -> Option<Helix> {
        match self.law()? {
            Law::Thread(helix) => Some(helix),
            _ => None,
        }
    }

    /// The line that axis and spindle of a rigid tap under way follow; `None` outside.
    #[must_use]
    pub fn tap_line(&self) -> Option<TapLine> {
        match self.law()? {
            Law::Tap(line) => Some(line),
            _ => None,
        }
    }

    /// The line on which the axis of an ordinary tap under way follows the measured spindle; `None` outside.
    #[must_use]
    pub fn float_line(&self) -> Option<TapLine> {
        match self.law()? {
            Law::Float(line) => Some(line),
            _ => None,
        }
    }

    fn law(&self) -> Option<Law> {
        self.ticker.law(self.segments.peek())
    }

    /// The limits in force.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        self.background.limits()
    }
}
