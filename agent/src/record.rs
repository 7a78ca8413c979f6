//! Records: what is told of a machine, one fact each, with its time.
//!
//! They hold plain values that any program can read. What a metric is called stands elsewhere.

mod cut;

use leadscrew_core::link::{Certificate, Status, ThreadCertificate};
use serde::{Deserialize, Serialize};

pub use cut::{Cut, Figure, Measured};

/// A time of the computer's clock: milliseconds since 1970.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Moment(pub u64);

/// What happened, and when the agent knew of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// When the agent knew of it.
    pub at: Moment,
    /// The machine. Records that an earlier version kept for its one machine name none; their store knows whose they are.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub machine: String,
    /// What it is.
    pub body: Body,
}

/// A record with the number under which it is kept. No number is given twice by one store.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbered {
    /// The number, from 1.
    pub number: u64,
    /// The record.
    pub record: Record,
}

/// How much a record is worth where room is short.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Goes first, the oldest of them.
    State,
    /// Goes where no state is left.
    Event,
    /// Never goes.
    Certificate,
}

impl Class {
    /// All of them, in the order in which they go.
    pub const ALL: [Self; 3] = [Self::State, Self::Event, Self::Certificate];
}

/// One fact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Body {
    /// The board answers, or does not any more.
    Presence(Presence),
    /// The machine's state has changed.
    State(State),
    /// The board's log has an entry.
    Event(Event),
    /// The board has other parameters, another firmware, or has started again.
    Identity(Identity),
    /// A thread or a hole has come to its end.
    Thread(Thread),
    /// A program has come to its end.
    Run(Run),
    /// The board forgot what nobody had read.
    Gap(Gap),
    /// The agent gave up what it had no room for.
    Loss(Loss),
}

impl Body {
    /// The word for its kind in what programs read.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Presence(_) => "presence",
            Self::State(_) => "state",
            Self::Event(_) => "event",
            Self::Identity(_) => "identity",
            Self::Thread(_) => "thread",
            Self::Run(_) => "run",
            Self::Gap(_) => "gap",
            Self::Loss(_) => "loss",
        }
    }

    /// What it is worth.
    #[must_use]
    pub const fn class(&self) -> Class {
        match self {
            Self::Presence(_) | Self::State(_) => Class::State,
            Self::Event(_) | Self::Identity(_) => Class::Event,
            Self::Thread(_) | Self::Run(_) | Self::Gap(_) | Self::Loss(_) => Class::Certificate,
        }
    }
}

/// Whether the board answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Presence {
    /// It does.
    pub alive: bool,
    /// Why not, in words; empty where it does.
    pub why: String,
}

/// One start of a board: what numbers of its threads, runs and events belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Start {
    /// The board's serial number; 0 on a simulated one without a name.
    pub serial: u32,
    /// Which start of the board it is: the board's own count, or one of the agent's from [`OWN_COUNTS`] on.
    pub count: u32,
}

/// No board starts as often. Where a board cannot count its starts, the agent gives numbers from here on.
pub const OWN_COUNTS: u32 = 1_000_000_000;

impl Start {
    /// The key of something that the board numbers since this start.
    #[must_use]
    pub fn key(self, number: u32) -> String {
        format!("{:08x}/{}/{number}", self.serial, self.count)
    }
}

/// What the machine does.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct State {
    /// In the words of `status --json`.
    pub state: String,
    /// The same.
    pub mode: String,
    /// Number of the alarm; 0: none.
    pub alarm: u16,
    /// The program that is being carried out, or was last.
    pub program: u32,
    /// Its line; 0: none.
    pub line: u32,
    /// Its move; 0: none.
    pub number: u32,
    /// Override of the feed in per cent.
    pub feed_percent: u8,
    /// Override of the rapid in per cent.
    pub rapid_percent: u8,
    /// Override of the spindle in per cent.
    pub spindle_percent: u8,
    /// Measured speed of the spindle in turns a minute.
    pub rpm: i32,
    /// Commanded speed of the spindle in turns a minute.
    pub rpm_commanded: i32,
    /// Feed hold is on.
    pub hold: bool,
    /// Single block is on.
    pub single_block: bool,
    /// Setpoints that came late for their SYNC, since power-up.
    pub late: u32,
    /// Load of the bus in per cent; `None` where it was not measured yet.
    pub load_percent: Option<u8>,
    /// Error frames seen on the bus since the agent began.
    pub bus_errors: u64,
}

impl State {
    /// The state of a status record.
    #[must_use]
    pub fn of(status: &Status, mode: &str) -> Self {
        Self {
            state: status.state.name().to_owned(),
            mode: mode.to_owned(),
            alarm: status.alarm.map_or(0, |alarm| alarm.code.number()),
            program: status.program,
            line: status.line,
            number: status.number,
            feed_percent: status.feed_percent,
            rapid_percent: status.rapid_percent,
            spindle_percent: status.spindle_percent,
            rpm: status.speed.rpm().get(),
            rpm_commanded: status.command.get(),
            hold: status.hold,
            single_block: status.single_block,
            late: status.late,
            load_percent: None,
            bus_errors: 0,
        }
    }
}

/// An entry of the board's log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Event {
    /// The start that its number belongs to.
    pub start: Start,
    /// Its number in the log.
    pub number: u32,
    /// When it happened, in ticks since power-up.
    pub tick: u64,
    /// What happened.
    pub what: What,
}

