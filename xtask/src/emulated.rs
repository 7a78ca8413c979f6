//! The board on the emulated Cortex-M4F, driven by `leadscrew` over its serial line.

use anyhow::Result;

use crate::{emulator, run};

/// Where the tests find the image.
const IMAGE: &str = "LEADSCREW_IMAGE";

/// Builds the image, in which failures can be provoked, and the tests and runs them; each line that is printed is handed to `seen`. True where they passed.
pub fn tests(filter: &str, seen: impl FnMut(&str)) -> Result<bool> {
    let root = run::root();
    let image = emulator::build("mps2-an386", "mps2-bus", &["--features", "provoke"])?;
    run::show(run::cargo(
        &root,
        &["build", "--quiet", "--package", "leadscrew"],
    ))?;
    let mut tests = run::cargo(
        &root,
        &[
            "test",
            "--quiet",
            "--package",
            "leadscrew-tests",
            "--test",
            "emulated",
            "--features",
            "emulated",
            "--",
            "--color=never",
            filter,
        ],
    );
    tests.env(IMAGE, image);
    run::watch(tests, seen)
}
