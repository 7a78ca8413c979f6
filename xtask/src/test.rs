//! Everything a change must pass, in the order that finds most mistakes soonest.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};

use crate::{
    audit, bits, canopen, chip, docs, emulated, emulator, licences, rules, run, setup, sizes,
    target, vcan as bus,
};

/// The whole test, as the README names it.
pub fn test() -> Result<()> {
    let mut counts = Counts::default();
    let mut clock = Clock::default();
    let root = run::root();
    let firmware = run::firmware();

    let (seed, source) = leadscrew_seed::of_run();
    println!("random tests: their fixed cases, and those of seed {seed}, {source}");
    println!(
        "the same again: {}={seed} cargo xtask test",
        leadscrew_seed::VARIABLE
    );

    clock.step("set-up", setup::everything)?;
    clock.step("format", || {
        run::show(run::cargo(&root, &["fmt", "--all", "--check"]))?;
        run::show(run::cargo(&firmware, &["fmt", "--all", "--check"]))
    })?;
    clock.step("house rules", rules::check)?;
    clock.step("licences", licences::check)?;
    clock.step("clippy", || {
        run::show(run::cargo(
            &root,
            &[
                "clippy",
                "--workspace",
                "--all-targets",
                "--features",
                "leadscrew-tests/vcan,leadscrew-tests/emulated",
                "--quiet",
                "--",
                "-D",
                "warnings",
            ],
        ))?;
        run::show(run::cargo(
            &firmware,
            &[
                "clippy",
                "--release",
                "--workspace",
                "--quiet",
                "--",
                "-D",
                "warnings",
            ],
        ))?;
        run::show(run::cargo(
            &firmware,
            &[
                "clippy",
                "--release",
                "--package",
                "nucleo-g474re",
                "--package",
                "mps2-an386",
                "--features",
                "defmt,mps2-an386/provoke",
                "--quiet",
                "--",
                "-D",
                "warnings",
            ],
        ))
    })?;
    clock.step("tests with overflow checks", || tests(&mut counts, &[]))?;
    clock.step("tests on a CAN bus", || on_a_bus(&mut counts, &[], ""))?;
    clock.step("another CANopen master", || {
        counts.passed += canopen::check()?;
        Ok(())
    })?;
    clock.step("core for the microcontroller", || {
        run::show(run::cargo(
            &root,
            &[
                "build",
                "--quiet",
                "--release",
                "-p",
                "leadscrew-core",
                "--target",
                target::TARGET,
            ],
        ))
    })?;
    clock.step("no panic is reachable", audit::audit)?;
    clock.step("instructions per tick", || emulator::ticks(false))?;
    clock.step("the same bits on the microcontroller", || bits::bits(false))?;
    clock.step("the emulated board on a bus", || {
        on_the_board(&mut counts, "")
    })?;
    clock.step("images of the boards", || sizes::sizes(false))?;
    clock.step("the image against a model of its chip", || {
        counts.passed += chip::check("", false)?;
        Ok(())
    })?;
    clock.step("documentation", docs::check)?;
    clock.step("tests in release, full volume", || {
        tests(&mut counts, &["--release"])
    })?;

    clock.report();
    println!("{} passed, {} failed", counts.passed, counts.failed);
    Ok(())
}

/// The tests on a CAN bus alone.
pub fn vcan(filter: &str) -> Result<()> {
    let mut counts = Counts::default();
    on_a_bus(&mut counts, &[], filter)?;
    println!("{} passed, {} failed", counts.passed, counts.failed);
    Ok(())
}

/// The tests of the emulated board alone.
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

fn on_a_bus(counts: &mut Counts, profile: &[&str], filter: &str) -> Result<()> {
    let before = (counts.passed, counts.failed);
    let ok = bus::tests(profile, filter, |line| counts.take(line))?;
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

/// The test with the settings of a build server.
pub fn ci() -> Result<()> {
    for dir in [run::root(), run::firmware()] {
        run::read(run::cargo(
            &dir,
            &["metadata", "--locked", "--format-version", "1"],
        ))?;
    }
    let mut again = run::cargo(&run::root(), &["xtask", "test"]);
    again
        .env("CARGO_INCREMENTAL", "0")
        .env("CARGO_TERM_COLOR", "never");
    run::show(again)
}

/// All tests of the workspace, documentation examples included, counted.
fn tests(counts: &mut Counts, profile: &[&str]) -> Result<()> {
    // Never coloured: the counts are read from what is printed.
    let mut args = vec!["test", "--workspace", "--no-fail-fast", "--color", "never"];
    args.extend_from_slice(profile);
    let before = counts.failed;
    let ok = run::watch(run::cargo(&run::root(), &args), |line| counts.take(line))?;
    if !ok {
        println!("{} passed, {} failed", counts.passed, counts.failed);
        match counts.failed.saturating_sub(before) {
            0 => bail!("the tests did not build, or one ended without a result"),
            failed => bail!("{failed} tests failed"),
        }
    }
    Ok(())
}

#[derive(Default)]
struct Counts {
    passed: u64,
    failed: u64,
}

impl Counts {
    /// Adds up the summaries: `test result: ok. 12 passed; 0 failed; …`.
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

/// Times the steps.
#[derive(Default)]
struct Clock {
    steps: Vec<(&'static str, Duration)>,
}

impl Clock {
    fn step(&mut self, name: &'static str, what: impl FnOnce() -> Result<()>) -> Result<()> {
        println!("\n== {name}");
        let started = Instant::now();
        let result = what();
        self.steps.push((name, started.elapsed()));
        result
    }

    fn report(&self) {
        println!();
        for (name, took) in &self.steps {
            println!("{:>6.1} s  {name}", took.as_secs_f64());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
