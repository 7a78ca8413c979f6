//! The book of a run: every setpoint, and how well the synchronised ones were met.

use super::threads::Threads;
use crate::board::event::Event;
use crate::board::reference::Measured;
use crate::board::snapshot::Snapshot;
use crate::bus::{BoardState, Periods};
use crate::link::{Certificate, LinkError, SetpointHash, Tally, VERSION};

/// What has been written down: since the program was started, and of its threads.
#[derive(Debug)]
pub struct RunRecorder {
    program: u32,
    /// A tick of the run was not seen.
    gap: bool,
    hash: SetpointHash,
    tally: Tally,
    /// Since power-up: what a program has cut is not forgotten with the next.
    pub threads: Threads,
}

impl RunRecorder {
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            program: 0,
            gap: false,
            hash: SetpointHash::new(),
            tally: Tally::NONE,
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

    /// Writes down the last setpoint; `elapsed`: at least a period.
    pub fn write(&mut self, elapsed: Periods, snapshot: &Snapshot) {
        self.gap |= elapsed != Periods::new(1) && self.hash.ticks() > 0;
        let setpoint = &snapshot.setpoint;
        let spindle = setpoint
            .spindle
            .map(|angle| (snapshot.spindle_in_use, angle));
        let runs = snapshot.board_state() == BoardState::Run;
        self.hash.push(setpoint.position, spindle, runs);
    }

    /// Takes the error of the setpoint before, where one was measured, and how the machine is. `late`: setpoints that have
    /// come late since power-up.
    pub fn judge(&mut self, snapshot: &Snapshot, measured: Option<&Measured>, late: u32) {
        if let Some(measured) = measured {
            self.tally.take(measured.error);
            self.threads.measure(measured, late);
        } else {
            self.threads.leave_stroke();
        }
        self.threads.go_on(snapshot);
    }

    /// Takes what has happened.
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

    /// Puts what 5041h holds into `bytes`; how many that are comes back.
    pub fn read(&self, late: u32, bytes: &mut [u8]) -> Result<usize, LinkError> {
        self.threads.encode(&self.certificate(late), bytes)
    }
}
