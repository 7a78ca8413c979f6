//! The simulated machine with a program in it, as far as somebody has let time pass.
//!
//! Does what `leadscrew simulate` does, tick by tick. Knows no words of the page.

use leadscrew_board_sim::line::{Faults, Span as Ticks};
use leadscrew_board_sim::plant::{Encoder, PlantOptions, ServoOptions, Trouble};
use leadscrew_board_sim::{Doing, Row, Sim, SimError};
use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::board::{Command, Event, Inputs, State};
use leadscrew_core::call::{Call, CallKind, Position, TapSpindle};
use leadscrew_core::link::SetpointHash;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Length};
use leadscrew_inspection::{Cut, Cutting, Instant};
use serde::{Deserialize, Serialize};

/// Ticks that give one sample of the error: the greatest of them.
const TICKS_A_SAMPLE: u32 = 8;

/// The error of a synchronous move at a place, in nanometres; X is a radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Sample {
    z: i64,
    x: i64,
    error: i64,
    line: u32,
    step: u32,
}

/// What goes wrong; it stays wrong until the next machine.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// The emergency stop is pressed.
    Estop,
    /// The spindle stands against its command.
    SpindleStalls,
    /// Its drive is overloaded, and it turns at seven tenths of its speed.
    SpindleSlow,
    /// Interference moves the encoder's counter.
    EncoderSlips,
    /// The drive of Z is too hot.
    DriveHot,
    /// It answers no more.
    DriveSilent,
    /// The axis is blocked.
    AxisBlocked,
    /// The cable of the bus is pulled out.
    BusUnplugged,
}

/// A machine at work.
pub struct Machine {
    sim: Box<Sim>,
    calls: std::vec::IntoIter<Call>,
    waiting: Option<Call>,
    hash: SetpointHash,
    row: Option<Row>,
    line: u32,
    ticks: u64,
    sample: Option<Sample>,
    of_sample: u32,
    samples: Vec<Sample>,
    worst_nm: i64,
    /// The threads, where they are to be measured.
    cutting: Option<Cutting>,
    stopping: bool,
    over: bool,
    /// Alarms and warnings not told yet.
    pub told: Vec<Alarm>,
}

impl Machine {
    /// A machine at power-up that carries out these calls, and cuts these threads.
    ///
    /// # Errors
    /// No such machine.
    pub fn new(
        params: &Params,
        options: &PlantOptions,
        mut calls: Vec<Call>,
        cutting: Option<Cutting>,
    ) -> Result<Self, SimError> {
        // Without M02 or M30 a call tells the board that no more come.
        if !calls
            .last()
            .is_some_and(|call| matches!(call.kind, CallKind::End(_)))
        {
            calls.push(Call {
                span: Span::default(),
                origin: Position::ZERO,
                kind: CallKind::Over,
            });
        }
        let mut calls = calls.into_iter();
        Ok(Self {
            sim: Box::new(Sim::new(params, options)?),
            waiting: calls.next(),
            calls,
            hash: SetpointHash::new(),
            row: None,
            line: 0,
            ticks: 0,
            sample: None,
            of_sample: 0,
            samples: Vec::new(),
            worst_nm: 0,
            cutting,
            stopping: false,
            over: false,
            told: Vec::new(),
        })
    }

    /// Gives an operator's command.
    pub fn command(&mut self, command: Command) {
        self.sim.command(command);
    }

    /// Something goes wrong.
    pub fn fault(&mut self, fault: Fault) {
        let sim = &mut self.sim;
        match fault {
            Fault::Estop => sim.set_pins(Inputs {
                stop: true,
                ..Inputs::default()
            }),
            Fault::SpindleStalls => sim.plant().spindle().disturb(0),
            Fault::SpindleSlow => sim.plant().spindle().disturb(70),
            Fault::EncoderSlips => sim.plant().encoder().slip(Encoder::SLIP),
            Fault::DriveHot => sim.plant().drive(Axis::Z).trouble(Trouble::HOT),
            Fault::DriveSilent => sim.plant().drive(Axis::Z).trouble(Trouble::Silent),
            Fault::AxisBlocked => sim.plant().drive(Axis::Z).trouble(Trouble::Stuck),
            Fault::BusUnplugged => {
                let from_now = Ticks {
                    from: sim.ticks(),
                    to: u64::MAX,
                };
                let mut faults = Faults::NONE;
                faults.cable_out = Some(from_now);
                sim.spoil(faults);
            }
        }
    }

    /// Lets so many ticks pass, or fewer if the program ends.
    pub fn step(&mut self, ticks: u32) {
        for _ in 0..ticks {
            if self.over {
                return;
            }
            self.tick();
        }
    }

