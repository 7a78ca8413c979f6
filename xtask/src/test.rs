//! All checks that a change must pass, in the order that finds most mistakes soonest. The checks that find most take
//! ten minutes; `--full` adds the rest.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Result, bail};

use crate::{
    audit, bits, canopen, chip, docs, emulated, emulator, image, licences, manual, packages, page,
    renew, rules, run, setup, shop, sizes, target, vcan as bus,
};

/// The number of tests of a program that run at once. Tests with processes and time-outs mostly wait, so that a core
/// has time for several of them.
const THREADS: &str = "RUST_TEST_THREADS";
const THREADS_PER_CORE: usize = 4;

/// Printed after a test that was not a full one.
const NOT_RUN: &str = "\
not run here, but by `cargo xtask test --full`, which is what .ci/run starts:
  the long volumes: a million moves, cuts of power in writes of the flash, ten million ticks of soak
  tests on a CAN bus, with processes that are killed and with other people's tools (alone: cargo xtask vcan)
  instructions per tick and the same bits on the emulated Cortex-M4F (alone: cargo xtask ticks, cargo xtask bits)
  the board on it, driven by `leadscrew`, its failures too (alone: cargo xtask emulated)
  agents, broker and database (alone: cargo xtask shop)
  the flashed image on a model of its chip (alone: cargo xtask chip)
  the page in headless Chromium (alone: cargo xtask page --check)
  flash, RAM and stack of all images (alone: cargo xtask sizes)
  the manual as a book, its links and its pictures (alone: cargo xtask manual --check)
by no test: cargo xtask packages, cargo xtask dist --check, cargo xtask soak --hours H, cargo xtask chip --all, cargo xtask bench, the fuzzers (docs/reliability.md)";

/// Runs the test with full volumes and all steps.
pub fn full() -> Result<()> {
    let mut again = run::cargo(&run::root(), &["xtask", "test"]);
    again.env(leadscrew_seed::FULL, "1");
    run::show(again)
}

/// Runs the test of the README, or all steps where full volumes are asked for.
pub fn test() -> Result<()> {
    let mut counts = Counts::default();
    let mut clock = Clock::default();
    let full = leadscrew_seed::full();

    let (seed, source) = leadscrew_seed::of_run();
    println!("random tests: their fixed cases, and those of seed {seed}, {source}");
    println!(
        "the same again: {} cargo xtask test",
        leadscrew_seed::settings(seed, full)
    );

    clock.step("set-up", || setup::for_test(full))?;
    clock.step("format", format)?;
    clock.step("house rules", rules::check)?;
    clock.step("lock files", lock_files)?;
    clock.step("licences", licences::check)?;
    clock.step("crates that are published", packages::check)?;
    clock.step("clippy", clippy)?;
    clock.step("pages that the program writes", renew::check)?;
    clock.step("documentation", docs::check)?;
    // What is said of one of these steps does not depend on another: all are run, so that one run tells all.
    clock.try_step("tests with overflow checks", || tests(&mut counts));
    clock.try_step("another CANopen master", || {
        counts.passed += canopen::check()?;
        Ok(())
    });
    clock.try_step("no panic is reachable", audit::audit);
    if full {
        clock.try_step("core for the microcontroller", core_alone);
        clock.try_step("instructions per tick", || emulator::ticks(false));
        clock.try_step(
            "tests on a CAN bus, and beside them the same bits on the microcontroller",
            || beside(|| on_a_bus(&mut counts, ""), || bits::bits(false)),
        );
        clock.try_step("images of the boards", || sizes::sizes(false));
        let mut of_chip = 0;
        clock.try_step(
            "the emulated board on a bus, and beside it the image against a model of its chip",
            || {
                beside(
                    || on_the_board(&mut counts, ""),
                    || {
                        of_chip = chip::check("", false)?;
                        Ok(())
                    },
                )
            },
        );
        counts.passed += of_chip;
        clock.try_step("agents, broker and database", || {
            counts.passed += shop::check(None)?;
            Ok(())
        });
        clock.try_step("the manual", manual::check);
        clock.try_step("the page in a browser", page::check);
    } else {
        clock.try_step("the image that is flashed", image::image);
    }

    clock.report();
    if !full {
        println!("\n{NOT_RUN}\n");
    }
    let failed = counts.failed.max(clock.failed.len() as u64);
    println!("{} passed, {failed} failed", counts.passed);
    clock.end()
}

