//! A whole machine in virtual time: the board, and the plant around it, in lock-step.
//!
//! The simulation takes no tick while the background has work to do. So the stream of setpoints depends on the calls,
//! the parameters and the options only. The simulation sees the truth and judges the board by it; the board sees only
//! frames and encoder samples.

mod faults;
mod judge;
mod network;
mod row;

pub use row::{CutPoint, Doing, Row, SpindleAngle, TapPoint};

use heapless::{Deque, Vec};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Board, Command, Event, Inputs, Outcome, Output, PowerUp, State};
use leadscrew_core::bus::{FdFrame, Frame};
use leadscrew_core::call::Call;
use leadscrew_core::journal::TapRecord;
use leadscrew_core::motion::Motion;
use leadscrew_core::offsets::image::Image;
use leadscrew_core::params::Params;
use leadscrew_core::signals::Signals;
use leadscrew_core::spindle::EncoderSample;
use leadscrew_core::units::{Axis, Rpm, Turns};

use self::judge::{Delay, Instant, LATENCY_TICKS, Law, Pending, TRUTHS};
use crate::around::Around;
use crate::line::{Line, Way};
use crate::pins::show_pins;
use crate::plant::{FineTurns, Flash, Plant, PlantError, PlantOptions};
use crate::storage::{keep, stored_params, stored_start, stored_tap};
use crate::wheel::Wheel;

/// The most frames that the drives send in one period.
const ANSWERS: usize = 24;

/// Answers of the drives to SDO requests that wait to be taken.
const TO_OTHERS: usize = 16;

/// The most frames that one frame becomes on its way, together with those that waited for it.
const OUT: usize = 8;

/// The direction of a frame on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Board to drives.
    FromBoard,
    /// Drives to board.
    ToBoard,
}

/// Why a machine cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SimError {
    /// The plant is impossible.
    Plant(PlantError),
    /// The board refuses to start, or the stored data make no sense.
    Board(Alarm),
}

/// A board, its drives, its spindle, and time that passes on command.
pub struct Sim {
    board: Board,
    plant: Plant,
    tick_us: u32,
    /// Increments of a spindle's drive in a turn.
    spindle_increments: u32,
    /// The delay from the SYNC that takes a setpoint to its effect, on X and on Z.
    delays: [Delay; 2],
    /// 5275: rows of ordinary taps are judged by the angle this number of ticks later.
    lag: usize,
    ticks: u64,
    sample: EncoderSample,
    /// Frames on their way to the board.
    answers: Vec<Frame, ANSWERS>,
    pending: Deque<Pending, LATENCY_TICKS>,
    /// The frame with all setpoints of the last tick.
    together: Option<FdFrame>,
    /// The line of the last tap.
    line: Option<Law>,
    /// The number of turns by which the board's count is above the truth: an application that begins anew counts
    /// whole turns from zero.
    ahead: Turns,
    /// The truth at the last SYNCs, oldest first, as many as the rows need.
    truths: Deque<Instant, TRUTHS>,
    /// The flash. It keeps its content over a loss of power; after a cut it is off.
    flash: Flash,
    /// Answers of the drives to other nodes on the bus.
    to_others: Deque<Frame, TO_OTHERS>,
    /// The faults of the wire.
    wire: Line,
    /// The pins, as they were set.
    pins: Inputs,
    around: Around,
    wheel: Wheel,
    /// Frames on their way to other nodes on the bus.
    out: Deque<Frame, OUT>,
}

impl Sim {
    /// A machine at power-up, its drives enabled and its axes at rest. That is tick 0, and the row of the first
    /// [`step`](Self::step).
    ///
    /// # Errors
    /// A plant or a board is impossible; a drive does not start.
    pub fn new(params: &Params, options: &PlantOptions) -> Result<Self, SimError> {
        let up = PowerUp::given(params);
        let (sim, _) = Self::start_with(&up, options, Flash::erased(), None)?;
        Ok(sim)
    }

