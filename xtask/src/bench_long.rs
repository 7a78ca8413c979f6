//! A program of a hundred megabytes through a board with 2 KiB for it, in virtual time: four ways give one hash.

use anyhow::Result;

use crate::bench::tell;
use crate::run;

/// The part of `docs/performance.md` between these lines is renewed.
const MARKS: (&str, &str) = (
    "<!-- measured long: begin -->",
    "<!-- measured long: end -->",
);

/// The length of the program in bytes.
const BYTES: &str = "100000000";

/// Measures. Prints the result or, with `write`, puts it into the document.
pub fn bench(write: bool) -> Result<()> {
    let root = run::root();
    let build = ["build", "--quiet", "--release", "-p"];
    run::show(run::cargo(&root, &[&build[..], &["leadscrew"]].concat()))?;
    let example = ["leadscrew-tests", "--example", "long_program"];
    run::show(run::cargo(&root, &[&build[..], &example].concat()))?;
    let release = root.join("target").join("release");
    let program = release.join("examples").join("long_program");
    let leadscrew = release.join("leadscrew");
    let folder = run::scratch("bench")?;
    let text = run::read(run::command(
        &root,
        &program.to_string_lossy(),
        &[
            BYTES,
            &leadscrew.to_string_lossy(),
            &folder.to_string_lossy(),
        ],
    ))?;
    tell(&text, MARKS, write)
}
