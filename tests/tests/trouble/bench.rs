//! The program that is disturbed, its ticks, and what comes after it.

use leadscrew_board_sim::Row;
use leadscrew_core::board::{Command, State};
use leadscrew_core::params::Params;
use leadscrew_tests::bench::{Bench, Lathe, NEXT, WORK};

/// How a machine on a bench of its own recovers after trouble.
pub trait Recovers {
    /// Clears an alarm and comes up again.
    fn reset(&mut self, what: &str);

    /// Runs a program that must end well at `x`, `z` (nm).
    fn runs(&mut self, what: &str, text: &str, x: i64, z: i64);

    /// The next program, thread and all: on its helix.
    fn next(&mut self, what: &str);
}

impl Recovers for Lathe {
    fn reset(&mut self, what: &str) {
        self.sim.command(Command::Reset);
        self.alarm = None;
        self.tick();
        self.until(what, 2_000, |bench| bench.state() == State::Idle);
        assert_eq!(self.alarm, None, "{what}");
    }

    fn runs(&mut self, what: &str, text: &str, x: i64, z: i64) {
        self.load(text);
        self.finish(what);
        assert_eq!(self.alarm, None, "{what}");
        assert_eq!(
            (self.at().x.nm(), self.at().z.nm()),
            (x, z),
            "{what}: not where it ends"
        );
    }

    fn next(&mut self, what: &str) {
        let from = self.rows.len();
        self.runs(what, NEXT, 40_000_000, 10_000_000);
        let worst = self.rows[from..]
            .iter()
            .filter_map(|row| row.error)
            .map(|error| error.nm().abs())
            .max()
            .unwrap_or_else(|| panic!("{what}: no thread"));
        assert!(worst <= 1_000, "{what}: {worst} nm off the helix");
    }
}

pub fn calm(params: &Params) -> Vec<Row> {
    let mut bench = Lathe::new(params);
    bench.runs("calm", WORK, 35_000_000, 8_000_000);
    bench.rows
}

/// Ticks of `calm`'s program at which something can happen.
pub fn places(rows: &[Row], step: usize) -> impl Iterator<Item = u64> {
    (1..rows.len() as u64 - 1).step_by(step)
}

/// The same, from one on that is drawn for the commit: no two commits try the same.
pub fn drawn_places(rows: &[Row], step: usize) -> impl Iterator<Item = u64> {
    let first = leadscrew_seed::fresh() % step as u64;
    places(rows, 1).skip(first as usize).step_by(step)
}
