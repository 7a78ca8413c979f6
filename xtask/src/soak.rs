//! A machine at work for hours of its own time, under an operator who presses anything.

use anyhow::{Result, bail};

use crate::run;

/// The volume that `docs/reliability.md` tells of.
const TICKS: u64 = 10_000_000;

/// `cargo xtask soak [--ticks N] [--seed S]`.
pub fn soak(arguments: &[&str]) -> Result<()> {
    let (mut seed, mut ticks) = (1, TICKS);
    let mut rest = arguments.iter();
    while let Some(name) = rest.next() {
        let value = rest.next().and_then(|value| value.parse().ok());
        match (*name, value) {
            ("--seed", Some(value)) => seed = value,
            ("--ticks", Some(value)) => ticks = value,
            _ => bail!("usage: cargo xtask soak [--ticks N] [--seed S], whole numbers"),
        }
    }
    let mut command = run::cargo(
        &run::root(),
        &[
            "run",
            "--quiet",
            "--release",
            "-p",
            "leadscrew-tests",
            "--example",
            "soak",
            "--",
        ],
    );
    command.arg(seed.to_string()).arg(ticks.to_string());
    run::show(command)
}
