//! A board whose owner has one thread: both sides and their queues, driven in turn (simulation, tests).
//!
//! ```text
//! each frame ─► receive() ─► true: keep it for tick()
//! tick(), then send its frames
//! event() until there is none; serve(); background() until there is no work
//! transmit() as often as the bus has room, after the frames of the tick
//! ```
//!
//! With one thread the background hears of each tick at once, and the owner may look at the tick side between two ticks.
//! All else is as in firmware: what the background asks of the tick waits in the queues for the next tick.

use heapless::Deque;

use super::background::{Background, BackgroundSide};
use super::device::Device;
use super::kept::{Held, PowerUp};
use super::request::StoreRequest;
use super::store::Region;
use crate::alarm::{Alarm, Code, Span};
use crate::bus::{CobId, Controller, Frame, NodeId};
use crate::call::{Call, Position};
use crate::journal::TapRecord;
use crate::link::Event;
use crate::motion::{Helix, Law, Limits, Setpoint, TapLine};
use crate::params::Params;
use crate::signals::Signals;
use crate::spindle::EncoderSample;
use crate::tick::queue::EVENTS;
use crate::tick::{
    Command, Contacts, Inputs, Output, Queues, Setup, Snapshot, StoreError, Tick, TickSide, Ticker,
};

/// A motion board with both contexts.
#[derive(Debug)]
pub struct Board {
    queues: Queues,
    tick: Tick,
    background: Background,
    /// The pins.
    inputs: Inputs,
    /// Events that the owner has not read yet.
    events: Deque<Event, EVENTS>,
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
        Self::power_up(&PowerUp::given(params), remembered, tap)
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
        let params = &up.params;
        let Some(setup) = Setup::of(params, up.found) else {
            return Err(Alarm::new(Code::ParametersUnusable, Span::default()));
        };
        let tick = Tick::new(&setup, remembered, tap);
        let snapshot = Snapshot::new(tick.ticker(), &Setpoint::default(), Contacts::default());
        let mut background = Background::new(params, remembered.unwrap_or_default(), tap, snapshot);
        background.power_up(up);
        Ok(Self {
            queues: Queues::new(),
            tick,
            background,
            inputs: Inputs::default(),
            events: Deque::new(),
        })
    }

    /// Joins a network as `node`: from now on the board hears and sends frames. An NMT master starts it.
    ///
    /// # Errors
    /// As [`Background::join`].
    pub fn join(&mut self, node: NodeId) -> Result<(), Alarm> {
        self.background.join(node)
    }

    /// Sets the serial number of 1018h.
    pub const fn set_serial(&mut self, serial: u32) {
        self.background.set_serial(serial);
    }

    /// The two sides, for an owner who decides himself which of them runs when.
    #[inline]
    pub fn split(&mut self) -> (TickSide<'_>, BackgroundSide<'_>) {
        let (tick, background) = self.queues.split();
        (
            TickSide::new(&mut self.tick, tick),
            BackgroundSide::new(&mut self.background, background),
        )
    }

    fn side(&mut self) -> BackgroundSide<'_> {
        self.split().1
    }

    /// One SYNC period. `received`: the frames from the bus since the last tick.
    pub fn tick(&mut self, sample: EncoderSample, received: &[Frame], output: &mut Output) {
        let inputs = self.inputs;
        let (mut tick, _) = self.split();
        tick.begin(&inputs, received.iter().copied());
        tick.run(sample, output);
        tick.report(output, true);
        self.hear();
    }

    /// The background hears of the tick. A part of [`tick`](Self::tick), for an owner who runs its parts.
    pub fn hear(&mut self) {
        self.side().hear();
        while let Some(event) = self.side().event() {
            self.tell(event);
        }
    }

    fn tell(&mut self, event: Event) {
        // Where the owner does not read, the newest are lost.
        let _ = self.events.push_back(event);
    }

    /// Runs the device. True where there was anything to do.
    pub fn serve(&mut self) -> bool {
        self.side().serve()
    }

    /// Does one piece of planning. False where no work can be done now.
    pub fn background(&mut self) -> bool {
        let (worked, warning) = self.side().plan();
        if let Some(warning) = warning {
            self.tell(warning);
        }
        worked
    }

    /// The oldest event not yet read.
    pub fn event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Hands a call over; see [`BackgroundSide::offer`].
    #[must_use]
    pub fn offer(&mut self, call: &Call) -> bool {
        self.side().offer(call)
    }

    /// Takes a frame from the bus. True for a frame of the tick side: keep it for the next [`tick`](Self::tick).
    #[must_use]
    pub fn receive(&mut self, frame: &Frame) -> bool {
        self.side().receive(frame)
    }

    /// The handwheel at the board's own input stands at `count`, which wraps.
    pub fn own_wheel(&mut self, count: u16) {
        self.side().own_wheel(count);
    }

    /// Somebody has sent a frame of CAN FD with this identifier.
    pub fn receive_fd(&mut self, id: CobId) {
        self.side().receive_fd(id);
    }

    /// The next frame of the device to send.
    pub fn transmit(&mut self) -> Option<Frame> {
        self.background.transmit()
    }

    /// The next write for the storage; see [`Background::store`].
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        self.background.store()
    }

    /// The last write of [`store`](Self::store) has been done, or has failed.
    pub fn stored(&mut self, region: Region, result: Result<(), StoreError>) {
        self.side().stored(region, result);
    }

    /// Takes how often each page of the storage has been erased, where it has become more.
    pub fn set_erases(&mut self, erases: u32) {
        self.background.set_erases(erases);
    }

    /// The next region to read; the owner answers with [`loaded`](Self::loaded).
    pub const fn load(&mut self) -> Option<Region> {
        self.background.load()
    }

    /// The content of the region that [`load`](Self::load) asked for.
    pub fn loaded(&mut self, held: Held<'_>) {
        self.background.loaded(held);
    }

    /// Sets the state of the CAN controller. True where a controller that has left the bus may be started again.
    pub fn bus_state(&mut self, controller: Controller) -> bool {
        self.side().set_controller(controller)
    }

    /// Sets the number of setpoints that were late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.tick.set_late(late);
    }

    /// Takes an operator's command; it acts in the next tick.
    pub fn command(&mut self, command: Command) {
        self.tick.ticker_mut().command(command);
        self.look();
    }

    /// Sets the pins: contacts and what else is wired to the board. They act in every tick from the next one on.
    pub const fn set_pins(&mut self, inputs: Inputs) {
        self.inputs = inputs;
    }

    /// Sets the inputs. They act in the next tick, and on the next call that is opened.
    pub fn signals(&mut self, signals: Signals) {
        self.tick.ticker_mut().signals(signals);
        self.look();
    }

    /// Drops the entry of a tap in its hole: the caller says that the tap is out. It acts with the next tick. Returns false
    /// and changes nothing where there is no entry, or while the machine moves.
    pub fn discard_tap(&mut self) -> bool {
        let discarded = self.tick.ticker_mut().discard_tap();
        self.look();
        discarded
    }

    /// The background sees at once what was changed between two ticks.
    const fn look(&mut self) {
        let (ticker, snapshot) = (self.tick.ticker(), &mut self.background.snapshot);
        snapshot.operator = *ticker.operator();
        snapshot.tap = ticker.tap_entry();
    }

    /// True while a call or a request that was handed over has not been carried out.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.background.is_busy() || !self.queues.segments().is_empty()
    }

    /// True where the next call of a running program has not come and would have room. In lock-step, time waits.
    #[must_use]
    pub fn awaits_program(&self) -> bool {
        self.background.awaits_program()
    }

    /// The newest entry of the tap journal, stored or on its way there.
    #[must_use]
    pub const fn tap_record(&self) -> Option<&TapRecord> {
        self.background.tap_record()
    }

    /// The tick side, to read from.
    #[must_use]
    pub const fn ticker(&self) -> &Ticker {
        self.tick.ticker()
    }

    /// The board as a CANopen device.
    #[must_use]
    pub const fn device(&self) -> &Device {
        self.background.device()
    }

    /// The parameter set in force.
    #[must_use]
    pub const fn params(&self) -> &Params {
        self.background.params()
    }

    /// The limits in force.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        self.background.limits()
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
        self.tick.ticker().law(self.queues.segments().peek())
    }
}
