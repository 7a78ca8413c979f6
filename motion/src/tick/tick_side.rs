//! The tick side of a board: one SYNC period, with the queues between it and the background.
//!
//! ```text
//! begin(contacts, frames) ─► run(encoder sample) ─► (the frames leave) ─► report(were they in time)
//! ```
//!
//! Firmware calls the three in an interrupt; an owner with one thread calls them in turn with the background's work. It
//! must not know hardware: what the pins say and what has come from the bus are arguments.

use heapless::Vec;

use super::command::Command;
use super::message::{Order, Report};
use super::nodes::DriveNodes;
use super::queue::{drop_oldest, put, take};
use super::queues::TickEnds;
use super::reference::Reference;
use super::snapshot::{Contacts, Snapshot};
use super::ticker::{Output, Setup, State, Ticker};
use crate::alarm::{Alarm, Code};
use crate::bus::{Frame, Service};
use crate::call::Position;
use crate::journal::TapRecord;
use crate::signals::Signals;
use crate::spindle::EncoderSample;

/// The most frames of drives that a tick takes: two of each of seven drives, and some more. The others wait for the next
/// tick.
const RECEIVED: usize = 24;

/// The background hangs where there was no room for a report for this part of a second (1/4) [D134].
const PATIENCE: u32 = 4;

/// The state of a board's input pins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// The emergency stop is pressed, or its circuit is open.
    pub stop: bool,
    /// Feed hold is pressed, or its circuit is open. Nothing resumes while this is true [D192].
    pub hold: bool,
    /// The machine's inputs, where this board has pins for them. They replace the inputs that are set over the bus.
    pub signals: Option<Signals>,
    /// The machine's inputs that are on, bit 0 for input 1; `None` where nobody can tell.
    pub machine: Option<u16>,
    /// The machine has to stop with this alarm: the controller is bus-off, or a part of the board does not work.
    pub trouble: Option<Code>,
    /// The machine has not yet followed [`Output::switching`]. The next move waits; after a second the machine stops with
    /// this alarm [D191].
    pub unanswered: Option<Code>,
}

/// The state of the tick side.
#[derive(Debug)]
pub struct Tick {
    ticker: Ticker,
    pub(super) reference: Reference,
    /// A tap journal entry that waits for room in its queue.
    entry: Option<TapRecord>,
    /// The drives' frames for this tick.
    received: Vec<Frame, RECEIVED>,
    /// The pins at this tick.
    inputs: Inputs,
    /// SYNC periods since the last report.
    elapsed: u32,
    late: u32,
    /// SYNC periods for which the machine has not followed the last switching.
    unanswered: u32,
    /// The number of orders carried out. It wraps.
    orders: u32,
}

impl Tick {
    /// The state at power-up. `remembered`: the last position of the machine, if known; it counts where the drives'
    /// positions agree with it to their increment. `tap`: the stored entry of the tap journal.
    // Written straight to the place that the caller names. As a function of its own, the value would be copied there
    // [D146].
    #[inline(always)]
    #[must_use]
    pub fn new(setup: &Setup, remembered: Option<Position>, tap: Option<TapRecord>) -> Self {
        Self {
            ticker: Ticker::new(setup, remembered, tap),
            reference: Reference::default(),
            entry: None,
            received: Vec::new(),
            inputs: Inputs::default(),
            elapsed: 0,
            late: 0,
            unanswered: 0,
            orders: 0,
        }
    }

    /// The machine, to read from.
    #[must_use]
    pub const fn ticker(&self) -> &Ticker {
        &self.ticker
    }

    /// The machine of the tick, for an owner that has both sides in one thread. Between two ticks only.
    #[must_use]
    pub const fn ticker_mut(&mut self) -> &mut Ticker {
        &mut self.ticker
    }

    /// Sets the number of setpoints that were late for their SYNC since power-up.
    pub const fn set_late(&mut self, late: u32) {
        self.late = late;
    }

    /// Starts on an alarm, because the board did not end in good order the last time. Call this before the first tick. The
    /// drives are enabled after a reset.
    pub const fn begin_in_alarm(&mut self, alarm: Alarm) {
        self.ticker.begin_in_alarm(alarm);
    }
}

/// The tick side: its state and its ends of the queues.
pub struct TickSide<'a> {
    tick: &'a mut Tick,
    ends: TickEnds<'a>,
}

impl<'a> TickSide<'a> {
    /// The side with this state.
    pub const fn new(tick: &'a mut Tick, ends: TickEnds<'a>) -> Self {
        Self { tick, ends }
    }

    /// A SYNC period begins: takes the pins, the frames from the bus since the last tick, and the background's orders.
    /// Frames that are not a drive's go to the background.
    pub fn begin(&mut self, inputs: &Inputs, frames: impl IntoIterator<Item = Frame>) {
        let tick = &mut *self.tick;
        tick.elapsed = tick.elapsed.saturating_add(1);
        let drives = tick.ticker.drive_nodes();
        tick.received.clear();
        let mut frames = frames.into_iter();
        while !tick.received.is_full()
            && let Some(frame) = frames.next()
        {
            if is_of_drive(&frame, &drives) {
                // There is room.
                let _ = tick.received.push(frame);
            } else {
                // Where there is no room the frame is lost, as on a flooded bus; its sender repeats it.
                let _ = put(&mut self.ends.strangers, frame);
            }
        }
        self.obey(inputs);
    }

