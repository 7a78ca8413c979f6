//! The steps of a test, one after the other or in two rows, and the time of each.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeVal;

use crate::run;

/// Measures the time of each step, and knows which ones failed.
#[derive(Default)]
pub struct Clock {
    steps: Vec<(&'static str, Times)>,
    failed: Vec<&'static str>,
}

/// The time that something took, and that of the processors in it.
#[derive(Clone, Copy, Default)]
struct Times {
    took: Duration,
    /// Not known of a step beside which another one ran.
    processor: Option<Duration>,
}

impl Clock {
    /// Runs a step. An error ends the test.
    pub fn step(&mut self, name: &'static str, what: impl FnOnce() -> Result<()>) -> Result<()> {
        self.measured(name, processor(), what)
    }

    /// The same where the next steps are to be run whatever comes of it.
    pub fn try_step(&mut self, name: &'static str, what: impl FnOnce() -> Result<()>) {
        let result = self.step(name, what);
        self.note(name, result);
    }

    /// A step beside which others run.
    pub fn try_beside(&mut self, name: &'static str, what: impl FnOnce() -> Result<()>) {
        let result = self.measured(name, None, what);
        self.note(name, result);
    }

    /// Runs two rows of steps at once where there are two cores, and the second gives way to the first; otherwise one after
    /// the other. Output of one may stand in the middle of that of the other.
    pub fn rows(
        &mut self,
        name: &'static str,
        first: impl FnOnce(&mut Self),
        second: impl FnOnce(&mut Self) + Send,
    ) {
        let (mut one, mut other) = (Self::default(), Self::default());
        self.try_step(name, || {
            if thread::available_parallelism()?.get() < 2 {
                first(&mut one);
                second(&mut other);
                return Ok(());
            }
            thread::scope(|scope| {
                let second = scope.spawn(|| {
                    run::give_way();
                    second(&mut other);
                });
                first(&mut one);
                let ended = second.join();
                ended.or_else(|_| bail!("a step that ran beside another has panicked"))
            })
        });
        for row in [one, other] {
            self.steps.extend(row.steps);
            self.failed.extend(row.failed);
        }
    }

    /// The number of steps that failed.
    pub fn failures(&self) -> usize {
        self.failed.len()
    }

    /// The result of all steps.
    pub fn end(&self) -> Result<()> {
        match self.failed.as_slice() {
            [] => Ok(()),
            failed => bail!("failed: {}", failed.join("; ")),
        }
    }

    /// Prints the time of each step, and of those that ran alone that of the processors.
    pub fn report(&self) {
        println!("\n== seconds of each step, and of the processors in it");
        for (name, times) in &self.steps {
            println!("{}", row(name, *times));
        }
        let alone = || self.steps.iter().map(|(_, times)| *times);
        let all = Times {
            took: alone()
                .filter(|times| times.processor.is_some())
                .map(|times| times.took)
                .sum(),
            processor: Some(alone().filter_map(|times| times.processor).sum()),
        };
        println!("{}", row("in all", all));
    }

    fn measured(
        &mut self,
        name: &'static str,
        before: Option<Duration>,
        what: impl FnOnce() -> Result<()>,
    ) -> Result<()> {
        println!("\n== {name}");
        let started = Instant::now();
        let result = what();
        let times = Times {
            took: started.elapsed(),
            processor: before
                .and_then(|before| processor().map(|after| after.saturating_sub(before))),
        };
        println!("{}", row(name, times));
        self.steps.push((name, times));
        result
    }

    fn note(&mut self, name: &'static str, result: Result<()>) {
        if let Err(error) = result {
            println!("error: {name}: {error:#}");
            self.failed.push(name);
        }
    }
}

/// The time that all processors have spent on programs that were started here and have ended.
fn processor() -> Option<Duration> {
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).ok()?;
    let time = |of: TimeVal| {
        let seconds = u64::try_from(of.tv_sec()).ok()?;
        let micros = u64::try_from(of.tv_usec()).ok()?;
        Some(Duration::from_secs(seconds) + Duration::from_micros(micros))
    };
    Some(time(usage.user_time())? + time(usage.system_time())?)
}

/// A line with a step and its times.
fn row(name: &str, times: Times) -> String {
    let processor = times
        .processor
        .map(|time| format!("{:.1}", time.as_secs_f64()));
    let (took, processor) = (times.took.as_secs_f64(), processor.unwrap_or_default());
    format!("{took:>6.1} s {processor:>7}  {name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_fails_does_not_hide_the_next_and_is_told_at_the_end() {
        let mut clock = Clock::default();
        let mut ran = Vec::new();
        clock.try_step("good", || Ok(()));
        assert!(clock.end().is_ok());
        for name in ["one", "two"] {
            clock.try_step(name, || {
                ran.push(name);
                bail!("it does not work")
            });
        }
        assert_eq!(ran, ["one", "two"]);
        let told = clock.end().unwrap_err().to_string();
        assert_eq!(told, "failed: one; two");
    }

    #[test]
    fn what_fails_in_a_row_is_told_and_both_rows_run_to_their_end() {
        let mut clock = Clock::default();
        clock.rows(
            "both",
            |row| {
                row.try_beside("one", || bail!("it does not work"));
                row.try_beside("two", || Ok(()));
            },
            |row| row.try_beside("three", || bail!("nor does this")),
        );
        let names: Vec<_> = clock.steps.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["both", "one", "two", "three"]);
        assert_eq!(clock.failed, ["one", "three"]);
    }
}