    fn tick(&mut self) {
        while !self.stopping
            && let Some(call) = &self.waiting
            && self.sim.offer(call)
        {
            self.waiting = self.calls.next();
        }
        if let Some(row) = self.sim.step() {
            self.take(&row);
        }
        self.ticks += 1;
        while let Some(event) = self.sim.event() {
            match event {
                Event::Started { line, .. } => self.line = line,
                Event::Alarm(mut alarm) => {
                    self.stopping = true;
                    if alarm.span.line == 0 {
                        alarm.span.line = self.line;
                        alarm.span.column = 1;
                        alarm.span.end = u16::MAX;
                    }
                    self.told.push(alarm);
                }
                Event::Warning(alarm) => self.told.push(alarm),
                _ => {}
            }
        }
        let state = self.sim.board().ticker().state();
        self.over = match self.stopping {
            true => matches!(state, State::Idle | State::Held | State::Alarm(_)),
            false => self.waiting.is_none() && !self.sim.is_busy(),
        };
        if self.over {
            let mut rest = Vec::new();
            self.sim.last_rows(|row| rest.push(row));
            rest.iter().for_each(|row| self.take(row));
            self.close_sample();
            // A thread that an alarm has ended is not whole.
            if let Some(cutting) = &mut self.cutting
                && !self.stopping
            {
                cutting.finish();
            }
        }
    }

    fn take(&mut self, row: &Row) {
        let spindle = TapSpindle::ALL
            .iter()
            .find_map(|spindle| Some((*spindle, row.angle(*spindle).set?)));
        self.hash
            .push(row.position, spindle, row.doing == Doing::Run);
        if let Some(cutting) = &mut self.cutting {
            cutting.take(&instant(row));
        }
        let error = row.cut.map(|cut| cut.error).or(row.error);
        self.row = Some(*row);
        let Some(error) = error.map(|error| error.nm()) else {
            return self.close_sample();
        };
        if error.abs() > self.worst_nm.abs() {
            self.worst_nm = error;
        }
        if self.sample.is_none_or(|of| error.abs() >= of.error.abs()) {
            self.sample = Some(Sample {
                z: row.position.z.nm(),
                x: row.position.x.nm(),
                error,
                line: row.line,
                step: row.number,
            });
        }
        self.of_sample += 1;
        if self.of_sample >= TICKS_A_SAMPLE {
            self.close_sample();
        }
    }

    fn close_sample(&mut self) {
        self.samples.extend(self.sample.take());
        self.of_sample = 0;
    }

    /// The samples since the last call.
    pub fn samples(&mut self) -> Vec<Sample> {
        std::mem::take(&mut self.samples)
    }

    /// The threads that were measured since the last call.
    pub fn cuts(&mut self) -> Vec<Cut> {
        let cutting = self.cutting.as_mut();
        cutting.map_or_else(Vec::new, Cutting::done)
    }

    /// What it is doing.
    pub fn state(&self) -> MachineState {
        let row = self.row;
        MachineState {
            ticks: self.ticks,
            time_ms: self.ticks * u64::from(self.sim.tick_us()) / 1000,
            x: row.map_or(0, |row| row.position.x.nm()),
            z: row.map_or(0, |row| row.position.z.nm()),
            line: row.map_or(0, |row| row.line),
            doing: row.map_or(Doing::Idle, |row| row.doing).name(),
            rpm: self.sim.board().ticker().observer().speed().rpm().get(),
            over: self.over,
            worst_nm: self.worst_nm,
            setpoint_hash: format!("{:016x}", self.hash.value()),
            hashed_ticks: self.hash.ticks(),
        }
    }
}

/// What the machine is doing; lengths in nanometres, X is a radius.
#[derive(Clone, Debug, Serialize)]
pub struct MachineState {
    ticks: u64,
    time_ms: u64,
    x: i64,
    z: i64,
    line: u32,
    doing: &'static str,
    rpm: i32,
    /// The program is at its end, or the machine stands on an alarm.
    pub over: bool,
    worst_nm: i64,
    /// Of the setpoints so far.
    pub setpoint_hash: String,
    hashed_ticks: u64,
}

/// Where the tool is at a tick: where its drives have moved it, or where ideal ones are told to be.
fn instant(row: &Row) -> Instant {
    let place = row.actual.unwrap_or([row.position.x, row.position.z]);
    Instant::new(
        row.number.into(),
        row.spindle.micro_turns(),
        place.map(Length::nm),
    )
}

/// A drive with this gain of its position loop in 1/s: without feed-forward, friction or play, so that its lag shows.
#[must_use]
pub const fn drive(kv: u32) -> ServoOptions {
    ServoOptions {
        kv_milli: kv.saturating_mul(1000),
        ..ServoOptions::LOOPS_ALONE
    }
}
