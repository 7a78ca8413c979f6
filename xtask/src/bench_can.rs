//! What receiving and recording a bus costs: system calls a frame, counted where the bus is, and user instructions a frame,
//! counted on this machine over a socket that any kernel has. Beside them `candump`, which does the same.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::bench::{instructions, tell, tenths};
use crate::{run, setup, vcan};

/// The part of `docs/performance.md` that is renewed stands between these lines.
const MARKS: (&str, &str) = ("<!-- measured bus: begin -->", "<!-- measured bus: end -->");

/// Frames in the big run.
const MANY: u64 = 500_000;
/// Frames that come one by one.
const SINGLE: u64 = 3_000;
/// Frames for `candump`: every one costs it several calls, and each call is slow while it is counted.
const FEW: u64 = 20_000;

/// Measures and prints, or (`write`) puts it into the document.
pub fn bench(write: bool) -> Result<()> {
    setup::tools(&[setup::VALGRIND])?;
    setup::tools(setup::CAN)?;
    let root = run::root();
    let build = ["build", "--quiet", "--release", "-p"];
    run::show(run::cargo(
        &root,
        &[&build[..], &["leadscrew-can", "--examples"]].concat(),
    ))?;
    run::show(run::cargo(&root, &[&build[..], &["leadscrew"]].concat()))?;
    let mut text = format!(
        "{}, profile `release`, bus {}.\n\n| | frames | system calls a frame | user instructions a frame | lost |\n\
         |---|---:|---:|---:|---:|\n",
        run::read(run::command(&root, "rustc", &["--version"]))?.trim(),
        vcan::place().name()
    );
    let each = instructions_each()?;
    let counted = calls()?;
    for (name, frames, calls, lost) in counted {
        let user = if name.starts_with("record, bursts") {
            each.to_string()
        } else {
            "–".into()
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {name} | {frames} | {} | {user} | {lost} |",
            thousandths(calls, frames)
        );
    }
    tell(&text, MARKS, write)
}

/// Receiving a frame and writing its line, from the difference of two runs.
fn instructions_each() -> Result<String> {
    let program = run::root()
        .join("target")
        .join("release")
        .join("examples")
        .join("receive");
    let log = run::scratch("bench")?.join("received.log");
    let log = log.to_string_lossy().into_owned();
    let few = instructions(&program, &["50000", &log])?;
    let many = instructions(&program, &["150000", &log])?;
    Ok(tenths(many.saturating_sub(few), 100_000))
}

/// What was counted of a program: its name, frames, system calls, and frames lost.
type Counted = (&'static str, u64, u64, String);

fn calls() -> Result<Vec<Counted>> {
    let dir = run::scratch("vcan")?;
    let dir = dir.to_string_lossy();
    let bus = vcan::INTERFACE;
    // Each recorder is counted while the other process sends; it has half a second to begin to listen.
    let script = format!(
        "set -e\n\
         r=target/release/leadscrew; s=target/release/examples/burst\n\
         count() {{ name=$1; frames=$2; shift 2; strace -f -c -o {dir}/$name.calls \"$@\" > {dir}/$name.out 2> {dir}/$name.err & p=$!; sleep 2; }}\n\
         count bursts {MANY} $r record --bus {bus} --json -o {dir}/bursts.log --count {MANY}\n\
         $s {bus} {MANY} 2000; wait $p\n\
         count single {SINGLE} $r record --bus {bus} --json -o {dir}/single.log --count {SINGLE}\n\
         $s {bus} {SINGLE} 1 4000; wait $p\n\
         count candump {FEW} candump -L -r 100000000 -n {FEW} {bus}\n\
         $s {bus} {FEW} 500 100000; wait $p\n\
         wc -l {dir}/bursts.log {dir}/candump.out\n\
         echo counted\n"
    );
    let mut done = false;
    let ok = vcan::run("bench", &script, |line| done |= line.trim() == "counted")?;
    if !ok || !done {
        bail!("the recorders were not counted; what they said is in {dir}");
    }
    let read = |name: &str, ending: &str| -> Result<String> {
        let path = Path::new(&*dir).join(format!("{name}.{ending}"));
        fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
    };
    let dropped = |name: &str| -> Result<String> {
        let told: serde_json::Value = serde_json::from_str(read(name, "out")?.trim())?;
        Ok(told["dropped"].to_string())
    };
    Ok(vec![
        (
            "record, bursts of 2000",
            MANY,
            total(&read("bursts", "calls")?)?,
            dropped("bursts")?,
        ),
        (
            "record, one by one",
            SINGLE,
            total(&read("single", "calls")?)?,
            dropped("single")?,
        ),
        (
            "candump -L, bursts of 500",
            FEW,
            total(&read("candump", "calls")?)?,
            "–".into(),
        ),
    ])
}

/// The sum at the end of what `strace -c` prints.
fn total(table: &str) -> Result<u64> {
    let line = table
        .lines()
        .find(|line| line.trim_end().ends_with(" total"))
        .with_context(|| format!("strace counted nothing:\n{table}"))?;
    // Share of time, seconds, microseconds a call, calls, perhaps errors.
    line.split_whitespace()
        .nth(3)
        .and_then(|word| word.parse().ok())
        .with_context(|| format!("no number of calls in: {line}"))
}

/// The quotient with three decimals.
fn thousandths(sum: u64, count: u64) -> String {
    let thousandths = sum.saturating_mul(1000).checked_div(count).unwrap_or(0);
    format!("{}.{:03}", thousandths / 1000, thousandths % 1000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_calls_is_found() {
        let table = "% time     seconds  usecs/call     calls    errors syscall\n\
                     ------ ----------- ----------- --------- --------- ----------------\n\
                     \x20 0.00    0.000000           0      1234           recvmmsg\n\
                     100.00    0.010000           2      5678         9 total\n";
        assert_eq!(total(table).unwrap(), 5678);
        let without = table.replace("        9 total", "          total");
        assert_eq!(total(&without).unwrap(), 5678);
        assert!(total("nothing").is_err());
        assert_eq!(thousandths(5, 2000), "0.002");
        assert_eq!(thousandths(60_040, 20_000), "3.002");
    }
}
