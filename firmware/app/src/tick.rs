//! The tick's side: one SYNC period of the whole board, run in an interrupt.

use heapless::Vec;
use heapless::spsc::{Consumer, Producer};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::queue::{put, take};
use leadscrew_core::board::{
    Command, Contacts, DetourOut, DriveNodes, Ends as TickerEnds, Event, Notice, Output, Reference,
    SegmentOut, Snapshot, Switching, Ticker,
};
use leadscrew_core::bus::Setpoints;
use leadscrew_core::bus::{Frame, Service, SyncProducer};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::signals::Signals;
use leadscrew_core::spindle::EncoderSample;

use crate::report::{Order, Report};

/// The most frames that a tick takes from the bus: two of each of seven drives, and some for the background. The other
/// frames wait for the next tick.
const RECEIVED: usize = 24;

/// The background may be silent for this part of a second (1/4). After that, the tick side stops feeding the watchdog
/// [D134].
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
    /// The machine has to stop with this alarm: the controller is bus-off, or a part of the board does not work.
    pub trouble: Option<Code>,
    /// The machine has not yet followed [`switch`](TickMachine::switch). The next move waits; after a second the
    /// machine stops with this alarm [D191].
    pub unanswered: Option<Code>,
}

/// The hardware that a board provides to the tick. All functions are called in the timer interrupt; none may wait.
pub trait TickMachine {
    /// The sample of the spindle's encoder at this SYNC. The first call of a tick.
    fn sample(&mut self) -> EncoderSample;
    /// The state of the input pins.
    fn inputs(&mut self) -> Inputs;
    /// The oldest frame from the bus that is not yet read. All frames of the drives have to come this way. The tick
    /// passes all others to the background.
    fn receive(&mut self) -> Option<Frame>;
    /// Sends the frames of a tick, in this order and before any other frame. False where some frames of the
    /// previous tick have not left: these are dropped, and their setpoints are late.
    fn send(&mut self, frames: &[Frame]) -> bool;
    /// Sends the frame with the setpoints of all drives, after the frames of [`send`](Self::send). False where the
    /// previous tick's frame has not left. Without CAN FD the frame never leaves: no drive comes up.
    fn send_together(&mut self, _setpoints: &Setpoints) -> bool {
        false
    }
    /// Switches a machine function that a program asks for, or takes all of them back after a reset. While the machine
    /// has not followed, [`Inputs::unanswered`] says so, from the next tick on.
    fn switch(&mut self, _switching: Switching) {}
    /// Feeds the watchdog: both sides are alive.
    fn feed_watchdog(&mut self);
}

/// The ends of the queues that this side owns.
pub(crate) struct Ends {
    pub segments: SegmentOut<'static>,
    pub detours: DetourOut<'static>,
    pub events: Producer<'static, Event>,
    pub orders: Consumer<'static, Order>,
    pub reports: Producer<'static, Report>,
    pub entries: Producer<'static, TapRecord>,
    pub notices: Producer<'static, Notice>,
    pub strangers: Producer<'static, Frame>,
    pub given: Producer<'static, &'static mut Ticker>,
    pub returned: Consumer<'static, &'static mut Ticker>,
}

/// The tick's side of a board.
pub struct TickSide {
    /// `None` while the background makes the ticker anew.
    ticker: Option<&'static mut Ticker>,
    /// The nodes of the drives. Without a ticker: the nodes of the last one.
    drives: DriveNodes,
    /// The producer of SYNC. SYNC goes on while there is no ticker.
    sync: SyncProducer,
    ends: Ends,
    output: Output,
    reference: Reference,
    /// A tap journal entry that waits for room in its queue.
    entry: Option<TapRecord>,
    /// The pins at this tick.
    inputs: Inputs,
    /// SYNC periods since the last report, and since the last sign of life of the background.
    elapsed: u32,
    silence: u32,
    late: u32,
    /// SYNC periods for which the machine has not followed the last switching.
    unanswered: u32,
    /// SYNC periods in a second.
    second: u32,
}

impl TickSide {
    pub(crate) fn new(ticker: &'static mut Ticker, ends: Ends) -> Self {
        Self {
            drives: ticker.drive_nodes(),
            second: ticker.second(),
            ticker: Some(ticker),
            sync: SyncProducer::new(),
            ends,
            output: Output::default(),
            reference: Reference::default(),
            entry: None,
            inputs: Inputs::default(),
            elapsed: 0,
            silence: 0,
            late: 0,
            unanswered: 0,
        }
    }

    /// Runs one SYNC period. While the background makes the ticker anew, the board sends SYNC only: the machine stands,
    /// and its drives are brought up again afterwards.
    pub fn tick(&mut self, machine: &mut impl TickMachine) {
        let sample = machine.sample();
        self.elapsed = self.elapsed.saturating_add(1);
        self.silence = self.silence.saturating_add(1);
        if let Some(ticker) = take(&mut self.ends.returned) {
            self.drives = ticker.drive_nodes();
            self.second = ticker.second();
            *ticker.sync() = self.sync;
            self.ticker = Some(ticker);
        }
        let inputs = machine.inputs();
        let received = self.receive(machine);
        self.obey(&inputs);
        if self.silence <= self.second / PATIENCE {
            machine.feed_watchdog();
        }
        if self.ticker.is_none() {
            self.only_beat();
        }
        let mut ends = TickerEnds {
            segments: &mut self.ends.segments,
            detours: &mut self.ends.detours,
            events: &mut self.ends.events,
        };
        if let Some(ticker) = &mut self.ticker {
            ticker.tick(sample, &received, &mut ends, &mut self.output);
        }
        if self.output.switching != Switching::Nothing {
            machine.switch(self.output.switching);
        }
        let sent = machine.send(&self.output.frames);
        let sent = match &self.output.together {
            Some(setpoints) => machine.send_together(setpoints) && sent,
            None => sent,
        };
        if !sent {
            self.late = self.late.saturating_add(1);
        }
        self.report();
    }