/// What a log tells.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum What {
    /// The machine has stopped.
    Alarm(Trouble),
    /// Something stops nothing.
    Warning(Trouble),
    /// A line that was typed is not carried out, and nothing of it was done.
    Refused(Trouble),
    /// The program has come to its end.
    Finished,
    /// A reset is done.
    Reset,
    /// The axes have come to rest by a hold.
    Held,
    /// The drives are on.
    Ready,
}

impl What {
    /// The word for it in what programs read.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Alarm(_) => "alarm",
            Self::Warning(_) => "warning",
            Self::Refused(_) => "refused",
            Self::Finished => "finished",
            Self::Reset => "reset",
            Self::Held => "held",
            Self::Ready => "ready",
        }
    }

    /// Its alarm, where there is one.
    #[must_use]
    pub const fn trouble(&self) -> Option<&Trouble> {
        match self {
            Self::Alarm(trouble) | Self::Warning(trouble) | Self::Refused(trouble) => Some(trouble),
            Self::Finished | Self::Reset | Self::Held | Self::Ready => None,
        }
    }
}

/// An alarm in words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trouble {
    /// Its number.
    pub number: u16,
    /// The line of the program; 0: none.
    pub line: u32,
    /// The cause.
    pub cause: String,
    /// The remedy.
    pub remedy: String,
}

/// What a board is, as far as it can be told apart from another or from itself before.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Its start.
    pub start: Start,
    /// CRC-32 of the parameter set in force.
    pub parameters: u32,
    /// Its firmware.
    pub firmware: String,
}

/// The errors of a thread, a hole or a run against the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Errors {
    /// Ticks in which the error was measured.
    pub measured: u64,
    /// The largest in nm.
    pub largest_nm: i64,
    /// Sum of their squares in nm².
    pub squares: u64,
}

impl Errors {
    /// Root of the mean of their squares in µm; 0 where nothing was measured.
    #[must_use]
    pub fn rms_um(&self) -> f64 {
        if self.measured == 0 {
            return 0.0;
        }
        (self.squares as f64 / self.measured as f64).sqrt() / NM_IN_UM
    }

    /// The largest in µm.
    #[must_use]
    pub fn largest_um(&self) -> f64 {
        self.largest_nm as f64 / NM_IN_UM
    }
}

/// Nanometres in a micrometre.
const NM_IN_UM: f64 = 1000.0;

/// The certificate of a thread or a hole.
// Words and numbers of its own: what is kept is read by the next version of this program too.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thread {
    /// The start that its number belongs to.
    pub start: Start,
    /// Its number since that start.
    pub number: u32,
    /// The program that was in force when it was read; the certificate itself names none. 0: another has run since it was
    /// cut, or may have, and nobody knows.
    pub program: u32,
    /// Its line.
    pub line: u32,
    /// In the words of `run --json`.
    pub kind: String,
    /// The same.
    pub end: String,
    /// Strokes along the helix.
    pub passes: u16,
    /// Setpoints that came late meanwhile.
    pub late: u16,
    /// Its errors.
    pub errors: Errors,
    /// Its cut. A record of an earlier version has none.
    #[serde(default)]
    pub cut: Cut,
}

impl Thread {
    /// What the board says, and what its cut is judged to be.
    #[must_use]
    pub fn of(start: Start, program: u32, certificate: &ThreadCertificate, cut: Cut) -> Self {
        let record = &certificate.record;
        let tally = &record.tally;
        Self {
            start,
            number: certificate.number,
            program,
            line: record.line,
            kind: record.kind.name().to_owned(),
            end: record.state.name().to_owned(),
            passes: tally.passes,
            late: tally.late,
            errors: Errors {
                measured: tally.measured.into(),
                largest_nm: tally.largest.nm(),
                squares: tally.squares,
            },
            cut,
        }
    }
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Run {
    /// The start that its program belongs to.
    pub start: Start,
    /// Number of the program on the board.
    pub program: u32,
    /// It came to its end; else an alarm or a reset ended it.
    pub finished: bool,
    /// Ticks from the first to the last in state run.
    pub ticks: u64,
    /// CRC-64/XZ over their setpoints; `None` where the board could not include every tick.
    pub setpoint_hash: Option<u64>,
    /// Setpoints that came late, since power-up.
    pub late: u32,
    /// Its errors.
    pub errors: Errors,
}

impl Run {
    /// What the board says.
    #[must_use]
    pub const fn of(start: Start, finished: bool, run: &Certificate) -> Self {
        Self {
            start,
            program: run.program,
            finished,
            ticks: run.ticks,
            setpoint_hash: run.setpoint_hash,
            late: run.late,
            errors: Errors {
                measured: run.measured,
                largest_nm: run.largest.nm(),
                squares: run.squares,
            },
        }
    }
}

/// Numbers that the board had forgotten before they were read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Gap {
    /// The start that they belong to.
    pub start: Start,
    /// Of what.
    pub of: Missing,
    /// The first of them.
    pub first: u32,
    /// The last of them.
    pub last: u32,
}

/// What can be missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Missing {
    /// Certificates of threads and holes.
    Threads,
    /// Entries of the log.
    Events,
    /// Results of runs: their numbers are those of the entries of the log that say that they finished.
    Runs,
}

impl Missing {
    /// The word for it in what programs read.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Threads => "threads",
            Self::Events => "events",
            Self::Runs => "runs",
        }
    }
}

/// Records that the agent has given up for want of room.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Loss {
    /// How many.
    pub records: u64,
    /// The number of the first of them.
    pub first: u64,
    /// The number of the last of them.
    pub last: u64,
}
