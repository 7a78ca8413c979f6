//! The book of a run: every setpoint, and how well the synchronised ones were met.

use crate::board::snapshot::Snapshot;
use crate::bus::{BoardState, Periods};
use crate::link::{Certificate, SetpointHash, VERSION};
use crate::units::Length;

/// What has been written down since the program was started.
#[derive(Debug)]
pub struct Ledger {
    program: u32,
    hash: SetpointHash,
    /// A tick of the run was not seen.
    gap: bool,
    measured: u64,
    largest: Length,
    squares: u64,
}

impl Ledger {
    pub const fn new(program: u32) -> Self {
        Self {
            program,
            hash: SetpointHash::new(),
            gap: false,
            measured: 0,
            largest: Length::ZERO,
            squares: 0,
        }
    }

    /// Takes what is known after a poll: the last setpoint, and the error of the one before.
    pub fn take(&mut self, elapsed: Periods, snapshot: &Snapshot, error: Option<Length>) {
        match elapsed.get() {
            0 => return,
            1 => {}
            _ => self.gap |= self.hash.ticks() > 0,
        }
        let setpoint = &snapshot.setpoint;
        let spindle = setpoint
            .spindle
            .map(|angle| (snapshot.spindle_in_use, angle));
        let runs = snapshot.board_state() == BoardState::Run;
        self.hash.push(setpoint.position, spindle, runs);
        if let Some(error) = error {
            self.measured = self.measured.saturating_add(1);
            self.largest = self.largest.max(error.abs());
            let nm = error.nm().unsigned_abs();
            self.squares = self.squares.saturating_add(nm.saturating_mul(nm));
        }
    }

    pub fn certificate(&self, late: u32) -> Certificate {
        Certificate {
            version: VERSION,
            program: self.program,
            ticks: self.hash.ticks(),
            setpoint_hash: (!self.gap).then_some(self.hash.value()),
            measured: self.measured,
            largest: self.largest,
            squares: self.squares,
            late,
        }
    }
}
