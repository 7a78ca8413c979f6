//! The cost of receiving and recording a bus: system calls and user instructions for each frame, counted in the place
//! of the bus. For comparison: `candump`, which does the same work.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::bench::{collected, tell, tenths};
use crate::{run, setup, vcan};

/// The part of `docs/performance.md` between these lines is renewed.
const MARKS: (&str, &str) = ("<!-- measured bus: begin -->", "<!-- measured bus: end -->");

/// Frames of the large run.
const MANY: u64 = 500_000;
/// Frames that arrive one by one.
const SINGLE: u64 = 3_000;
/// Frames for `candump`: each costs it several calls, and each call is slow while it is counted.
const FEW: u64 = 20_000;
/// The instructions are the difference of these two runs, so that they exclude the start of the program.
const USER: [u64; 2] = [5_000, 25_000];

/// Measures. Prints the result or, with `write`, puts it into the document.
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
    for counted in count()? {
        let Counted {
            name,
            frames,
            calls,
            user,
            lost,
        } = counted;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {name} | {frames} | {} | {user} | {lost} |",
            thousandths(calls, frames)
        );
    }
    tell(&text, MARKS, write)
}

/// The counts of a program.
struct Counted {
    name: &'static str,
    frames: u64,
    /// System calls.
    calls: u64,
    /// User instructions a frame.
    user: String,
    lost: String,
}

fn count() -> Result<Vec<Counted>> {
    let dir = run::scratch("vcan")?;
    let dir = dir.to_string_lossy();
    let bus = vcan::INTERFACE;
    let [less, more] = USER;
    // Each recorder is counted while the other process sends; that one begins when the recorder listens.
    let script = format!(
        "set -e\n\
         r=target/release/leadscrew; s=target/release/examples/burst\n\
         start() {{ name=$1; shift; \"$@\" > {dir}/$name.out 2> {dir}/$name.err & p=$!\n\
         until grep -q '^ *{bus} ' /proc/net/can/rcvlist_all; do kill -0 $p; sleep 0.1; done; }}\n\
         strace='strace -f -c -o'; grind='valgrind --tool=callgrind --callgrind-out-file=/dev/null'\n\
         start bursts $strace {dir}/bursts.calls $r record --bus {bus} --json -o {dir}/bursts.log --count {MANY}\n\
         $s {bus} {MANY} 2000; wait $p\n\
         start single $strace {dir}/single.calls $r record --bus {bus} --json -o {dir}/single.log --count {SINGLE}\n\
         $s {bus} {SINGLE} 1 4000; wait $p\n\
         start candump $strace {dir}/candump.calls candump -L -r 100000000 -n {FEW} {bus}\n\
         $s {bus} {FEW} 500 100000; wait $p\n\
         for n in {less} {more}; do\n\
         start record.$n $grind --log-file={dir}/record.$n.user $r record --bus {bus} -o {dir}/record.log --count $n\n\
         $s {bus} $n 2000; wait $p\n\
         start candump.$n $grind --log-file={dir}/candump.$n.user candump -L -r 100000000 -n $n {bus}\n\
         $s {bus} $n 2000; wait $p\n\
         done\n\
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
    let user = |name: &str| -> Result<String> {
        let run = |frames| collected(&read(&format!("{name}.{frames}"), "user")?);
        Ok(tenths(
            run(more)?.saturating_sub(run(less)?),
            more.saturating_sub(less),
        ))
    };
    Ok(vec![
        Counted {
            name: "record, bursts of 2000",
            frames: MANY,
            calls: total(&read("bursts", "calls")?)?,
            user: user("record")?,
            lost: dropped("bursts")?,
        },
        Counted {
            name: "record, one by one",
            frames: SINGLE,
            calls: total(&read("single", "calls")?)?,
            user: "–".into(),
            lost: dropped("single")?,
        },
        Counted {
            name: "candump -L, bursts of 500",
            frames: FEW,
            calls: total(&read("candump", "calls")?)?,
            user: user("candump")?,
            lost: "–".into(),
        },
    ])
}

/// The sum at the end of `strace -c`'s output.
fn total(table: &str) -> Result<u64> {
    let line = table
        .lines()
        .find(|line| line.trim_end().ends_with(" total"))
        .with_context(|| format!("strace counted nothing:\n{table}"))?;
    // The columns: share of time, seconds, microseconds a call, calls, perhaps errors.
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
