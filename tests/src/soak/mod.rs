//! A machine at work for hours, with an operator who presses anything at any time. It checks what must never happen.
//!
//! ```text
//! programs ─► gateway's side (batches, SDO client, orders) ─► wire that loses frames ─► board ─► drives, spindle, flash
//!    watch: every tick                       operator: orders, overrides, faults, losses of power
//! ```
//!
//! Everything comes from a seed. A soak is a row of *shifts*, each with a machine, parameters, a wire and an operator of
//! its own. Shift n has seed + n, so a failing shift can be repeated alone: `cargo xtask soak --seed SEED --ticks 1`. A
//! failing shift is also reduced: the printed shift is the least that fails in the same way.

mod alarms;
mod bench;
mod by_hand;
mod drives;
mod encoder;
mod hours;
mod operator;
mod parameters;
mod programs;
mod script;
mod shift;
mod shrink;
mod trouble;
mod watch;

pub use bench::{Bench, Counts};
pub use hours::{Failures, Report, Until, hours};
pub use script::{Chance, Luck, Script, Told, Written};
pub use shrink::{Failure, Must, Shortest, shrink};
pub use watch::Judged;

use encoder::Class;
use script::Draws;

/// Approximate ticks of a shift, which ends after a program.
pub const SHIFT_TICKS: u64 = 40_000;

/// The result of a soak.
#[derive(Clone, Copy, Debug, Default)]
pub struct Soaked {
    /// Shifts.
    pub shifts: u64,
    /// What was done.
    pub counts: Counts,
    /// What was judged.
    pub judged: Judged,
}

impl core::fmt::Display for Soaked {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self {
            shifts,
            counts,
            judged,
        } = self;
        let [run, hold, resume, reset, stop, other] = counts.orders;
        writeln!(f, "{:>12} ticks in {shifts} shifts", counts.ticks)?;
        writeln!(
            f,
            "{:>12} programs, {} of them to their end",
            counts.programs, counts.finished
        )?;
        writeln!(
            f,
            "{:>12} orders: {run} run, {hold} hold, {resume} resume, {reset} reset, {stop} stop, {other} others; all answered",
            counts.orders.iter().sum::<u64>()
        )?;
        writeln!(
            f,
            "{:>12} faults of drives, spindle, encoder, flash and wire; {} alarms, {} of them of the bus, each with its cause",
            counts.troubles, counts.alarms, counts.bus
        )?;
        writeln!(
            f,
            "{:>12} cuts of power, {} taps brought out of their holes",
            counts.cuts, counts.returns
        )?;
        writeln!(
            f,
            "{:>12} transfers; {} parameter sets taken, {} writes refused; {} frames lost or doubled",
            counts.transfers, counts.pushed, counts.refused, counts.lost
        )?;
        for class in Class::ALL {
            let (count, nm) = (
                judged.threads[class as usize],
                judged.thread_nm[class as usize],
            );
            writeln!(
                f,
                "{count:>12} setpoints on a helix {}, at most {nm} nm off",
                class.name()
            )?;
        }
        for class in Class::ALL {
            let (count, nm) = (judged.tools[class as usize], judged.tool_nm[class as usize]);
            writeln!(
                f,
                "{count:>12} of the tool behind drives that lag {}, at most {nm} nm off",
                class.name()
            )?;
        }
        writeln!(
            f,
            "{:>12} setpoints in the groove that the program's text asks for",
            judged.grooves
        )?;
        writeln!(
            f,
            "{:>12} on the line of a rigid tap, {} nm; {} of an ordinary one, {} nm",
            judged.taps, judged.tap_nm, judged.floats, judged.float_nm
        )?;
        let [speed, acceleration, jerk] = judged.used.map(|share| share * 100.0);
        write!(
            f,
            "{speed:>10.2} % of the speed, {acceleration:.2} % of the acceleration, {jerk:.2} % of the jerk of an axis used at most"
        )
    }
}

/// Soaks for at least so many ticks. `between` is called after every program, when nothing of it may be left.
///
/// # Panics
/// Where anything happens that must not. Seed and tick are printed, and the least that fails in the same way.
pub fn soak(seed: u64, ticks: u64, mut between: impl FnMut(&Counts)) -> Soaked {
    let mut soaked = Soaked::default();
    while soaked.counts.ticks < ticks {
        let seed = seed.wrapping_add(soaked.shifts);
        let worked = shrink::work(seed, Draws::live(seed), None, |_| {}, &mut between);
        if let Some(failure) = worked.failure {
            eprintln!("{failure}");
            if let Some(shortest) = shrink(seed, |_| {}) {
                eprintln!("{shortest}");
            }
            failure.go_on();
        }
        soaked.counts.add(&worked.counts);
        soaked.judged.add(&worked.judged);
        soaked.shifts += 1;
    }
    soaked
}
