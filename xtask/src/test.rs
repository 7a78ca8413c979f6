//! All checks that a change must pass, in the order that finds most mistakes soonest. `--full` adds the long volumes.

mod clock;
mod counts;
mod programs;

use std::path::Path;

use anyhow::{Result, bail};

use self::clock::Clock;
pub use self::counts::Counts;

use crate::{
    audit, bits, canopen, chip, docs, emulated, emulator, image, licences, manual, packages, page,
    renew, rules, run, setup, shop, sizes, target, vcan as bus,
};

/// Printed after a test that was not a full one.
const NOT_RUN: &str = "\
not run here, but by `cargo xtask test --full`, which is what .ci/run starts:
  the long volumes: 150 000 moves, cuts of power in writes of the flash, six million ticks of soak
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
    clock.try_step("tests with overflow checks", || programs::run(&mut counts));
    clock.try_step("another CANopen master", || {
        counts.passed += canopen::check()?;
        Ok(())
    });
    clock.try_step("no panic is reachable", audit::audit);
    if full {
        clock.try_step("core for the microcontroller", core_alone);
        clock.rows(
            "tests on a CAN bus and in a browser, and beside them what the microcontroller computes",
            |row| {
                row.try_beside("tests on a CAN bus", || on_a_bus(&mut counts, ""));
                row.try_beside("the page in a browser", || page::check(&mut counts));
            },
            |row| {
                row.try_beside("instructions per tick", || emulator::ticks(false));
                row.try_beside("the same bits on the microcontroller", || bits::bits(false));
            },
        );
        clock.try_step("images of the boards", || sizes::sizes(false));
        let mut of_chip = 0;
        clock.rows(
            "the emulated board, and beside it the image against a model of its chip",
            |row| {
                row.try_beside("the emulated board on a bus", || {
                    on_the_board(&mut counts, "")
                });
                row.try_beside("agents, broker and database", || {
                    counts.passed += shop::check(None)?;
                    Ok(())
                });
                row.try_beside("the manual", manual::check);
            },
            |row| {
                row.try_beside("the image against a model of its chip", || {
                    of_chip = chip::check("", false)?;
                    Ok(())
                });
            },
        );
        counts.passed += of_chip;
    } else {
        clock.try_step("the image that is flashed", image::image);
    }

    clock.report();
    if !full {
        println!("\n{NOT_RUN}\n");
    }
    // A step without a count is one that failed.
    counts.failed = counts.failed.max(clock.failures() as u64);
    println!("{counts}");
    clock.end()
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
    let whole = [&run::WHOLE[..], &["--all-targets"]].concat();
    check(&run::root(), &whole)?;
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
    alone(|counts| on_a_bus(counts, filter))
}

/// Runs only the tests of both pages in a browser.
pub fn page() -> Result<()> {
    alone(page::check)
}

/// Runs only the tests of the emulated board.
pub fn emulated(filter: &str) -> Result<()> {
    setup::tools(&[setup::EMULATOR])?;
    target::ensure()?;
    alone(|counts| on_the_board(counts, filter))
}

/// Runs these tests and prints their numbers.
fn alone(tests: impl FnOnce(&mut Counts) -> Result<()>) -> Result<()> {
    let mut counts = Counts::default();
    tests(&mut counts)?;
    println!("{counts}");
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
