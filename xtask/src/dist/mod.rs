//! What a release holds, in `target/dist`: programs for Linux, Debian packages, the firmware, the page, the
//! manual, the bus description, bills of materials, and the checksums of all of it.
//!
//! What cannot be made on this machine is named, the rest is made, and the command fails in the end.

mod check;
mod linux;
mod materials;
mod sums;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

pub use check::check;

use crate::{files, image, manual, page, run};

/// The version of all that is made.
const VERSION: &str = env!("CARGO_PKG_VERSION");
const FIRMWARE: &str = "firmware";

/// Makes everything.
pub fn make() -> Result<()> {
    let out = out();
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("cannot renew {}", out.display()))?;
    }
    fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
    let mut missing = Vec::new();
    let mut part = |name: &str, made: Result<()>| match made {
        Ok(()) => println!("{name}: made"),
        Err(error) => {
            println!("{name}: NOT made");
            missing.push(format!("- {name}: {error:#}"));
        }
    };
    part("manual pages and completions", linux::texts());
    for target in linux::TARGETS {
        part(target.triple, linux::make(target, &out));
    }
    part(FIRMWARE, firmware(&out.join(FIRMWARE)));
    part("page", the_page(&out.join("page")));
    part("manual", the_manual(&out.join("manual")));
    part("bills of materials", materials::make(&out.join("sbom")));
    sums::write(&out)?;
    if missing.is_empty() {
        println!("{}: all of a release of {VERSION}", out.display());
        return Ok(());
    }
    bail!(
        "{} lacks what could not be made here:\n{}",
        out.display(),
        missing.join("\n")
    )
}

fn out() -> PathBuf {
    run::root().join("target").join("dist")
}

/// The image in the formats of flashing tools, and what the board is on the bus.
fn firmware(to: &Path) -> Result<()> {
    crate::target::ensure()?;
    image::write(to, &format!("{}-{VERSION}", image::PROGRAM))?;
    let eds = linux::leadscrew(&["params", "docs", "--eds"])?;
    fs::write(to.join("leadscrew.eds"), eds).context("the EDS cannot be written")
}

fn the_page(to: &Path) -> Result<()> {
    page::write()?;
    files::copy(&page::out(), to)
}

fn the_manual(to: &Path) -> Result<()> {
    manual::write()?;
    files::copy(&manual::out(), to)
}