    /// The output of a tick without a ticker: SYNC only.
    #[cold]
    #[inline(never)]
    fn only_beat(&mut self) {
        self.output.frames.clear();
        self.output.switching = Switching::Nothing;
        self.output.together = None;
        // There is room.
        let _ = self.output.frames.push(self.sync.next());
    }

    /// The output of the last tick.
    #[must_use]
    pub const fn output(&self) -> &Output {
        &self.output
    }

    /// Takes the frames since the last tick. Frames that are not a drive's go to the background.
    fn receive(&mut self, machine: &mut impl TickMachine) -> Vec<Frame, RECEIVED> {
        let mut received = Vec::new();
        while !received.is_full()
            && let Some(frame) = machine.receive()
        {
            if is_of_drive(&frame, &self.drives) {
                // There is room.
                let _ = received.push(frame);
            } else {
                // Where there is no room the frame is lost, as on a flooded bus; its sender repeats it.
                let _ = put(&mut self.ends.strangers, frame);
            }
        }
        received
    }

    /// Passes the stops on first, so that a reset in the same tick can follow them. The feed hold comes last, so that
    /// nothing resumes while its contact is open. A reset clears a hold, and may have to move out of a thread: the hold
    /// waits until the reset is done.
    #[inline(never)]
    fn obey(&mut self, inputs: &Inputs) {
        self.inputs = *inputs;
        self.unanswered = match inputs.unanswered {
            Some(_) => self.unanswered.saturating_add(1),
            None => 0,
        };
        if let Some(ticker) = &mut self.ticker {
            if inputs.stop {
                ticker.command(Command::Stop);
            }
            if let Some(code) = inputs.trouble {
                ticker.command(Command::Halt(code));
            }
            if let Some(code) = inputs.unanswered
                && self.unanswered > self.second
            {
                ticker.command(Command::Halt(code));
            }
            ticker.await_machine(inputs.unanswered.is_some());
            if let Some(signals) = inputs.signals {
                ticker.signals(signals);
            }
        }
        while let Some(order) = take(&mut self.ends.orders) {
            self.carry_out(order);
        }
        if inputs.hold
            && let Some(ticker) = &mut self.ticker
            && ticker.takes_calls()
            && !ticker.operator().reset_waits()
        {
            ticker.command(Command::Hold);
        }
    }

    fn carry_out(&mut self, order: Order) {
        if order == Order::Alive {
            self.silence = 0;
            return;
        }
        let Some(ticker) = &mut self.ticker else {
            // The background orders nothing before it has given the ticker back.
            return;
        };
        match order {
            Order::Alive => {}
            Order::Command(command) => ticker.command(command),
            Order::Signals(signals) => {
                if self.inputs.signals.is_none() {
                    ticker.signals(signals);
                }
            }
            Order::ProgramBegins(epoch) => {
                if epoch == ticker.epoch() && ticker.takes_calls() {
                    ticker.program_begins();
                }
            }
            Order::DiscardTap => {
                // Where no tap is in a hole, or the machine moves, nothing changes.
                let _ = ticker.discard_tap();
            }
            Order::Stored(sequence, result) => ticker.stored(sequence, result),
            Order::HandOver => self.hand_over(),
        }
    }

    /// Gives the ticker to the background. The machine stands. Whatever is still queued belongs to the old ticker: it
    /// is dropped, and nothing is planned before the new ticker comes.
    #[inline(never)]
    fn hand_over(&mut self) {
        self.ends.segments.clear();
        while take(&mut self.ends.detours).is_some() {}
        self.reference = Reference::default();
        if let Some(ticker) = &mut self.ticker {
            self.sync = *ticker.sync();
        }
        if let Some(ticker) = self.ticker.take()
            && let Err(ticker) = put(&mut self.ends.given, ticker)
        {
            // There is one ticker and room for it.
            self.ticker = Some(ticker);
        }
    }

    #[inline(never)]
    fn report(&mut self) {
        let Some(ticker) = &mut self.ticker else {
            return;
        };
        if self.output.journal.is_some() {
            self.entry = self.output.journal;
        }
        if let Some(entry) = &self.entry
            && put(&mut self.ends.entries, *entry).is_ok()
        {
            self.entry = None;
        }
        // The entry of the same tick goes first.
        if self.entry.is_none()
            && let Some(notice) = ticker.notice()
            && put(&mut self.ends.notices, *notice).is_ok()
        {
            ticker.notice_heard();
        }
        let head = self.ends.segments.peek();
        let setpoint = &self.output.setpoint;
        let measured = self.reference.error(ticker, head, setpoint);
        let contacts = Contacts {
            hold: self.inputs.hold,
            stop: self.inputs.stop,
        };
        let report = Report {
            elapsed: self.elapsed,
            snapshot: Snapshot::new(ticker, setpoint, contacts),
            begun: ticker.has_begun(),
            measured,
            late: self.late,
        };
        if put(&mut self.ends.reports, report).is_ok() {
            self.elapsed = 0;
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
