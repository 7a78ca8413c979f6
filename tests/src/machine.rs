//! Runs a program on the simulated machine: from text to rows.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Row, Sim};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::call::{Call, CallKind};
use leadscrew_core::params::Params;
use leadscrew_core::program::{self, Events, Options};

/// Ticks that a run continues after the machine has no more work.
pub const STANDING_TICKS: usize = 20;

/// A run counts as hanging after this many ticks.
const LONGEST: u64 = 4_000_000;

/// The result of a run.
#[derive(Debug, Default)]
pub struct Ran {
    /// Every tick, first to last.
    pub rows: Vec<Row>,
    /// Events of the board.
    pub events: Vec<Event>,
    /// The alarm that stopped it.
    pub alarm: Option<Alarm>,
}

/// The calls of a program.
///
/// # Panics
/// Where the text is refused: the programs of these tests are right.
#[must_use]
pub fn calls(text: &str, params: &Params) -> Vec<Call> {
    Events::new(text.as_bytes(), params, Options::default())
        .filter_map(|event| match event.expect("the program is right") {
            program::Event::Call(call) => Some(call),
            program::Event::Warning(_) => None,
        })
        .collect()
}

/// The calls of a line that is typed: its end is that of a line, not of a program.
///
/// # Panics
/// As [`calls`].
#[must_use]
pub fn calls_of_line(text: &str, params: &Params) -> Vec<Call> {
    let mut line = calls(text, params);
    let over = Call {
        kind: CallKind::LineOver,
        ..line[0]
    };
    line.retain(|call| call.kind != CallKind::Over);
    line.push(over);
    line
}

/// A machine just switched on.
///
/// # Panics
/// Where the parameters cannot work.
#[must_use]
pub fn machine(params: &Params, options: &PlantOptions) -> Sim {
    Sim::new(params, options).expect("the machine starts")
}

/// A feed hold at a tick, and a resume so many ticks after the machine stands.
#[derive(Clone, Copy, Debug)]
pub struct Pause {
    at: u64,
    lasts: u64,
    since: Option<u64>,
}

impl Pause {
    /// Not begun yet.
    #[must_use]
    pub const fn new(at: u64, lasts: u64) -> Self {
        Self {
            at,
            lasts,
            since: None,
        }
    }

    /// What the operator does before a tick.
    pub fn operate(&mut self, sim: &mut Sim, ticks: u64) {
        if ticks == self.at {
            sim.command(Command::Hold);
        }
        match self.since {
            Some(since) if since + self.lasts == ticks => sim.command(Command::Resume),
            None if ticks > self.at && sim.board().ticker().state() == State::Held => {
                self.since = Some(ticks);
            }
            _ => {}
        }
    }

    /// The tick from which the machine stood; `None` where it never did.
    #[must_use]
    pub const fn since(&self) -> Option<u64> {
        self.since
    }
}

/// Runs a program to its end. `operate` is called before every tick with the machine and the ticks so far.
///
/// # Panics
/// Where the machine does not come to an end.
pub fn run(
    text: &str,
    params: &Params,
    options: &PlantOptions,
    operate: impl FnMut(&mut Sim, u64),
) -> Ran {
    run_calls(calls(text, params), params, options, operate)
}

/// As [`run`], for calls.
///
/// # Panics
/// Where the machine does not come to an end.
pub fn run_calls(
    calls: Vec<Call>,
    params: &Params,
    options: &PlantOptions,
    operate: impl FnMut(&mut Sim, u64),
) -> Ran {
    run_calls_on(machine(params, options), calls, operate)
}

/// As [`run_calls`], on a prepared machine.
///
/// # Panics
/// Where the machine does not come to an end.
pub fn run_calls_on(mut sim: Sim, calls: Vec<Call>, mut operate: impl FnMut(&mut Sim, u64)) -> Ran {
    let mut waiting = calls.into_iter().peekable();
    let mut ran = Ran::default();
    let mut ticks = 0;
    while waiting.peek().is_some() || sim.is_busy() {
        while waiting.peek().is_some_and(|call| sim.offer(call)) {
            waiting.next();
        }
        assert!(ticks < LONGEST, "the machine does not come to an end");
        operate(&mut sim, ticks);
        ran.rows.extend(sim.step());
        ticks += 1;
        while let Some(event) = sim.event() {
            if let Event::Alarm(alarm) = event {
                ran.alarm = Some(alarm);
            }
            if let Event::Reset | Event::Refused(_) = event {
                waiting = Vec::new().into_iter().peekable();
            }
            ran.events.push(event);
        }
        if ran.alarm.is_some() {
            waiting = Vec::new().into_iter().peekable();
        }
    }
    // Nothing may happen later.
    for _ in 0..STANDING_TICKS {
        ran.rows.extend(sim.step());
    }
    sim.last_rows(|row| ran.rows.push(row));
    ran
}
