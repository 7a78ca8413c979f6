//! A whole machine in virtual time: the board, and the plant around it, in lock-step.
//!
//! A tick is not taken while the background has work that it could do, so the stream of setpoints depends on nothing but
//! the calls, the parameters and the options. The simulation sees the truth and judges the board by it; the board sees
//! frames and encoder samples alone.

mod faults;
mod judge;
mod network;
mod row;

pub use row::{Doing, Row, SpindleAngle, TapPoint};

use heapless::{Deque, Vec};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Board, Command, Event, Outcome, Output, PowerUp, State};
use leadscrew_core::bus::{FdFrame, Frame, Periods};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::motion::{Motion, Setpoint};
use leadscrew_core::params::Params;
use leadscrew_core::program::Call;
use leadscrew_core::signals::Signals;
use leadscrew_core::spindle::EncoderSample;
use leadscrew_core::units::{Axis, Rpm, Turns};

use self::judge::{Delay, LATENCY_TICKS, Law, Pending, TRUTHS};
use crate::line::{Line, Way};
use crate::plant::{FineTurns, Flash, Plant, PlantError, PlantOptions};
use crate::storage::{keep, stored_params, stored_tap};

/// Frames the drives send in one period at most.
const ANSWERS: usize = 24;

/// Answers of the drives to SDO requests that nobody has taken yet.
const TO_OTHERS: usize = 16;

/// Frames that one becomes on its way at most, and those that waited for it.
const OUT: usize = 8;

/// On the wire from here on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Board to drives.
    FromBoard,
    /// Drives to board.
    ToBoard,
}

/// Why there is no machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SimError {
    /// The plant cannot be.
    Plant(PlantError),
    /// The board refuses to start, or what is stored makes no sense.
    Board(Alarm),
}

/// A board, its drives, its spindle, and time that goes by when it is told to.
pub struct Sim {
    board: Board,
    plant: Plant,
    tick_us: u32,
    /// Increments of a spindle's drive to a turn.
    spindle_increments: u32,
    /// From the SYNC that takes a setpoint to its effect, on X and on Z.
    delays: [Delay; 2],
    /// 5275: rows of ordinary taps are judged by the angle so many ticks later.
    lag: usize,
    ticks: u64,
    sample: EncoderSample,
    /// On their way to the board.
    answers: Vec<Frame, ANSWERS>,
    /// The last one.
    setpoint: Setpoint,
    pending: Deque<Pending, LATENCY_TICKS>,
    /// The frame with all setpoints of the last tick.
    together: Option<FdFrame>,
    /// The line of the last tap.
    line: Option<Law>,
    /// By how many turns the board counts ahead of the truth: an application that
    /// begins anew counts whole turns from there.
    ahead: Turns,
    /// The spindles' angles at the last SYNCs, oldest first, as many as rows wait for.
    truths: Deque<[FineTurns; 4], TRUTHS>,
    /// What is kept over a loss of power; off from that on.
    flash: Flash,
    /// Answers of the drives to somebody else on the bus.
    to_others: Deque<Frame, TO_OTHERS>,
    /// What goes wrong with frames.
    wire: Line,
    /// On their way to whoever else is on the bus.
    out: Deque<Frame, OUT>,
}

impl Sim {
    /// A machine at power-up, its drives enabled and its axes standing: that is tick 0, and the row the first
    /// [`step`](Self::step) gives.
    ///
    /// # Errors
    /// A plant or a board that cannot be; a drive that does not start.
    pub fn new(params: &Params, options: &PlantOptions) -> Result<Self, SimError> {
        let up = PowerUp::given(params);
        let (sim, _) = Self::start_with(&up, options, Flash::erased(), None)?;
        Ok(sim)
    }

    /// The same with the flash of a board that has run before: [`flash`](Self::flash) gives it back. Its power is switched
    /// on. A parameter set that is stored in it counts; `built_in` is what the board has where there is none.
    ///
    /// # Errors
    /// As [`new`](Self::new); [`TapJournalDamaged`](leadscrew_core::alarm::Code::TapJournalDamaged)
    /// for a flash that cannot be read.
    pub fn with_flash(
        built_in: &Params,
        options: &PlantOptions,
        flash: Flash,
    ) -> Result<Self, SimError> {
        let (sim, alarm) = Self::start_from(built_in, options, flash)?;
        alarm.map_or(Ok(sim), |alarm| Err(SimError::Board(alarm)))
    }

    /// As [`with_flash`](Self::with_flash), but a board that stands on an alarm about its stored parameters is a machine,
    /// too: nothing moves, and it can be talked to.
    ///
    /// # Errors
    /// As [`with_flash`](Self::with_flash).
    pub fn power_up(
        built_in: &Params,
        options: &PlantOptions,
        flash: Flash,
    ) -> Result<Self, SimError> {
        Self::start_from(built_in, options, flash).map(|(sim, _)| sim)
    }

