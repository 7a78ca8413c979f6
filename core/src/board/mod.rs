//! The board: calls, frames and encoder samples in; frames, events and setpoints out. Sans-IO.
//!
//! Two contexts. The **tick** ([`Ticker`], one SYNC period, bounded) observes the spindle, watches the drives, executes
//! segments and makes frames. The **background** ([`Background`]) speaks on the bus ([`Device`]), stores parameters, and
//! expands and plans calls ([`Planner`]). Single-producer queues join the two contexts. The other way goes one message:
//! start afresh from here, or plan this way. A planned segment carries the [`Epoch`] in which it was planned, and the tick
//! drops segments that are older than its last start, so the two contexts need not agree on the moment. The background
//! obeys the tick's message before it takes further calls.
//!
//! ```text
//!          calls          segments                       SYNC, RPDOs
//! gateway ──────► Planner ──────► Ticker ──────────────────────► drives
//!                      ▲               │ ▲
//!                      └─── notice ────┘ └── encoder sample, TPDOs
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
use crate::journal::TapRecord;
use crate::motion::{Epoch, Helix, Law, Limits, Setpoint, TapLine};
use crate::params::Params;
use crate::program::{Call, Position};
use crate::signals::Signals;
use crate::spindle::EncoderSample;
pub use queue::{Calls, DetourIn, DetourOut, Detours, Events, SegmentIn, SegmentOut, Segments};

/// A motion board with both its contexts, called in turn from one thread (simulation, tests). Firmware takes the same
/// two halves apart.
#[derive(Debug)]
pub struct Board {
    segments: Segments,
    detours: Detours,
    events: Events,
    ticker: Ticker,
    background: Background,
    /// What the next measured angle is judged by.
    reference: Reference,
}

/// With one thread there is nothing in between.
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
        // Where that does not go, nothing changes.
        let _ = Self::discard_tap(self);
    }

    fn stored(&mut self, sequence: u32, result: Result<(), StoreError>) {
        Self::stored(self, sequence, result);
    }
}

impl Board {
    /// A board at power-up. `remembered`: where the machine stood, if known; it counts where the drives' positions agree
    /// with it to their increment. `tap`: the stored entry of the tap journal. Where it says that a tap is in its hole, the
    /// reference of the tap axis counts as lost: wherever its drive says it is, it stands at the bottom [D26].
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

    /// A board at power-up with what it has kept. It starts with that set, and where something is wrong with it, an alarm
    /// withholds all motion until a set has been taken. `remembered` and `tap`: as for [`new`](Self::new).
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

    /// Hands a call over. False, and nothing changes, where there is no room for it now, or while the machine starts, stops
    /// or stands on an alarm: whatever it is given then belongs to what has to be forgotten.
    #[must_use]
    pub fn offer(&mut self, call: &Call) -> bool {
        self.heed();
        self.background.offer(call, &mut self.ticker)
    }

    /// One piece of background work. False where there is none that can be done now.
    pub fn background(&mut self) -> bool {
        self.heed();
        let (operator, begun) = (self.ticker.operator(), self.ticker.has_begun());
        let (mut segments, _) = self.segments.split();
        let (worked, warning) = self.background.plan(&mut segments, operator, begun);
        if let Some(warning) = warning
            && self.events.enqueue(Event::Warning(warning)).is_err()
        {
            // The reader is behind; `check` has shown it before.
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

    /// What the tick has said comes before everything else the background does.
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

    /// Sets the inputs; they act in the next tick, and on the next call that is taken up.
    pub const fn signals(&mut self, signals: Signals) {
        self.ticker.signals(signals);
    }

    /// What is to be stored now: to be given back by [`stored`](Self::stored). `None` where nothing is, or where the last
    /// write has not been answered yet; of entries that come meanwhile only the newest counts.
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        self.background.store()
    }

    /// A region that is to be read now: what it holds is to be given back by [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.background.load()
    }

    /// What the region holds that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Held<'_>) {
        self.background.loaded(held);
    }

    /// The last write that [`store`](Self::store) asked for has been done, or could not be.
    pub fn stored(&mut self, region: Region, result: Result<(), StoreError>) {
        self.background.stored(region, result, &mut self.ticker);
        self.carry_out();
    }

    /// The newest entry of the tap journal, stored or on its way there.
    #[must_use]
    pub const fn tap_record(&self) -> Option<&TapRecord> {
        self.background.tap_record()
    }

    /// Drops the entry of a tap that is in its hole: there is none, says who calls this. It acts with the next tick. False,
    /// and nothing changes, where there is none, or while the machine moves.
    pub fn discard_tap(&mut self) -> bool {
        self.ticker.discard_tap()
    }

    /// The oldest event not yet read.
    pub fn event(&mut self) -> Option<Event> {
        let event = self.events.dequeue()?;
        self.background.note(&event);
        Some(event)
    }

    /// True while anything handed over has not been carried out.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let forgotten = matches!(self.ticker.notice(), Some(Notice::Restart(..)));
        (!forgotten && self.background.is_planning())
            || !self.segments.is_empty()
            || self.background.is_storing()
            || self.ticker.operator().reset_waits()
            || !matches!(self.ticker.state(), State::Idle | State::Alarm(_))
    }

    /// The tick side, for what it can tell.
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

    /// The line on which axis and spindle of a rigid tap under way are; `None` outside.
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
