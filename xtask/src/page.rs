//! The lathe in a browser tab: its static files in `out/page`, and the test that opens them.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::test::Counts;
use crate::{axe, run, setup, wasm};

const MODULE: &str = "leadscrew.wasm";

/// The names of tests of the panel's page that need a browser begin like this.
pub const IN_A_BROWSER: &str = "page::browser::";

/// Writes the page.
pub fn write() -> Result<()> {
    wasm::ensure()?;
    let build = ["build", "--quiet", "--locked", "--profile", "page"];
    let what = [
        "--package",
        "leadscrew-web",
        "--lib",
        "--target",
        wasm::TARGET,
    ];
    run::show(run::cargo(&run::root(), &[&build[..], &what].concat()))?;
    let module = run::root()
        .join("target")
        .join(wasm::TARGET)
        .join("page/leadscrew_web.wasm");
    let out = out();
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("cannot renew {}", out.display()))?;
    }
    fs::create_dir_all(&out)?;
    fs::copy(module, out.join(MODULE)).context("the module is not where cargo builds it")?;
    for entry in fs::read_dir(run::root().join("web").join("page"))? {
        let entry = entry?;
        fs::copy(entry.path(), out.join(entry.file_name()))?;
    }
    println!(
        "{} is written; a browser opens it from a server of files, such as: python3 -m http.server -d out/page",
        out.display()
    );
    Ok(())
}

/// Opens the page in headless Chromium, and that of `leadscrew panel`. Counts the tests.
pub fn check(counts: &mut Counts) -> Result<()> {
    setup::tools(&[setup::BROWSER])?;
    axe::ensure()?;
    write()?;
    let mut all = true;
    for which in [
        &["--test", "browser", "--", "--nocapture"][..],
        &["--test", "desk", IN_A_BROWSER],
    ] {
        all &= run::watch(browser(which), |line| counts.take(line))?;
    }
    if !all {
        bail!("tests of the page failed");
    }
    Ok(())
}

/// Runs tests of the workspace with a browser.
fn browser(which: &[&str]) -> Command {
    let test = ["test", "--quiet"];
    run::cargo(&run::root(), &[&test[..], &run::WHOLE, which].concat())
}

/// The page of `leadscrew panel` watched for ten minutes, with a path of 100 000 pieces, and left in the middle of 500
/// presses, by a browser and by its frames alone: tells the figures.
pub fn long() -> Result<()> {
    setup::tools(&[setup::BROWSER])?;
    let run = |name: &str, variable: (&str, &str)| {
        let mut run = browser(&[
            "--test",
            "desk",
            name,
            "--",
            "--nocapture",
            "--test-threads=1",
        ]);
        run.env(variable.0, variable.1);
        run::show(run)
    };
    for name in ["page::browser::long::", "page::browser::gone::"] {
        run(name, ("LEADSCREW_PAGE_SECONDS", "600"))?;
    }
    run(
        "page::jog::a_page_that_vanishes",
        (leadscrew_seed::FULL, "1"),
    )
}

/// Where it is written.
pub fn out() -> PathBuf {
    run::root().join("out").join("page")
}