/// Two steps that need a core each, at once where there are two cores. The output of the second may stand in the middle of
/// that of the first.
fn beside(
    first: impl FnOnce() -> Result<()>,
    second: impl FnOnce() -> Result<()> + Send,
) -> Result<()> {
    if thread::available_parallelism()?.get() < 2 {
        first()?;
        return second();
    }
    thread::scope(|scope| {
        let second = scope.spawn(second);
        let first = first();
        let second = second
            .join()
            .unwrap_or_else(|_| bail!("a step that ran beside another has panicked"));
        first.and(second)
    })
}

fn format() -> Result<()> {
    for dir in [run::root(), run::firmware()] {
        run::show(run::cargo(&dir, &["fmt", "--all", "--check"]))?;
    }
    Ok(())
}

/// The lock files must be as committed: then the test builds the same as everybody.
fn lock_files() -> Result<()> {
    for dir in [run::root(), run::firmware(), run::root().join("fuzz")] {
        run::metadata(&dir, &[])?;
    }
    Ok(())
}

fn clippy() -> Result<()> {
    let check = |dir: &Path, what: &[&str]| {
        let args = [&["clippy", "--quiet"], what, &["--", "-D", "warnings"]].concat();
        run::show(run::cargo(dir, &args))
    };
    let of_features =
        "leadscrew-tests/vcan,leadscrew-tests/emulated,leadscrew-web/browser,leadscrew/browser";
    check(
        &run::root(),
        &["--workspace", "--all-targets", "--features", of_features],
    )?;
    let firmware = run::firmware();
    check(&firmware, &["--release", "--workspace"])?;
    check(
        &firmware,
        &[
            "--release",
            "--package",
            "nucleo-g474re",
            "--package",
            "mps2-an386",
            "--features",
            "defmt,mps2-an386/provoke",
        ],
    )
}

fn core_alone() -> Result<()> {
    let build = ["build", "--quiet", "--release", "-p", "leadscrew-core"];
    let target = ["--target", target::TARGET];
    run::show(run::cargo(&run::root(), &[&build[..], &target].concat()))
}

/// Runs only the tests on a CAN bus.
pub fn vcan(filter: &str) -> Result<()> {
    let mut counts = Counts::default();
    on_a_bus(&mut counts, filter)?;
    println!("{} passed, {} failed", counts.passed, counts.failed);
    Ok(())
}

/// Runs only the tests of the emulated board.
pub fn emulated(filter: &str) -> Result<()> {
    let mut counts = Counts::default();
    setup::tools(&[setup::EMULATOR])?;
    target::ensure()?;
    on_the_board(&mut counts, filter)?;
    println!("{} passed, {} failed", counts.passed, counts.failed);
    Ok(())
}

fn on_the_board(counts: &mut Counts, filter: &str) -> Result<()> {
    let before = counts.passed;
    if !emulated::tests(filter, |line| counts.take(line))? {
        bail!("tests of the emulated board failed");
    }
    if counts.passed == before {
        bail!("not one test ran on the emulated board");
    }
    Ok(())
}

fn on_a_bus(counts: &mut Counts, filter: &str) -> Result<()> {
    let before = (counts.passed, counts.failed);
    let ok = bus::tests(filter, |line| counts.take(line))?;
    let ran = counts.passed.saturating_sub(before.0);
    if !ok {
        match counts.failed.saturating_sub(before.1) {
            0 => bail!("the tests on a CAN bus ended without a result"),
            failed => bail!("{failed} tests on a CAN bus failed"),
        }
    }
    if ran == 0 {
        bail!("not one test ran on a CAN bus");
    }
    Ok(())
}

/// The tests that start machines and wait for them most of their time. They need a tenth of a core.
const OF_MACHINES: &str = "desk";

/// Runs and counts all tests of the workspace, documentation examples included: those of machines beside all others.
fn tests(counts: &mut Counts) -> Result<()> {
    run::show(run::cargo(
        &run::root(),
        &["test", "--workspace", "--no-run"],
    ))?;
    let programs = test_programs()?;
    if !programs.iter().any(|name| name == OF_MACHINES) {
        bail!("no package has tests named `{OF_MACHINES}`");
    }
    let mut others = vec!["--lib", "--bins"];
    for name in programs.iter().filter(|name| *name != OF_MACHINES) {
        others.extend(["--test", name]);
    }
    let (mut waiting, mut working) = (Counts::default(), Counts::default());
    let result = beside(
        || some_tests(&["--test", OF_MACHINES], &mut waiting),
        || some_tests(&others, &mut working).and(some_tests(&["--doc"], &mut working)),
    );
    counts.add(&waiting);
    counts.add(&working);
    if result.is_err() {
        println!("{} passed, {} failed", counts.passed, counts.failed);
    }
    result
}

