//! The flashed image of the NUCLEO-G474RE on a model of its chip: Unicorn runs the instructions, and the registers are
//! in `tests/python/chip`.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};

use crate::{canopen, run, target};

/// The flashed image.
const IMAGE: &str = "nucleo-g474re";

/// Runs the tests whose names contain `filter`; with `all` in full volume. Gives the number that passed.
pub fn check(filter: &str, all: bool) -> Result<u64> {
    let python = canopen::environment("python-chip", &tests().join("requirements.txt"))?;
    let root = run::root();
    let image = image()?;
    let built = run::programs(&["--example", "chip_plant", "--bin", "leadscrew"])?;
    let pattern = format!("*{filter}*");
    let mut args = vec!["-B", "-m", "unittest"];
    if !filter.is_empty() {
        args.extend(["-k", &pattern]);
    }
    let (seed, _) = leadscrew_seed::of_run();
    let mut unittest = run::command(&tests(), &python.to_string_lossy(), &args);
    unittest
        .env("CHIP_IMAGE", image)
        .env("CHIP_PLANT", built.join("examples").join("chip_plant"))
        .env("LEADSCREW", built.join("leadscrew"))
        .env("CHIP_EXAMPLES", root.join("examples"))
        .env("CHIP_SEED", seed.to_string())
        .env_remove("CHIP_ALL");
    if all {
        unittest.env("CHIP_ALL", "1");
    }
    let output = unittest.output().context("cannot start Python")?;
    let report = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let again = leadscrew_seed::settings(seed, false);
        let whole = if all { " --all" } else { "" };
        bail!(
            "the image on the model of its chip ({again} cargo xtask chip{whole} {filter}):\n{report}"
        );
    }
    let passed = canopen::count(&report);
    if passed == 0 {
        bail!("Python found no tests in {}:\n{report}", tests().display());
    }
    // The cases that a volume has tried, line by line.
    print!("{}", String::from_utf8_lossy(&output.stdout));
    println!("{passed} tests of the image against a model of its chip passed");
    Ok(passed)
}

/// The command `cargo xtask chip`.
pub fn command(args: &[&str]) -> Result<()> {
    let (all, names): (Vec<&str>, Vec<&str>) =
        args.iter().copied().partition(|arg| *arg == "--all");
    if names.len() > 1 {
        bail!("cargo xtask chip [NAME] [--all]");
    }
    target::ensure()?;
    check(names.first().unwrap_or(&""), !all.is_empty()).map(drop)
}

/// Builds the flashed image; gives its path.
fn image() -> Result<PathBuf> {
    let built = target::build(IMAGE, IMAGE, &[])?;
    // Another step may build another image in the same place.
    let image = run::scratch("chip")?.join(IMAGE);
    std::fs::copy(&built, &image).with_context(|| format!("there is no {}", built.display()))?;
    Ok(image)
}

fn tests() -> PathBuf {
    run::root().join("tests").join("python").join("chip")
}