    /// With what is stored in a flash, whose power is switched on; also the alarm that withholds motion.
    fn start_from(
        built_in: &Params,
        options: &PlantOptions,
        mut flash: Flash,
    ) -> Result<(Self, Option<Alarm>), SimError> {
        flash.power(true);
        let tap = stored_tap(&mut flash).map_err(SimError::Board)?;
        let up = stored_params(&mut flash, built_in).map_err(SimError::Board)?;
        Self::start_with(&up, options, flash, tap)
    }

    /// Also the alarm that withholds motion because of what is stored.
    fn start_with(
        up: &PowerUp,
        options: &PlantOptions,
        flash: Flash,
        tap: Option<TapRecord>,
    ) -> Result<(Self, Option<Alarm>), SimError> {
        let params = &up.params;
        let plant = Plant::new(params, options).map_err(SimError::Plant)?;
        let board = Board::power_up(up, Some(options.at), tap).map_err(SimError::Board)?;
        let tick_us = params.tick_us();
        let mut sim = Self {
            board,
            plant,
            tick_us,
            spindle_increments: params.spindle_increments(),
            delays: [Axis::X, Axis::Z].map(|axis| Delay::of(params, axis)),
            lag: params.tap_lag_cycles() as usize,
            ticks: 0,
            sample: EncoderSample::default(),
            answers: Vec::new(),
            setpoint: Setpoint::default(),
            pending: Deque::new(),
            together: None,
            line: None,
            ahead: Turns::default(),
            truths: Deque::new(),
            flash,
            to_others: Deque::new(),
            wire: Line::default(),
            out: Deque::new(),
        };
        let withheld = sim.start(up.found.alarm())?;
        Ok((sim, withheld))
    }

    /// Lets the drives come up. Their steps have times of their own, so this ends.
    fn start(&mut self, expected: Option<Alarm>) -> Result<Option<Alarm>, SimError> {
        let mut output = Output::default();
        loop {
            self.advance();
            self.board.tick(self.sample, &self.answers, &mut output);
            self.exchange(&output.frames, &mut |_, _| {});
            self.tell_together(&output);
            self.keep();
            while let Some(event) = self.board.event() {
                match event {
                    Event::Ready => {
                        // Tick 0: the axes stand, and no call has come yet.
                        let none = self.step();
                        debug_assert!(none.is_none(), "a row takes a tick to be known");
                        return Ok(None);
                    }
                    Event::Alarm(alarm) if expected == Some(alarm) => return Ok(expected),
                    Event::Alarm(alarm) => return Err(SimError::Board(alarm)),
                    _ => {}
                }
            }
        }
    }

    /// Time goes by up to the next SYNC.
    fn advance(&mut self) {
        self.sample = self.plant.advance();
        if self.truths.is_full() {
            self.truths.pop_front();
        }
        // There is room now.
        let truth = self.plant.truth();
        let [second, third, fourth] = truth.tappers;
        let _ = self.truths.push_back([truth.angle, second, third, fourth]);
    }

    /// What the board sends reaches the drives, and they answer.
    fn exchange(&mut self, frames: &[Frame], wire: &mut dyn FnMut(Direction, &Frame)) {
        self.answers.clear();
        if !self.wire.is_quiet() {
            self.exchange_on_bad_wire(frames, wire);
            return;
        }
        for frame in frames {
            wire(Direction::FromBoard, frame);
        }
        let answers = &mut self.answers;
        self.plant.exchange(frames, |frame| {
            wire(Direction::ToBoard, &frame);
            // Seven drives with a status, a boot-up and an emergency each: that many fit.
            let _ = answers.push(frame);
        });
    }

    /// The frame with all setpoints, where the drives get them so.
    fn tell_together(&mut self, output: &Output) {
        let node = self.board.device().node();
        self.together = output
            .together
            .as_ref()
            .and_then(|together| together.frame(node));
        if let Some(frame) = &self.together {
            let (wire, plant) = (&mut self.wire, &mut self.plant);
            wire.pass_together(Way::Setpoints, frame, |frame| plant.tell_together(frame));
        }
    }

    /// The frame with all setpoints of the last tick, where the drives get them so: behind the others of that tick.
    #[must_use]
    pub const fn together(&self) -> Option<&FdFrame> {
        self.together.as_ref()
    }

    /// Carries out the writes that the board asks for. They are done before the next tick, so that nothing depends on how
    /// long they take.
    fn keep(&mut self) {
        keep(&mut self.board, &mut self.flash);
    }

