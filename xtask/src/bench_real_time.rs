//! Tests whether a board in real time keeps a SYNC of 1 kHz on this host, measured at the other end of its bus.

use std::fs;

use anyhow::Result;

use crate::bench::tell;
use crate::run;

/// The part of `docs/performance.md` between these lines is renewed.
const MARKS: (&str, &str) = (
    "<!-- measured beat: begin -->",
    "<!-- measured beat: end -->",
);

/// Measures. Prints the result or, with `write`, puts it into the document.
pub fn bench(write: bool) -> Result<()> {
    let root = run::root();
    let build = ["build", "--quiet", "--release", "-p"];
    let board = ["leadscrew-board-sim-host"];
    run::show(run::cargo(&root, &[&build[..], &board].concat()))?;
    let example = ["leadscrew-tests", "--example", "real_time"];
    run::show(run::cargo(&root, &[&build[..], &example].concat()))?;
    let release = root.join("target").join("release");
    let program = release.join("examples").join("real_time");
    let (program, board) = (program.to_string_lossy(), release.join("board-sim"));
    let args = [&*board.to_string_lossy(), "examples/g84-peck.nc"];
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().unwrap_or("unknown");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let ordinary = run::read(run::command(&root, &program, &args))?;
    // Where this scheduling is not permitted, the command reports it.
    let first = [&["-f", "40", &*program], &args[..]].concat();
    let before_others = run::read(run::command(&root, "chrt", &first))?;
    let text = format!(
        "{cores} cores, load average {load} when it began.\n\nBoth processes scheduled as any other \
         (`SCHED_OTHER`): {ordinary}\nBoth processes before all others (`chrt -f 40`): {before_others}"
    );
    tell(&text, MARKS, write)
}
