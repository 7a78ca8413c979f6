//! The link test: an image whose panic handler is an undefined function links only if no panic is reachable.

use std::path::Path;
use std::process::Stdio;

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, SectionFlags};

use crate::{callgraph, run, target};

/// The undefined function that the panic handler of the image calls.
const UNDEFINED: &str = "a_panic_is_reachable";

/// Links the image as it would be flashed. Then links it with a panic in it, to show that the test can fail.
pub fn audit() -> Result<()> {
    match link(None)? {
        Outcome::Linked => println!("no panic is reachable ({})", size()?),
        Outcome::PanicReachable => {
            println!("a panic is reachable");
            link(Some("diagnose"))?;
            let ways = callgraph::ways_to_panic(&target::built("link"))?;
            bail!("what runs on a board can panic:\n{}", ways.join("\n"));
        }
    }
    match link(Some("self-test"))? {
        Outcome::PanicReachable => {}
        Outcome::Linked => {
            bail!("the image links with a reachable panic in it: the test proves nothing")
        }
    }
    link(Some("self-test,diagnose"))?;
    let ways = callgraph::ways_to_panic(&target::built("link"))?;
    match ways.as_slice() {
        [way] if way.contains("reachable_panic") => {
            println!("self-test: a panic put in on purpose is found:\n{way}");
            Ok(())
        }
        other => {
            bail!("the image holds one panic, put in on purpose, and the report says: {other:?}")
        }
    }
}

enum Outcome {
    Linked,
    PanicReachable,
}

/// Flash and RAM, in bytes, of the image with everything of the core that a board needs and nothing else. It has no
/// hardware code and no stacks.
pub fn of_board() -> Result<(u64, u64)> {
    bytes(&target::build("audit", "board", &[])?)
}

fn link(feature: Option<&str>) -> Result<Outcome> {
    let mut args = vec![
        "build",
        "--quiet",
        "--release",
        "--package",
        "audit",
        "--bin",
        "link",
    ];
    if let Some(feature) = feature {
        args.extend(["--features", feature]);
    }
    let mut build = run::cargo(&run::firmware(), &args);
    build.stdin(Stdio::null()).env("CARGO_TERM_COLOR", "never");
    let output = build.output().context("cannot start cargo")?;
    if output.status.success() {
        return Ok(Outcome::Linked);
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    if errors.contains(&format!("undefined symbol: {UNDEFINED}")) {
        return Ok(Outcome::PanicReachable);
    }
    bail!("the link image does not build:\n{errors}")
}

/// The bytes of flash and RAM of the image, for information.
fn size() -> Result<String> {
    let (flash, ram) = bytes(&target::built("link"))?;
    Ok(format!(
        "{flash} bytes of code and constants, {ram} of variables"
    ))
}

/// The bytes of the read-only sections, and of the others.
fn bytes(image: &Path) -> Result<(u64, u64)> {
    let data = std::fs::read(image)?;
    let file = object::File::parse(data.as_slice())?;
    let (mut flash, mut ram) = (0_u64, 0_u64);
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
            continue;
        };
        if sh_flags.0 & object::elf::SHF_ALLOC.0 == 0 {
            continue;
        }
        if sh_flags.0 & object::elf::SHF_WRITE.0 != 0 {
            ram += section.size();
        } else {
            flash += section.size();
        }
    }
    Ok((flash, ram))
}