    /// Time of a tick in microseconds.
    #[must_use]
    pub const fn tick_us(&self) -> u32 {
        self.tick_us
    }

    /// The flash of the board.
    #[must_use]
    pub const fn flash(&self) -> &Flash {
        &self.flash
    }

    /// The flash of the board, to make trouble: a write can be cut in the middle ([`Flash::cut_after`]) or refused.
    pub const fn flash_mut(&mut self) -> &mut Flash {
        &mut self.flash
    }

    /// The power goes: from now on nothing happens any more. What is stored is in [`flash`](Self::flash).
    pub const fn cut_power(&mut self) {
        self.flash.power(false);
    }

    /// True until the power goes.
    #[must_use]
    pub const fn has_power(&self) -> bool {
        self.flash.is_on()
    }

    /// Drops the entry of a tap that is in its hole; see [`Board::discard_tap`].
    pub fn discard_tap(&mut self) -> bool {
        self.has_power() && self.board.discard_tap()
    }

    /// Hands a call to the board; false where it has no room now.
    #[must_use]
    pub fn offer(&mut self, call: &Call) -> bool {
        if !self.has_power() {
            return false;
        }
        let taken = self.board.offer(call);
        while self.board.background() {}
        taken
    }

    /// An operator's command.
    pub const fn command(&mut self, command: Command) {
        self.board.command(command);
    }

    /// Sets the inputs; they act in the next tick, and on the next call that is taken up.
    pub const fn signals(&mut self, signals: Signals) {
        self.board.signals(signals);
    }

    /// The oldest event not yet read.
    pub fn event(&mut self) -> Option<Event> {
        self.board.event()
    }

    /// True while anything handed over has not been carried out.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.has_power() && self.board.is_busy()
    }

    /// The board, for what it can tell.
    #[must_use]
    pub const fn board(&self) -> &Board {
        &self.board
    }

    /// The plant, to disturb it.
    pub const fn plant(&mut self) -> &mut Plant {
        &mut self.plant
    }

    /// Commanded spindle speed, override included.
    #[must_use]
    pub fn spindle_command(&self) -> Rpm {
        self.board.ticker().spindle_command()
    }

    /// One tick. A row comes back as soon as it is known what was true when its setpoint took effect: one tick later,
    /// and the drives' latency on top.
    pub fn step(&mut self) -> Option<Row> {
        self.step_on(&mut |_, _| {})
    }

    /// As [`step`](Self::step), showing every frame on its way.
    pub fn step_on(&mut self, wire: &mut dyn FnMut(Direction, &Frame)) -> Option<Row> {
        if !self.has_power() {
            return None;
        }
        self.advance();
        if !self.wire.is_good() {
            self.suffer();
        }
        let ready = self.release();
        while self.board.background() {}
        let mut output = Output::default();
        self.board.tick(self.sample, &self.answers, &mut output);
        let setpoint = output.setpoint;
        self.setpoint = setpoint;
        let law = self.law(setpoint.locked);
        let ahead = self.ahead(setpoint.locked);
        let doing = match (self.board.ticker().state(), setpoint.motion) {
            (State::Alarm(_) | State::Stopping(Outcome::Alarm(_)), _) => Doing::Alarm,
            (_, Motion::Hold) | (State::Held, _) => Doing::Hold,
            (_, Motion::Dwell) => Doing::Dwell,
            (_, Motion::Wait) => Doing::Wait,
            (_, Motion::Run) => Doing::Run,
            // The next segment is not there yet.
            (State::Running, Motion::Idle) => Doing::Wait,
            (_, Motion::Idle) if self.board.ticker().in_program() => Doing::Wait,
            _ => Doing::Idle,
        };
        let mut row = Row {
            tick: self.ticks,
            t_us: self.ticks.wrapping_mul(u64::from(self.tick_us)),
            position: setpoint.position,
            spindle: FineTurns::default(),
            spindle_set: None,
            tappers: Default::default(),
            line: setpoint.line,
            number: setpoint.number,
            doing,
            error: None,
            tap: None,
        };
        row.set_angle(self.board.ticker().tap_spindle(), setpoint.spindle);
        self.ticks = self.ticks.wrapping_add(1);
        self.exchange(&output.frames, wire);
        self.tell_together(&output);
        self.keep();
        if self.board.device().has_joined() {
            self.serve(Periods::new(1));
        } else {
            // Nobody asks for anything: it keeps its book.
            self.board.serve(Periods::new(1), &self.setpoint);
        }
        // Released above as soon as it is due: there is always room.
        let _ = self.pending.push_back(Pending { row, law, ahead });
        ready
    }
}