    /// The same with a table of offsets on the board.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_offsets(
        params: &Params,
        options: &PlantOptions,
        offsets: Image,
    ) -> Result<Self, SimError> {
        let mut up = PowerUp::given(params);
        up.offsets.table = offsets;
        let (sim, _) = Self::start_with(&up, options, Flash::erased(), None)?;
        Ok(sim)
    }

    /// The same with the flash of a board that has run before: [`flash`](Self::flash) gives it back. Its power is
    /// switched on. A parameter set stored in it counts; `built_in` is the board's own set where none is stored.
    ///
    /// # Errors
    /// As [`new`](Self::new); [`TapJournalDamaged`](leadscrew_core::alarm::Code::TapJournalDamaged)
    /// for a flash that cannot be read.
    pub fn with_flash(
        built_in: &Params,
        options: &PlantOptions,
        flash: Flash,
    ) -> Result<Self, SimError> {
        let (sim, alarm) = Self::start_from(built_in, options, flash, stored_params)?;
        alarm.map_or(Ok(sim), |alarm| Err(SimError::Board(alarm)))
    }

    /// As [`with_flash`](Self::with_flash), but accepts a board that stands on an alarm about its stored parameters:
    /// nothing moves, and it answers on the bus.
    ///
    /// # Errors
    /// As [`with_flash`](Self::with_flash).
    pub fn power_up(
        built_in: &Params,
        options: &PlantOptions,
        flash: Flash,
    ) -> Result<Self, SimError> {
        Self::start_from(built_in, options, flash, stored_params).map(|(sim, _)| sim)
    }

    /// The same for a machine that goes on in its flash: the board counts the start, and has a serial number. Whoever only
    /// looks into a flash does not start a board.
    ///
    /// # Errors
    /// As [`with_flash`](Self::with_flash).
    pub fn switch_on(
        built_in: &Params,
        options: &PlantOptions,
        flash: Flash,
        serial: u32,
    ) -> Result<Self, SimError> {
        let (mut sim, _) = Self::start_from(built_in, options, flash, stored_start)?;
        sim.board.set_serial(serial);
        Ok(sim)
    }

    /// Starts with the content of a flash, whose power is switched on. Also gives the alarm that withholds motion.
    fn start_from(
        built_in: &Params,
        options: &PlantOptions,
        mut flash: Flash,
        stored: impl FnOnce(&mut Flash, &Params) -> Result<PowerUp, Alarm>,
    ) -> Result<(Self, Option<Alarm>), SimError> {
        flash.power(true);
        let tap = stored_tap(&mut flash).map_err(SimError::Board)?;
        let up = stored(&mut flash, built_in).map_err(SimError::Board)?;
        Self::start_with(&up, options, flash, tap)
    }

    /// Starts the machine. Also gives the alarm that withholds motion because of the stored data.
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
            pending: Deque::new(),
            together: None,
            line: None,
            ahead: Turns::default(),
            truths: Deque::new(),
            flash,
            to_others: Deque::new(),
            wire: Line::default(),
            pins: Inputs::default(),
            around: Around::default(),
            wheel: Wheel::default(),
            out: Deque::new(),
        };
        let withheld = sim.start(up.found.alarm())?;
        Ok((sim, withheld))
    }

    /// Lets the drives come up. Each of their steps takes limited time, so this ends.
    fn start(&mut self, expected: Option<Alarm>) -> Result<Option<Alarm>, SimError> {
        let mut output = Output::default();
        loop {
            self.advance();
            self.look_around();
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

    /// Lets time pass up to the next SYNC.
    fn advance(&mut self) {
        self.sample = self.plant.advance();
        if self.truths.is_full() {
            self.truths.pop_front();
        }
        // There is room now.
        let truth = self.plant.truth();
        let [second, third, fourth] = truth.tappers;
        let _ = self.truths.push_back(Instant {
            angles: [truth.angle, second, third, fourth],
            loads: truth.loads,
        });
    }

    /// Passes the board's frames to the drives, and collects their answers.
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
            // There is room for seven drives with a status, a boot-up message and an emergency each.
            let _ = answers.push(frame);
        });
    }

    /// Sends the frame with all setpoints, where the drives get them in one frame.
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

    /// The frame with all setpoints of the last tick, where the drives get them in one frame. It comes after the other
    /// frames.
    #[must_use]
    pub const fn together(&self) -> Option<&FdFrame> {
        self.together.as_ref()
    }

    /// Carries out the writes that the board requests. They end before the next tick, so that nothing depends on their
    /// duration.
    fn keep(&mut self) {
        keep(&mut self.board, &mut self.flash);
    }

    /// The length of a tick in microseconds.
    #[must_use]
    pub const fn tick_us(&self) -> u32 {
        self.tick_us
    }

    /// The flash of the board.
    #[must_use]
    pub const fn flash(&self) -> &Flash {
        &self.flash
    }

    /// The flash of the board, to give it faults: a write can be cut in the middle ([`Flash::cut_after`]) or refused.
    pub const fn flash_mut(&mut self) -> &mut Flash {
        &mut self.flash
    }

    /// Cuts the power: nothing happens any more. The stored data are in [`flash`](Self::flash).
    pub const fn cut_power(&mut self) {
        self.flash.power(false);
    }

    /// True until the power is cut.
    #[must_use]
    pub const fn has_power(&self) -> bool {
        self.flash.is_on()
    }

    /// Discards the entry of a tap that is in its hole; see [`Board::discard_tap`].
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

    /// Gives the board an operator's command.
    pub fn command(&mut self, command: Command) {
        self.board.command(command);
    }

    /// Sets the inputs; they act in the next tick, and on the next call that is taken up.
    pub fn signals(&mut self, signals: Signals) {
        self.board.signals(signals);
    }

    /// Sets the board's pins: contacts and what else is wired to it. They act from the next tick on.
    pub const fn set_pins(&mut self, inputs: Inputs) {
        self.pins = inputs;
    }

    /// Turns the handwheel at the board's own input by so many detents, as fast as a hand does.
    pub const fn turn_wheel(&mut self, counts: i32) {
        self.wheel.turn(counts);
    }

    /// The handwheel is being turned.
    #[must_use]
    pub const fn wheel_turns(&self) -> bool {
        self.wheel.is_turning()
    }

    /// What is around the machine, as far as the pins do not say it.
    pub const fn around(&mut self) -> &mut Around {
        &mut self.around
    }

    /// The board sees its pins.
    fn look_around(&mut self) {
        show_pins(
            &mut self.board,
            &mut self.plant,
            &mut self.around,
            self.pins,
        );
    }

    /// The oldest event not yet read.
    pub fn event(&mut self) -> Option<Event> {
        self.board.event()
    }

    /// True while a call that was handed over is not carried out.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.has_power() && self.board.is_busy()
    }

    /// The board, to read its state.
    #[must_use]
    pub const fn board(&self) -> &Board {
        &self.board
    }

    /// Ticks so far: the next row has this number.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
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

    /// Runs one tick. Gives a row as soon as the truth at its effect is known: one tick later, plus the drives' latency.
    pub fn step(&mut self) -> Option<Row> {
        self.step_on(&mut |_, _| {})
    }

    /// As [`step`](Self::step), and shows every frame on its way.
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
        self.look_around();
        self.board.tick(self.sample, &self.answers, &mut output);
        let setpoint = output.setpoint;
        let law = self.law(setpoint.locked);
        let ahead = self.ahead(setpoint.locked);
        let doing = match (self.board.ticker().state(), setpoint.motion) {
            (State::Alarm(_) | State::Stopping(Outcome::Alarm(_)), _) => Doing::Alarm,
            (_, Motion::Hold) | (State::Held, _) => Doing::Hold,
            (_, Motion::Dwell) => Doing::Dwell,
            (_, Motion::Wait) => Doing::Wait,
            (_, Motion::Run) => Doing::Run,
            // The next segment has not come yet.
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
            actual: None,
            cut: None,
        };
        row.set_angle(self.board.ticker().tap_spindle(), setpoint.spindle);
        self.ticks = self.ticks.wrapping_add(1);
        self.exchange(&output.frames, wire);
        self.tell_together(&output);
        self.keep();
        let wheel = self.wheel.tick(self.tick_us);
        self.board.own_wheel(wheel);
        if self.board.device().has_joined() {
            self.pass_block(wire);
            self.serve();
        } else {
            // Nobody asks for anything: the board only keeps its records.
            self.board.serve();
        }
        // This row was released above when it was due, so there is always room.
        let _ = self.pending.push_back(Pending { row, law, ahead });
        ready
    }
}
