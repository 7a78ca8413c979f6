//! Programs from crates.io that the commands run and that are linked into nothing: each at one version, in a folder below
//! `target`, so that nothing else on the machine is changed.

use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::run;

/// A program, its version, and the features that it needs.
pub struct Program {
    pub name: &'static str,
    pub version: &'static str,
    pub features: &'static str,
}

/// Builds Debian packages.
pub const CARGO_DEB: Program = Program {
    name: "cargo-deb",
    version: "3.8.0",
    features: "gzip",
};

/// Builds the manual. Its licence (MPL-2.0) is none of those that may be linked [D392].
pub const MDBOOK: Program = Program {
    name: "mdbook",
    version: "0.5.4",
    features: "search",
};

/// The path of a program; installs it where it is not there, or is another version.
pub fn ensure(program: &Program) -> Result<PathBuf> {
    let folder = run::scratch("tools")?;
    let path = folder.join("bin").join(program.name);
    if version(&path).is_some_and(|told| told.contains(program.version)) {
        return Ok(path);
    }
    println!("installing {} {}", program.name, program.version);
    let mut install = run::cargo(&run::root(), &["install", "--quiet", "--locked", "--force"]);
    // It runs for seconds and is built for minutes: without optimisation for one and a half.
    install.args(["--debug", "--no-default-features"]);
    install.args(["--features", program.features]);
    install
        .arg("--root")
        .arg(&folder)
        .args(["--version", program.version]);
    install.arg(program.name);
    run::read(install).with_context(|| {
        format!(
            "{} {} does not install; see that crates.io is reachable, then start again",
            program.name, program.version
        )
    })?;
    Ok(path)
}

fn version(path: &std::path::Path) -> Option<String> {
    let ask = run::command(&run::root(), &path.to_string_lossy(), &["--version"]);
    path.is_file().then(|| run::read(ask).ok()).flatten()
}