/// Runs and counts the tests that these arguments select. The libraries are those of the whole workspace.
fn some_tests(which: &[&str], counts: &mut Counts) -> Result<()> {
    // Without colours, because the counts are read from the output.
    let args = ["test", "--workspace", "--no-fail-fast", "--color", "never"];
    let mut some = run::cargo(&run::root(), &[&args[..], which].concat());
    if std::env::var_os(THREADS).is_none() {
        let cores = thread::available_parallelism()?.get();
        some.env(THREADS, (THREADS_PER_CORE * cores).to_string());
    }
    let before = counts.failed;
    if run::watch(some, |line| counts.take(line))? {
        return Ok(());
    }
    match counts.failed.saturating_sub(before) {
        0 => bail!("the tests did not build, or one ended without a result"),
        failed => bail!("{failed} tests failed"),
    }
}

/// The names of the programs in the folders `tests` that need no feature.
fn test_programs() -> Result<Vec<String>> {
    let metadata = run::metadata(&run::root(), &["--no-deps"])?;
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let targets = packages.filter_map(|package| package["targets"].as_array());
    let programs = targets
        .flatten()
        .filter(|target| target["kind"] == serde_json::json!(["test"]))
        .filter(|target| target["required-features"].is_null());
    let mut names: Vec<String> = programs
        .filter_map(|target| target["name"].as_str().map(str::to_owned))
        .collect();
    names.sort();
    names.dedup();
    Ok(names)
}

#[derive(Default)]
struct Counts {
    passed: u64,
    failed: u64,
}

impl Counts {
    const fn add(&mut self, other: &Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }

    /// Adds the numbers of a summary: `test result: ok. 12 passed; 0 failed; …`.
    fn take(&mut self, line: &str) {
        let Some(summary) = line.trim_start().strip_prefix("test result: ") else {
            return;
        };
        let words: Vec<&str> = summary.split_whitespace().collect();
        for pair in words.windows(2) {
            if let [number, word] = pair
                && let Ok(number) = number.parse::<u64>()
            {
                match word.trim_end_matches(';') {
                    "passed" => self.passed += number,
                    "failed" => self.failed += number,
                    _ => {}
                }
            }
        }
    }
}

/// Measures the time of each step.
#[derive(Default)]
struct Clock {
    steps: Vec<(&'static str, Duration)>,
    /// Those that failed, and are to be told at the end.
    failed: Vec<&'static str>,
}

impl Clock {
    fn step(&mut self, name: &'static str, what: impl FnOnce() -> Result<()>) -> Result<()> {
        println!("\n== {name}");
        let started = Instant::now();
        let result = what();
        let took = started.elapsed();
        println!("{}", row(name, took));
        self.steps.push((name, took));
        result
    }

    /// The same where the next steps are to be run whatever comes of it.
    fn try_step(&mut self, name: &'static str, what: impl FnOnce() -> Result<()>) {
        if let Err(error) = self.step(name, what) {
            println!("error: {name}: {error:#}");
            self.failed.push(name);
        }
    }

    /// The result of all steps.
    fn end(&self) -> Result<()> {
        match self.failed.as_slice() {
            [] => Ok(()),
            failed => bail!("failed: {}", failed.join("; ")),
        }
    }

    fn report(&self) {
        println!("\n== seconds of each step");
        for (name, took) in &self.steps {
            println!("{}", row(name, *took));
        }
        let all: Duration = self.steps.iter().map(|(_, took)| *took).sum();
        println!("{}", row("in all", all));
    }
}

/// A line with a step and its time.
fn row(name: &str, took: Duration) -> String {
    format!("{:>6.1} s  {name}", took.as_secs_f64())
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
    fn summaries_add_up_and_other_lines_do_not_count() {
        let mut counts = Counts::default();
        counts.take("test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s");
        counts.take("test cycle::thread::tests::three passed ... ok");
        counts
            .take("test result: FAILED. 3 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out");
        assert_eq!((counts.passed, counts.failed), (15, 2));
    }
}
