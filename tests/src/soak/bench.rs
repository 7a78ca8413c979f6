//! A machine, a gateway at the other end of its wire, and an operator, in virtual time.
//!
//! Time passes only in [`Bench::tick`]: the operator acts or not, the machine takes a tick, frames of both sides cross a
//! wire that may lose them, and the watch judges. Transfers and programs are loops around it, so orders, faults and losses
//! of power fall anywhere in them.

use core::time::Duration;

use heapless::Deque;
use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::board::{Event, Outcome, State};
use leadscrew_core::bus::{
    Abort, BoardBeat, BoardCommand, BoardState, BoardStatus, Frame, NmtCommand, NmtState, NodeId,
    Object, Order, SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoUpload,
};
use leadscrew_core::call::Position;
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::params::Params;

use super::alarms::Latch;
use super::drives;
use super::operator::{Mood, Operator};
use super::script::{Draws, Luck};
use super::trouble::OF_BUS;
use super::watch::Watch;
use crate::gateway::NODE;
use crate::transfer::Transfer;

/// The longest wait for an answer of the board in virtual time. A lost frame costs this much.
const PATIENCE: Duration = Duration::from_millis(60);
/// Tries of one transfer on a wire that loses frames.
const TRIES: u32 = 60;
/// The longest time for the answer to an order. On a wire that loses frames the order is repeated until then.
const ANSWER_TICKS: u64 = 2_000;
/// An order is repeated after this time, in ticks.
const REPEAT_TICKS: u64 = 20;
/// Heartbeat period of the gateway in ticks.
const BEAT_TICKS: u64 = 100;
/// This many lost heartbeats in a row may be a silence to the board.
const SILENT_BEATS: u32 = 4;
/// The most ticks by which rows come late.
const LATE_ROWS: u64 = 200;
/// The gateway's own node.
const GATEWAY: u8 = 127;

/// The end of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// It was carried out to its end.
    Finished,
    /// A reset ended it.
    Reset,
    /// An alarm ended it.
    Alarm(Alarm),
    /// The board started again.
    BootUp,
    /// The power went.
    PowerCut,
}

/// An order under way.
#[derive(Clone, Copy, Debug)]
struct Pending {
    command: BoardCommand,
    since: u64,
    sent: u64,
}

/// Quality of the wire between gateway and board, in per cent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wire {
    /// Frames that are lost.
    pub lost: u64,
    /// Frames that come twice.
    pub twice: u64,
}

/// Figures of a soak.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Ticks.
    pub ticks: u64,
    /// Programs begun.
    pub programs: u64,
    /// Programs carried out to their end.
    pub finished: u64,
    /// Orders by kind: run, hold, resume, reset, stop.
    pub orders: [u64; 6],
    /// Alarms.
    pub alarms: u64,
    /// Alarms of the bus.
    pub bus: u64,
    /// Accepted parameter sets.
    pub pushed: u64,
    /// Refused parameter writes.
    pub refused: u64,
    /// Losses of power.
    pub cuts: u64,
    /// Taps brought out of their holes by G30 P99.
    pub returns: u64,
    /// Frames lost and doubled.
    pub lost: u64,
    /// SDO transfers.
    pub transfers: u64,
    /// Faults of drives, spindle and encoder.
    pub troubles: u64,
}

impl Counts {
    /// Adds the figures of another shift.
    pub fn add(&mut self, other: &Self) {
        self.ticks += other.ticks;
        self.programs += other.programs;
        self.finished += other.finished;
        for (sum, more) in self.orders.iter_mut().zip(other.orders) {
            *sum += more;
        }
        self.alarms += other.alarms;
        self.bus += other.bus;
        self.pushed += other.pushed;
        self.refused += other.refused;
        self.cuts += other.cuts;
        self.returns += other.returns;
        self.lost += other.lost;
        self.transfers += other.transfers;
        self.troubles += other.troubles;
    }
}

