//! The record of a run: every setpoint, and the errors of the synchronised ones.

use super::actual::Actual;
use super::threads::Threads;
use crate::bus::{BoardState, Periods};
use crate::link::Event;
use crate::link::{Certificate, LinkError, SetpointHash, Tally, VERSION};
use crate::params::Params;
use crate::tick::{Measured, Snapshot};

/// The record since the program was started, and of its threads.
#[derive(Debug)]
pub struct RunRecorder {
    program: u32,
    /// A tick of the run was missed.
    gap: bool,
    hash: SetpointHash,
    tally: Tally,
    actual: Actual,
    /// Since power-up: the threads of a program stay when the next program begins.
    pub threads: Threads,
}

impl RunRecorder {
    pub const fn new() -> Self {
        Self {
            program: 0,
            gap: false,
            hash: SetpointHash::new(),
            tally: Tally::NONE,
            actual: Actual::new(),
            threads: Threads::new(),
        }
    }

    /// A program is started.
    pub const fn begin(&mut self, program: u32) {
        self.program = program;
        self.gap = false;
        self.hash = SetpointHash::new();
        self.tally = Tally::NONE;
    }

    /// Records the last setpoint. `elapsed`: at least one period.
    pub fn write(&mut self, elapsed: Periods, snapshot: &Snapshot) {
        self.gap |= elapsed != Periods::new(1) && self.hash.ticks() > 0;
        let setpoint = &snapshot.setpoint;
        let spindle = setpoint
            .spindle
            .map(|angle| (snapshot.spindle_in_use, angle));
        let runs = snapshot.board_state() == BoardState::Run;
        self.hash.push(setpoint.position, spindle, runs);
    }

    /// Takes the error of the setpoint before, if it was measured, and the state of the machine. `elapsed`: at least one
    /// period; `late`: late setpoints since power-up.
    pub fn judge(
        &mut self,
        elapsed: Periods,
        snapshot: &Snapshot,
        measured: Option<&Measured>,
        late: u32,
        params: &Params,
    ) {
        let followed = measured.and_then(|measured| measured.followed.as_ref());
        let sample = self.actual.judge(elapsed, snapshot, followed, params);
        if let Some(measured) = measured {
            self.tally.take(measured.error);
            self.threads.measure(measured, sample.as_ref(), late);
        } else {
            self.threads.leave_stroke();
        }
        self.threads.go_on(snapshot);
    }

    /// Takes an event.
    pub fn note(&mut self, event: &Event) {
        self.threads.note(event);
    }

    pub fn certificate(&self, late: u32) -> Certificate {
        Certificate {
            version: VERSION,
            program: self.program,
            ticks: self.hash.ticks(),
            setpoint_hash: (!self.gap).then_some(self.hash.value()),
            measured: self.tally.measured.into(),
            largest: self.tally.largest,
            squares: self.tally.squares,
            late,
        }
    }

    /// Puts the content of 5041h into `bytes`. Returns the number of bytes.
    pub fn read(&self, late: u32, bytes: &mut [u8]) -> Result<usize, LinkError> {
        self.threads.encode(&self.certificate(late), bytes)
    }
}
