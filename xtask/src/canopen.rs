//! The board's CANopen services against an independent master: the Python package `canopen`, in a virtual environment
//! below the build folder.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::run;
use crate::setup::{self, Tool};

/// This package brings `venv` on Debian, where a bare Python has none.
const PYTHON: Tool = Tool {
    program: "python3",
    package: "python3-venv",
};

/// The interpreter with the pinned packages; installs them where they are missing or have other versions.
pub fn python() -> Result<PathBuf> {
    environment("python", &tests().join("requirements.txt"))
}

/// The interpreter of the virtual environment with this name below the build folder. It has the packages of the list.
pub fn environment(name: &str, wanted: &Path) -> Result<PathBuf> {
    let dir = run::root().join("target").join(name);
    let python = dir.join("bin").join("python");
    let list =
        fs::read_to_string(wanted).with_context(|| format!("cannot read {}", wanted.display()))?;
    let installed = dir.join("installed.txt");
    if python.is_file() && fs::read_to_string(&installed).is_ok_and(|have| have == list) {
        return Ok(python);
    }
    setup::tools(&[PYTHON])?;
    println!("installing the Python packages of {name} below target/");
    let make = || {
        let dir = dir.to_string_lossy();
        let args = ["-m", "venv", "--clear", &dir];
        run::read(run::command(&run::root(), "python3", &args))
    };
    if make().is_err() {
        // There is a Python without `venv`.
        setup::install(&[PYTHON.package])?;
        make()?;
    }
    let wanted = wanted.to_string_lossy();
    let args = [
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--requirement",
        &wanted,
    ];
    run::read(run::command(&run::root(), &python.to_string_lossy(), &args))
        .context("the Python packages did not install; see that the package index is reachable")?;
    fs::write(&installed, list).with_context(|| format!("cannot write {}", installed.display()))?;
    Ok(python)
}

/// The number of tests that a run of Python's `unittest` reports: `Ran 7 tests in 3.142s`; 0 where it reports none.
pub fn count(report: &str) -> u64 {
    let ran = |line: &str| line.strip_prefix("Ran ")?.split(' ').next()?.parse().ok();
    report.lines().find_map(ran).unwrap_or(0)
}

/// Writes the data sheet that this program prints. Gives the file's path.
pub fn sheet(leadscrew: &Path) -> Result<PathBuf> {
    let args = ["params", "docs", "--eds"];
    let sheet = run::read(run::command(
        &run::root(),
        &leadscrew.to_string_lossy(),
        &args,
    ))?;
    let eds = run::scratch("canopen")?.join("leadscrew.eds");
    fs::write(&eds, sheet).with_context(|| format!("cannot write {}", eds.display()))?;
    Ok(eds)
}

/// Runs the tests. Gives the number that passed.
pub fn check() -> Result<u64> {
    let python = python()?;
    let built = run::programs(&["--example", "canopen_node", "--bin", "leadscrew"])?;
    let node = built.join("examples").join("canopen_node");
    let leadscrew = built.join("leadscrew");
    let eds = sheet(&leadscrew)?;
    let mut unittest = run::command(
        &tests(),
        &python.to_string_lossy(),
        &["-B", "-m", "unittest"],
    );
    unittest
        .env("CANOPEN_NODE", node)
        .env("CANOPEN_EDS", eds)
        .env(
            leadscrew_seed::VARIABLE,
            leadscrew_seed::fresh().to_string(),
        );
    let output = unittest.output().context("cannot start Python")?;
    // It reports on standard error: `Ran 7 tests in 3.142s`, then `OK`.
    let report = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!(
            "the Python package canopen finds fault:\n{report}\nto repeat it: {}={} cargo xtask canopen",
            leadscrew_seed::VARIABLE,
            leadscrew_seed::fresh()
        );
    }
    let passed = count(&report);
    if passed == 0 {
        bail!("Python found no tests in {}:\n{report}", tests().display());
    }
    println!(
        "{passed} tests of the Python package canopen against the board's services and data sheet passed"
    );
    Ok(passed)
}

fn tests() -> PathBuf {
    run::root().join("tests").join("python")
}