/// The bench.
pub struct Bench {
    /// The source of all random values.
    pub random: Draws,
    /// The machine.
    pub sim: Sim,
    /// The options of the plant.
    pub options: PlantOptions,
    /// The parameters in force, as the gateway knows them.
    pub params: Params,
    /// The board's last status.
    pub status: BoardStatus,
    /// The board's last beat.
    pub beat: BoardBeat,
    /// The watch.
    pub watch: Watch,
    /// The operator.
    pub operator: Operator,
    /// The wire to the gateway.
    pub wire: Wire,
    /// The figures.
    pub counts: Counts,
    /// The end of the program; `None` while it runs.
    pub end: Option<End>,
    /// Ticks of this shift.
    pub now: u64,
    /// The gateway sends heartbeats.
    pub beats: bool,
    /// Missing heartbeats: those that the wire has lost in a row, and at least one while none is sent.
    lost_beats: u32,
    /// Axes whose drives do not tell their true position, because a tap was in its hole when the power went.
    pub assumed: [bool; 3],
    pending: Option<Pending>,
    received: Deque<Frame, 512>,
    /// Tick of the board's last status.
    heard: u64,
    /// The alarm of the machine.
    alarm: Latch,
    /// The encoder has slipped, and the board has not reported it.
    pub slipped: bool,
    /// From this tick on its report is known, also in late rows.
    slip_over: Option<u64>,
    /// A further condition after every tick.
    pub must: fn(&Bench),
}

impl Bench {
    /// Switches a machine on and starts its node.
    pub fn new(random: Draws, sim: Sim, params: Params, options: PlantOptions, wire: Wire) -> Self {
        let mut bench = Self {
            random,
            sim,
            options,
            status: BoardStatus::default(),
            beat: BoardBeat::default(),
            watch: Watch::new(&params, &options),
            operator: Operator::of(&params, &options),
            params,
            wire,
            counts: Counts::default(),
            end: None,
            now: 0,
            beats: false,
            lost_beats: 0,
            assumed: [false; 3],
            pending: None,
            received: Deque::new(),
            heard: 0,
            alarm: Latch::default(),
            slipped: false,
            slip_over: None,
            must: |_| {},
        };
        bench.connect();
        bench
    }

    /// The board joins its network.
    pub fn connect(&mut self) {
        self.sim.join(NODE).expect("there is room on the bus");
        self.pending = None;
        self.alarm = Latch::default();
        self.watch.power_up();
        self.heard = self.now;
        self.status = BoardStatus::default();
        self.send(NmtCommand::Start.frame(Some(NODE)));
    }

    /// The commanded position.
    pub fn position(&self) -> Position {
        self.sim.board().ticker().executor().position()
    }

    /// The state of the machine.
    pub fn state(&self) -> State {
        self.sim.board().ticker().state()
    }

    /// The tap is in a hole, as the board knows.
    pub fn in_hole(&self) -> bool {
        self.sim
            .board()
            .tap_record()
            .is_some_and(|record| record.in_hole)
    }

    /// How many copies of this frame arrive.
    fn copies(&mut self) -> u32 {
        let bad = (self.wire.lost + self.wire.twice) as i64;
        let luck = self.random.luck(Luck::Wire, 0, 99, |luck| luck < bad) as u64;
        if luck < self.wire.lost {
            self.counts.lost += 1;
            0
        } else if luck < self.wire.lost + self.wire.twice {
            self.counts.lost += 1;
            2
        } else {
            1
        }
    }

    /// Sends a frame of the gateway. True where it has arrived.
    pub fn send(&mut self, frame: Frame) -> bool {
        let copies = self.copies();
        for _ in 0..copies {
            self.sim.receive(&frame);
        }
        copies > 0
    }

