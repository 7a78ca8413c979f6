//! The tick's side: one SYNC period of the whole board, in an interrupt.

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

/// Frames a tick takes from the bus at most: two of each of seven drives, and some
/// that are for the background. What is left waits for the next.
const RECEIVED: usize = 24;

/// For this part of a second the background may be silent before the watchdog is not fed any more [D134].
const PATIENCE: u32 = 4;

/// What the pins of a board say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// The emergency stop is pressed, or its circuit is open.
    pub stop: bool,
    /// Feed hold is pressed, or its circuit is open: while it is, nothing goes on [D192].
    pub hold: bool,
    /// The machine's inputs, where this board has pins for them. They count instead of those set over the bus.
    pub signals: Option<Signals>,
    /// The machine has to stop with this alarm: the bus is off, or a part of the board does not work.
    pub trouble: Option<Code>,
    /// What was [switched](TickMachine::switch) is not as it is to be: the next move waits, and after a second the machine
    /// stops with this alarm [D191].
    pub unanswered: Option<Code>,
}

/// What a board brings for the tick. All of it is called in the timer interrupt; nothing may wait.
pub trait TickMachine {
    /// What the spindle's encoder shows at this SYNC. The first call of a tick.
    fn sample(&mut self) -> EncoderSample;
    /// What the pins say.
    fn inputs(&mut self) -> Inputs;
    /// The oldest frame from the bus not yet read. Those of drives have to come this way; whatever else comes goes to the
    /// background.
    fn receive(&mut self) -> Option<Frame>;
    /// Sends the frames of a tick, in this order and before any other. False where some of the tick before have not left:
    /// those are dropped, and their setpoints are late.
    fn send(&mut self, frames: &[Frame]) -> bool;
    /// Sends the frame with the setpoints of all drives, behind those; false where that of the tick before has not
    /// left. On a machine without CAN FD none ever does: no drive comes up.
    fn send_together(&mut self, _setpoints: &Setpoints) -> bool {
        false
    }
    /// Switches what a program asks for, and nothing any more behind a reset. What takes its time is
    /// [unanswered](Inputs::unanswered) from the next tick on.
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
    /// `None` while it is made anew.
    ticker: Option<&'static mut Ticker>,
    /// Where the drives are; while there is no ticker, where they were.
    drives: DriveNodes,
    /// The SYNC it gave: that goes on meanwhile.
    sync: SyncProducer,
    ends: Ends,
    output: Output,
    reference: Reference,
    /// What still waits for room in its queue.
    entry: Option<TapRecord>,
    /// The pins at the last tick.
    inputs: Inputs,
    /// SYNC periods since the last report, and since the last sign of life of the background.
    elapsed: u32,
    silence: u32,
    late: u32,
    /// SYNC periods for which what was switched is not answered.
    unanswered: u32,
    /// SYNC periods of a second.
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

    /// One SYNC period. While the ticker is with the background, which makes it anew, nothing is sent but SYNC: the machine
    /// stands, and its drives are brought up again.
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

    /// What is sent without a ticker.
    #[cold]
    #[inline(never)]
    fn only_beat(&mut self) {
        self.output.frames.clear();
        self.output.switching = Switching::Nothing;
        self.output.together = None;
        // There is room.
        let _ = self.output.frames.push(self.sync.next());
    }

    /// What the last tick gave.
    #[must_use]
    pub const fn output(&self) -> &Output {
        &self.output
    }

    /// Frames since the last tick; what is not a drive's goes to the background.
    fn receive(&mut self, machine: &mut impl TickMachine) -> Vec<Frame, RECEIVED> {
        let mut received = Vec::new();
        while !received.is_full()
            && let Some(frame) = machine.receive()
        {
            if is_of_drive(&frame, &self.drives) {
                // There is room.
                let _ = received.push(frame);
            } else {
                // Where there is none, it is lost as on a bus that is flooded; whoever sent it repeats it.
                let _ = put(&mut self.ends.strangers, frame);
            }
        }
        received
    }

    /// What stops first, so that a reset can follow it; the feed hold last, so that nothing resumes while it is pressed. A
    /// reset forgets a hold, and may have a way out of a thread: it is held again when that is done.
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
            // The background asks for nothing before it has given it back.
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
                // Where there is no tap in a hole, or the machine moves, nothing changes.
                let _ = ticker.discard_tap();
            }
            Order::Stored(sequence, result) => ticker.stored(sequence, result),
            Order::HandOver => self.hand_over(),
        }
    }

    /// The machine stands. What is still queued belongs to the ticker that goes;
    /// nothing is planned before the new one comes.
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
        // Behind the entry of the same tick.
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

/// True for what a drive sends. What is sent to one by somebody else is for the background, which knows who may.
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