    /// Observes, executes and makes the frames of this period; see [`Ticker`].
    // Only the ticker's own ends have to be there.
    #[inline(always)]
    pub fn run(&mut self, sample: EncoderSample, output: &mut Output) {
        let tick = &mut *self.tick;
        tick.ticker
            .tick(sample, &tick.received, &mut self.ends.ticker, output);
    }

    /// There was room for a report within the last quarter of a second: the background takes them. Otherwise it hangs.
    #[must_use]
    pub const fn is_heard(&self) -> bool {
        self.tick.elapsed <= self.tick.ticker.second() / PATIENCE
    }

    /// The last call of a tick, after its frames have left: tells the background what there is to tell. `sent`: all frames
    /// of the tick before had left in time.
    #[inline(never)]
    pub fn report(&mut self, output: &Output, sent: bool) {
        let tick = &mut *self.tick;
        let ticker = &mut tick.ticker;
        if !sent {
            tick.late = tick.late.saturating_add(1);
        }
        if output.journal.is_some() {
            tick.entry = output.journal;
        }
        if let Some(entry) = &tick.entry
            && put(&mut self.ends.entries, *entry).is_ok()
        {
            tick.entry = None;
        }
        // The entry of the same tick goes first.
        if tick.entry.is_none()
            && let Some(notice) = ticker.notice()
            && put(&mut self.ends.notices, *notice).is_ok()
        {
            ticker.notice_heard();
        }
        let head = self.ends.ticker.segments.peek();
        let setpoint = &output.setpoint;
        let measured = tick.reference.error(ticker, head, setpoint);
        let contacts = Contacts {
            hold: tick.inputs.hold,
            stop: tick.inputs.stop,
        };
        let report = Report {
            elapsed: tick.elapsed,
            snapshot: Snapshot::new(ticker, setpoint, contacts),
            begun: ticker.has_begun(),
            measured,
            late: tick.late,
            orders: tick.orders,
        };
        if put(&mut self.ends.reports, report).is_ok() {
            tick.elapsed = 0;
        }
    }

    /// Passes the stops on first, so that a reset in the same tick can follow them. The feed hold comes last, so that
    /// nothing resumes while its contact is open. A reset clears a hold, and may have to move out of a thread: the hold
    /// waits until the reset is done.
    #[inline(never)]
    fn obey(&mut self, inputs: &Inputs) {
        let tick = &mut *self.tick;
        let ticker = &mut tick.ticker;
        tick.inputs = *inputs;
        tick.unanswered = match inputs.unanswered {
            Some(_) => tick.unanswered.saturating_add(1),
            None => 0,
        };
        if inputs.stop {
            ticker.command(Command::Stop);
        }
        if let Some(code) = inputs.trouble {
            ticker.command(Command::Halt(code));
        }
        if let Some(code) = inputs.unanswered
            && tick.unanswered > ticker.second()
        {
            ticker.command(Command::Halt(code));
        }
        ticker.hear_machine(inputs.machine);
        ticker.await_machine(inputs.unanswered.is_some());
        if let Some(signals) = inputs.signals {
            ticker.signals(signals);
        }
        while let Some(order) = take(&mut self.ends.orders) {
            self.carry_out(order);
        }
        let ticker = &mut self.tick.ticker;
        if inputs.hold
            && (ticker.takes_calls() || matches!(ticker.state(), State::ByHand))
            && !ticker.operator().reset_waits()
        {
            ticker.command(Command::Hold);
        }
    }

    fn carry_out(&mut self, order: Order) {
        self.tick.orders = self.tick.orders.wrapping_add(1);
        let ticker = &mut self.tick.ticker;
        match order {
            Order::Command(command) => ticker.command(command),
            Order::Signals(signals) => {
                if self.tick.inputs.signals.is_none() {
                    ticker.signals(signals);
                }
            }
            Order::ProgramBegins { epoch, typed } => {
                if epoch == ticker.epoch() && ticker.takes_calls() {
                    ticker.program_begins(typed);
                }
            }
            Order::DiscardTap => {
                // Where no tap is in a hole, or the machine moves, nothing changes.
                let _ = ticker.discard_tap();
            }
            Order::Stored(sequence, result) => ticker.stored(sequence, result),
            Order::Press => {
                if let Some(press) = take(&mut self.ends.presses) {
                    ticker.press(&press, &mut self.ends.ticker.events);
                }
            }
            Order::BeginAnew => self.begin_anew(),
        }
    }

    /// The application begins anew. The machine stands.
    #[cold]
    #[inline(never)]
    fn begin_anew(&mut self) {
        let tick = &mut *self.tick;
        tick.reference = Reference::default();
        if let Some(setup) = self.ends.setups.peek() {
            tick.ticker.begin_anew(setup);
            drop_oldest(&mut self.ends.setups);
        }
    }
}

/// True for a drive's TPDOs, emergencies and heartbeats. A frame from another node to a drive goes to the background,
/// which knows the permitted senders.
fn is_of_drive(frame: &Frame, drives: &DriveNodes) -> bool {
    const SPOKEN: [Service; 6] = [
        Service::Tpdo1,
        Service::Tpdo2,
        Service::Tpdo3,
        Service::Tpdo4,
        Service::Emcy,
        Service::Heartbeat,
    ];
    frame
        .id()
        .service()
        .is_some_and(|(service, node)| SPOKEN.contains(&service) && drives.letter(node).is_some())
}