    /// Gives an order and repeats it until the board has taken it. An order under way comes first.
    pub fn order(&mut self, order: Order) {
        if self.pending.is_some() {
            return;
        }
        let place = match order {
            Order::Run => 0,
            Order::Hold => 1,
            Order::Resume => 2,
            Order::Reset => 3,
            Order::Stop => 4,
            Order::Cancel | Order::Mode(_) | Order::Home(_) => 5,
        };
        self.counts.orders[place] += 1;
        self.random.act(|| format!("order: {order:?}"));
        let command = BoardCommand {
            echo: Some(self.beat.beat),
            ..BoardCommand::order(order, self.status.count)
        };
        self.pending = Some(Pending {
            command,
            since: self.now,
            sent: self.now,
        });
        self.send(command.frame(NODE));
    }

    /// Stops or restarts the heartbeats of the gateway. The board misses one until the next has arrived.
    pub fn beat(&mut self, beats: bool) {
        self.beats = beats;
        self.lost_beats = self.lost_beats.max(1);
    }

    /// True where the board misses a heartbeat of the gateway.
    pub fn misses_beat(&self) -> bool {
        self.lost_beats > 0
    }

    /// An order is under way.
    pub fn is_ordering(&self) -> bool {
        self.pending.is_some()
    }

    /// A reset of the machine or of the node is on its way.
    fn is_resetting(&self) -> bool {
        let order = self.pending.and_then(|pending| pending.command.order);
        order == Some(Order::Reset) || self.operator.resets_node()
    }

    /// Sets overrides and switches.
    pub fn levels(&mut self, levels: BoardCommand) {
        let count = self.status.count;
        let command = BoardCommand { count, ..levels };
        self.random.act(|| format!("switches: {levels:?}"));
        self.send(command.frame(NODE));
    }

    /// One tick of the whole bench.
    pub fn tick(&mut self) {
        self.now += 1;
        self.counts.ticks += 1;
        self.random.tick(self.now);
        self.random.set_acts(true);
        Operator::act(self);
        self.random.set_acts(false);
        if !self.sim.has_power() {
            self.end = Some(End::PowerCut);
            return;
        }
        self.remind();
        if self.is_resetting() {
            self.alarm.asks(self.now);
        }
        // An order between the ticks may have been a reset.
        self.alarm.look(&self.state());
        if self.slip_over.is_some_and(|over| self.now > over) {
            self.slip_over = None;
            self.watch.set_slipped(self.slipped);
        }
        let row = self.sim.step();
        let well = self.operator.is_well();
        self.watch.set_assumed(self.assumed != [false; 3]);
        self.watch
            .tick(&self.sim, well, self.operator.is_spindle_well());
        if let Some(row) = row {
            self.watch.row(&row);
        }
        self.listen();
        while let Some(event) = self.sim.event() {
            self.event(&event);
        }
        self.alarm.look(&self.state());
        self.watch.between(&self.sim);
        (self.must)(self);
    }

    /// This many ticks.
    pub fn ticks(&mut self, count: u64) {
        for _ in 0..count {
            self.tick();
        }
    }

    /// The gateway's own actions: heartbeats, repeated orders, and a start for a silent node.
    fn remind(&mut self) {
        if self.beats
            && self.now.is_multiple_of(BEAT_TICKS)
            && let Some(gateway) = NodeId::new(GATEWAY)
        {
            let arrived = self.send(NmtState::Operational.frame(gateway));
            self.lost_beats = if arrived { 0 } else { self.lost_beats + 1 };
            if self.lost_beats >= SILENT_BEATS {
                self.operator.cause(&[Code::GatewayLost]);
            }
        }
        if self.now > self.heard + 200
            && self.now.is_multiple_of(50)
            && !self.operator.leaves_node_alone()
        {
            self.send(NmtCommand::Start.frame(Some(NODE)));
        }
        if self.is_cut_off()
            && let Some(pending) = &mut self.pending
        {
            pending.since = self.now;
        }
        if let Some(pending) = self.pending {
            if self.status.count == pending.command.count {
                self.pending = None;
                return;
            }
            assert!(
                self.now - pending.since < ANSWER_TICKS,
                "order {:?} is not answered: {:?}",
                pending.command,
                self.status
            );
            if self.now - pending.sent >= REPEAT_TICKS {
                // Each repetition shows its own age.
                let mut pending = pending;
                pending.command.echo = Some(self.beat.beat);
                self.pending = Some(Pending {
                    sent: self.now,
                    ..pending
                });
                self.send(pending.command.frame(NODE));
            }
        }
    }

