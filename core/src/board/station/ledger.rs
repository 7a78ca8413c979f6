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
            // Ticks do not come to the end of 64 bits.
            self.measured = self.measured.wrapping_add(1);
            self.largest = self.largest.max(error.abs());
            let square = match u32::try_from(error.nm().unsigned_abs()) {
                Ok(nm) => u64::from(nm).wrapping_mul(nm.into()),
                Err(_) => u64::MAX,
            };
            self.squares = self.squares.saturating_add(square);
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
