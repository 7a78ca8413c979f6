//! The setpoints of whole programs on the emulated Cortex-M4F, as hashes compared with the table under version control.
//! A test of the workspace (`tests/tests/target.rs`) compares the host's hashes with the same table. Programs from the
//! seed of the commit are in no table: this module runs them on the board and on the host, one after the other.

use anyhow::{Context, Result, bail};

use crate::{emulator, run};

/// The number of random programs from the seed of the commit.
const FRESH: &str = "40";

/// Runs the programs. Compares with the table or, with `write`, renews it.
pub fn bits(write: bool) -> Result<()> {
    print!("{}", emulator::emulate("audit", "copies", &[])?);
    let printed = emulator::emulate("mps2-an386", "mps2-an386", &[])?;
    let table = format!(
        "# Setpoints on the emulated Cortex-M4F: program, CRC-64/XZ, ticks in state run, alarm (0: none).\n{printed}"
    );
    let path = run::firmware().join("mps2-an386").join("hashes.txt");
    if write {
        std::fs::write(&path, &table)?;
        println!("written to {}", path.display());
        return Ok(());
    }
    let golden = std::fs::read_to_string(&path).context("there is no table to compare with")?;
    let wrong = differences("table", &golden, &table);
    if wrong.is_empty() {
        println!(
            "{} programs, bit by bit as in the table",
            table.lines().count() - 1
        );
        return fresh();
    }
    bail!(
        "{}\nwhere setpoints are meant to change, renew firmware/mps2-an386/hashes.txt with `cargo xtask bits --write`",
        wrong.join("\n")
    );
}

/// Runs programs that are in no table, on the board and on this host.
fn fresh() -> Result<()> {
    let (seed, source) = leadscrew_seed::of_run();
    let words = [format!("seed={seed}"), format!("count={FRESH}")];
    let words = [words[0].as_str(), words[1].as_str()];
    let board = emulator::emulate_with("mps2-an386", "mps2-an386", &[], &words)?;
    let program = run::programs(&["--example", "bits"])?.join("examples/bits");
    let first = seed.to_string();
    let args = [first.as_str(), FRESH];
    let here = run::read(run::command(
        &run::root(),
        &program.to_string_lossy(),
        &args,
    ))?;
    let wrong = differences("host", &here, &board);
    if !wrong.is_empty() {
        bail!(
            "{}\nto repeat it: {}={seed} cargo xtask bits",
            wrong.join("\n"),
            leadscrew_seed::VARIABLE
        );
    }
    println!(
        "{} programs of seed {seed}, {source}: bit by bit as on this host",
        board.lines().count()
    );
    Ok(())
}

/// The first rows that differ, and the number of further ones.
fn differences(of: &str, golden: &str, now: &str) -> Vec<String> {
    const SHOWN: usize = 10;
    let mut wrong: Vec<String> = golden
        .lines()
        .zip(now.lines())
        .filter(|(old, new)| old != new)
        .map(|(old, new)| format!("{of}: {old}\nboard: {new}"))
        .collect();
    let (old, new) = (golden.lines().count(), now.lines().count());
    if old != new {
        wrong.push(format!("{of}: {old} lines, the board printed {new}"));
    }
    let more = wrong.len().saturating_sub(SHOWN);
    wrong.truncate(SHOWN);
    if more > 0 {
        wrong.push(format!("and {more} more"));
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_differ_or_are_missing_are_told() {
        let differences = |golden: &str, now: &str| differences("table", golden, now);
        assert!(differences("a\nb\n", "a\nb\n").is_empty());
        assert_eq!(differences("a\nb\n", "a\nc\n"), ["table: b\nboard: c"]);
        assert_eq!(differences("a\nb\n", "a\n").len(), 1);
        let many = "x\n".repeat(30);
        assert_eq!(differences(&many, &"y\n".repeat(30)).len(), 11);
    }
}