    /// True while the board is off the bus. It comes back when its machine stands. A turning spindle delays this, because
    /// it cannot be told to stop.
    fn is_cut_off(&self) -> bool {
        matches!(
            self.state(),
            State::Stopping(Outcome::Alarm(Alarm {
                code: Code::BusOff,
                ..
            }))
        )
    }

    /// Frames of the board reach the gateway, or get lost.
    fn listen(&mut self) {
        while let Some(frame) = self.sim.transmit() {
            if let Some((NODE, NmtState::BootUp)) = NmtState::decode(&frame) {
                // After a reset of the communication alone, the board still knows the count of the last order: the same
                // count would repeat that order.
                self.status = BoardStatus {
                    count: self.status.count,
                    ..BoardStatus::default()
                };
                if self.operator.took_node_reset() {
                    // The application has started again.
                    self.pending = None;
                    if self.end.is_none() {
                        self.end = Some(End::BootUp);
                    }
                }
            }
            for _ in 0..self.copies() {
                if let Some((NODE, status)) = BoardStatus::decode(&frame) {
                    self.status = status;
                    self.heard = self.now;
                } else if let Some(beat) = BoardBeat::decode(&frame, NODE) {
                    self.beat = beat;
                } else if !self.received.is_full() {
                    let _ = self.received.push_back(frame);
                }
            }
        }
    }

    fn event(&mut self, event: &Event) {
        if let Event::Alarm(alarm) | Event::Warning(alarm) = event
            && alarm.code == Code::IndexSlipped
        {
            self.slipped = false;
            self.slip_over = Some(self.now + LATE_ROWS);
        }
        match event {
            Event::Alarm(alarm) => {
                self.counts.alarms += 1;
                self.counts.bus += u64::from(OF_BUS.contains(&alarm.code));
                self.alarm.raise(alarm, self.now);
                assert!(
                    self.operator.explains(alarm),
                    "an alarm without a cause: {alarm:?}"
                );
                self.end = Some(End::Alarm(*alarm));
            }
            Event::Reset if self.end.is_none() => self.end = Some(End::Reset),
            Event::Finished if self.end.is_none() => self.end = Some(End::Finished),
            _ => {}
        }
    }

    /// Ticks until `done`.
    pub fn until(&mut self, what: &str, most: u64, mut done: impl FnMut(&Self) -> bool) {
        let begun = self.now;
        while !done(self) {
            self.tick();
            assert!(
                self.now - begun <= most,
                "{what}: still {:?} after {most} ticks, {:?}",
                self.state(),
                self.status
            );
            if !self.sim.has_power() {
                return;
            }
        }
    }

    /// Gives an order and waits for the board's answer.
    pub fn ordered(&mut self, order: Order) {
        if order == Order::Run && !self.sim.board().device().mode().runs() {
            self.ordered(Order::Mode(OperatingMode::Automatic));
        }
        self.until("an order before", ANSWER_TICKS, |bench| {
            !bench.is_ordering()
        });
        self.order(order);
        self.until("an order", ANSWER_TICKS, |bench| !bench.is_ordering());
    }

    /// Waits for so many ticks without any action. Nothing may move.
    pub fn stands(&mut self, ticks: u64) {
        let mut at = self.position();
        let mood = core::mem::replace(&mut self.operator.mood, Mood::AWAY);
        for _ in 0..ticks {
            let starting = self.state() == State::Starting;
            self.tick();
            if starting && self.state() != State::Starting {
                if self.operator.is_well() {
                    self.keeps(at);
                }
                // A drive that was elsewhere reports its position.
                at = self.position();
            }
            assert_eq!(self.position(), at, "it moves again");
        }
        self.operator.mood = mood;
    }

    /// The position is kept, over a reset or another set of parameters.
    pub fn keeps(&self, before: Position) {
        let now = self.position();
        assert!(
            drives::is_kept(&self.params, &self.options, before, now),
            "the position is not kept: {before:?}, now {now:?}"
        );
    }

