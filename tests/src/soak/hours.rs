//! A soak on all cores, for hours or for a number of ticks. It goes on after a failure and counts failures by kind.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::script::Draws;
use super::shrink::{self, Must, Worked, shrink};
use super::{SHIFT_TICKS, Soaked};

/// The most seeds that are named for one kind of failure.
const NAMED: usize = 8;
/// Time between two reports of progress.
const WORD: Duration = Duration::from_secs(60);

/// The end of a soak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// After at least so many ticks in all.
    Ticks(u64),
    /// After this time by the clock.
    Time(Duration),
}

/// Failures of one kind.
#[derive(Clone, Debug, Default)]
pub struct Failures {
    /// Number of failures.
    pub count: u64,
    /// The first few seeds.
    pub seeds: Vec<u64>,
}

/// The result of a soak.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// The first seed; the others follow.
    pub seed: u64,
    /// What was done and judged.
    pub soaked: Soaked,
    /// Failures by kind.
    pub failures: BTreeMap<String, Failures>,
    /// Its duration.
    pub took: Duration,
}

impl Report {
    /// Number of failed shifts.
    pub fn failed(&self) -> u64 {
        self.failures.values().map(|kind| kind.count).sum()
    }

    /// The result in one line.
    fn line(&self) -> String {
        let last = self.seed + self.soaked.shifts.saturating_sub(1);
        format!(
            "seeds {} to {last}: {} shifts, {} ticks, {:.2} h; {} failures of {} kinds",
            self.seed,
            self.soaked.shifts,
            self.soaked.counts.ticks,
            self.took.as_secs_f64() / 3600.0,
            self.failed(),
            self.failures.len()
        )
    }
}

impl core::fmt::Display for Report {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        writeln!(f, "{}", self.soaked)?;
        for (kind, failures) in &self.failures {
            let seeds: Vec<String> = failures.seeds.iter().map(u64::to_string).collect();
            let more = failures.count > failures.seeds.len() as u64;
            writeln!(
                f,
                "{:>12} × {kind}\n{:>14} seeds {}{}",
                failures.count,
                "",
                seeds.join(" "),
                if more { " …" } else { "" }
            )?;
        }
        write!(f, "{}", self.line())
    }
}

struct State {
    /// The next shift that no thread works yet.
    next: u64,
    /// Finished shifts that wait for an earlier one.
    done: BTreeMap<u64, Worked>,
    /// Kinds of failures that are or were reduced.
    known: BTreeSet<String>,
    report: Report,
    said: Instant,
}

/// A board without optimisation is copied from frame to frame: more than the two megabytes that a thread has otherwise.
const STACK: usize = 16 << 20;

/// Soaks on so many threads, shift n with `seed` + n, and hands every report to `tell` at once.
///
/// # Panics
/// Where there are no more seeds.
pub fn hours(
    seed: u64,
    until: Until,
    threads: usize,
    must: Must,
    tell: &(impl Fn(&str) + Sync),
) -> Report {
    let begun = Instant::now();
    let state = Mutex::new(State {
        next: 0,
        done: BTreeMap::new(),
        known: BTreeSet::new(),
        report: Report {
            seed,
            ..Report::default()
        },
        said: begun,
    });
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            let work = || {
                while let Some(number) = take(&state, until, begun) {
                    let seed = seed.checked_add(number).expect("seeds enough");
                    let worked = shrink::work(seed, Draws::live(seed), None, must, |_| {});
                    if let Some(failure) = &worked.failure
                        && lock(&state).known.insert(failure.kind.clone())
                    {
                        tell(&format!("\n{failure}"));
                        match shrink(seed, must) {
                            Some(shortest) => tell(&format!("{shortest}\n")),
                            None => tell("it fails in another way, or not, when it is repeated\n"),
                        }
                    }
                    give(&state, number, worked, begun, tell);
                }
            };
            let thread = std::thread::Builder::new().stack_size(STACK);
            thread.spawn_scoped(scope, work).expect("a thread");
        }
    });
    let mut report = state
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner)
        .report;
    report.took = begun.elapsed();
    report
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The next shift, if there is one.
fn take(state: &Mutex<State>, until: Until, begun: Instant) -> Option<u64> {
    let mut state = lock(state);
    let over = match until {
        Until::Ticks(ticks) => {
            // The shifts under way come to so many ticks, unless they fail; a thread that finishes later checks again.
            let under_way = (state.next - state.report.soaked.shifts) * SHIFT_TICKS;
            state.report.soaked.counts.ticks + under_way >= ticks
        }
        Until::Time(time) => begun.elapsed() >= time,
    };
    if over {
        return None;
    }
    let number = state.next;
    state.next += 1;
    Some(number)
}

/// Counts a shift, in the order of the seeds.
fn give(state: &Mutex<State>, number: u64, worked: Worked, begun: Instant, tell: &impl Fn(&str)) {
    let mut state = lock(state);
    state.done.insert(number, worked);
    while let Some(worked) = {
        let number = state.report.soaked.shifts;
        state.done.remove(&number)
    } {
        let report = &mut state.report;
        report.soaked.shifts += 1;
        report.soaked.counts.add(&worked.counts);
        report.soaked.judged.add(&worked.judged);
        if let Some(failure) = worked.failure {
            let kind = report.failures.entry(failure.kind).or_default();
            kind.count += 1;
            if kind.seeds.len() < NAMED {
                kind.seeds.push(failure.seed);
            }
        }
    }
    if state.said.elapsed() >= WORD {
        state.said = Instant::now();
        state.report.took = begun.elapsed();
        tell(&state.report.line());
    }
}
