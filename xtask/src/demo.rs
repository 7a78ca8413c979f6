//! The main task in one command: checks a real program, runs it on the simulated machine and draws it.

use anyhow::Result;

use crate::run;

const PROGRAM: &str = "examples/shaft.nc";
const PICTURE: &str = "out/shaft.svg";
/// A spindle with the ripple of a real one.
const RIPPLE: &str = "--spindle-ripple=10@5";

/// Checks, runs and draws the example.
pub fn demo() -> Result<()> {
    std::fs::create_dir_all(run::root().join("out"))?;
    for args in [
        &["check", PROGRAM][..],
        &["run", PROGRAM, RIPPLE],
        &["plot", PROGRAM, RIPPLE, "-o", PICTURE],
    ] {
        println!("\n$ leadscrew {}", args.join(" "));
        let mut all = vec![
            "run",
            "--quiet",
            "--release",
            "--package",
            "leadscrew",
            "--",
        ];
        all.extend_from_slice(args);
        run::show(run::cargo(&run::root(), &all))?;
    }
    println!("\nthe picture is {PICTURE}");
    Ok(())
}