    /// Writes an object while time passes.
    ///
    /// # Errors
    /// The board's refusal; [`SdoError::TimedOut`] where the power has gone.
    pub fn write(
        &mut self,
        object: Object,
        data: &[u8],
        expected: &[Abort],
    ) -> Result<(), SdoError> {
        let protocol = self.protocol(data.len());
        let mut last = SdoError::TimedOut;
        for _ in 0..TRIES {
            let now = self.time();
            let mut transfer = SdoDownload::new(NODE, object, data, protocol, PATIENCE, now);
            match self.transfer(&mut transfer) {
                Err(error) if self.again(error, expected) => last = error,
                outcome => return outcome,
            }
        }
        panic!(
            "a write of {object:?} ends with {last:?} however often it is tried: {:?}",
            self.status
        );
    }

    /// Reads an object of at most `room` bytes while time passes. Returns their number.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn read(&mut self, object: Object, room: &mut [u8]) -> Result<usize, SdoError> {
        let protocol = self.protocol(room.len());
        let mut last = SdoError::TimedOut;
        for _ in 0..TRIES {
            let now = self.time();
            let mut sink = SdoBuffer::new(&mut *room);
            let mut transfer = SdoUpload::new(NODE, object, &mut sink, protocol, PATIENCE, now);
            match self.transfer(&mut transfer) {
                Err(error) if self.again(error, &[Abort::NoData]) => last = error,
                outcome => return outcome.map(|()| sink.bytes().len()),
            }
        }
        panic!(
            "a read of {object:?} ends with {last:?} however often it is tried: {:?}",
            self.status
        );
    }

    /// Reads a number.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn number(&mut self, index: u16, sub: u8) -> Result<u64, SdoError> {
        let mut room = [0; 8];
        let count = self.read(Object::new(index, sub), &mut room)?;
        let bytes = room[..count].iter().rev();
        Ok(bytes.fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }

    fn protocol(&mut self, length: usize) -> SdoProtocol {
        // Segments are answered one by one: on a bad wire many of them never all arrive.
        let bad = self.wire.lost > 0;
        if length <= 8 {
            SdoProtocol::Short
        } else if bad {
            SdoProtocol::Block
        } else {
            self.random.of(&[
                SdoProtocol::Block,
                SdoProtocol::Block,
                SdoProtocol::Segmented,
            ])
        }
    }

    /// True where a transfer with this end is tried again: a frame was lost, or the node did not listen for a while.
    fn again(&self, error: SdoError, expected: &[Abort]) -> bool {
        if !self.sim.has_power() {
            return false;
        }
        match error {
            SdoError::Refused(code) => !expected.iter().any(|abort| abort.code() == code),
            _ => true,
        }
    }

    fn time(&self) -> Duration {
        Duration::from_millis(self.now)
    }

    fn transfer(&mut self, transfer: &mut impl Transfer) -> Result<(), SdoError> {
        self.counts.transfers += 1;
        self.received.clear();
        // Number of turns to send for both sides in a tick.
        let turns = self.random.within(1, 12);
        loop {
            for _ in 0..turns {
                let now = self.time();
                let mut sent = 0;
                while sent < 16
                    && let Some(frame) = transfer.poll(now)
                {
                    self.send(frame);
                    sent += 1;
                }
                if let Some(outcome) = transfer.outcome() {
                    return outcome;
                }
                self.sim.settle();
                self.listen();
                while let Some(frame) = self.received.pop_front() {
                    transfer.receive(&frame, now);
                }
            }
            self.tick();
            if !self.sim.has_power() {
                return Err(SdoError::TimedOut);
            }
            let now = self.time();
            while let Some(frame) = self.received.pop_front() {
                transfer.receive(&frame, now);
            }
        }
    }

    /// True where the gateway reads this state.
    pub fn says(&self, state: BoardState) -> bool {
        self.status.state == state
    }
}
