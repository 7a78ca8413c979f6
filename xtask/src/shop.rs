//! Many machines, a broker and a database: tests and measurements in Python, with programs of other making.

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::canopen;
use crate::run;
use crate::setup::{self, Tool};

/// The broker, where Debian puts it: it is on no user's path.
pub const BROKER: Tool = Tool {
    program: "/usr/sbin/mosquitto",
    package: "mosquitto",
};
/// Reads the rules for alerts. The package brings Prometheus itself, which `contrib/shop` starts.
const RULES: Tool = Tool {
    program: "promtool",
    package: "prometheus",
};
const TESTS: [&str; 2] = ["test_history", "test_broker"];

/// Installs what these tests need.
pub fn ensure() -> Result<()> {
    setup::tools(&[BROKER, RULES])?;
    python().map(drop)
}

fn python() -> Result<std::path::PathBuf> {
    canopen::environment("python-shop", &tests().join("requirements.txt"))
}

fn tests() -> std::path::PathBuf {
    run::root().join("tests").join("shop")
}

/// Runs the tests, or those of one module. Gives the number that passed.
pub fn check(name: Option<&str>) -> Result<u64> {
    ensure()?;
    rules()?;
    let built = run::programs(&["--example", "many", "--bin", "leadscrew"])?;
    let mut unittest = command(&built, &["-m", "unittest"])?;
    match name {
        Some(name) => unittest.arg(name),
        None => unittest.args(TESTS),
    };
    let full = leadscrew_seed::full();
    unittest.env(leadscrew_seed::FULL, if full { "1" } else { "" });
    unittest.env(
        leadscrew_seed::VARIABLE,
        leadscrew_seed::fresh().to_string(),
    );
    let output = unittest.output().context("cannot start Python")?;
    let report = String::from_utf8_lossy(&output.stderr);
    let passed = canopen::count(&report);
    if !output.status.success() || passed == 0 {
        bail!(
            "many machines, broker and database:\n{report}\nto repeat it: {} cargo xtask shop",
            leadscrew_seed::settings(leadscrew_seed::fresh(), full)
        );
    }
    println!("{passed} tests with DuckDB, mosquitto and pysparkplug passed");
    Ok(passed)
}

/// The scrape of `contrib` with the rules that it names, as Prometheus reads them.
fn rules() -> Result<()> {
    let folder = run::root().join("contrib").join("prometheus");
    let check = ["check", "config", "prometheus.yml"];
    let told = run::read(run::command(&folder, RULES.program, &check))?;
    // A file of rules that is not named is not read.
    if !told.contains("leadscrew.rules.yml") {
        bail!("promtool has read no rules:\n{told}");
    }
    Ok(())
}

/// Measures: what is given goes to `measure.py`.
pub fn bench(words: &[&str]) -> Result<()> {
    ensure()?;
    let root = run::root();
    let build = ["build", "--quiet", "--release", "-p"];
    run::show(run::cargo(
        &root,
        &[&build[..], &["leadscrew-agent", "--example", "many"]].concat(),
    ))?;
    let built = root.join("target").join("release");
    run::show(command(&built, &[&["measure.py"], words].concat())?)
}

fn command(built: &Path, words: &[&str]) -> Result<std::process::Command> {
    let python = python()?;
    let words = [&["-B"], words].concat();
    let mut command = run::command(&tests(), &python.to_string_lossy(), &words);
    command
        .env("LEADSCREW", built.join("leadscrew"))
        .env("MANY", built.join("examples").join("many"))
        .env("MOSQUITTO", BROKER.program);
    Ok(command)
}
