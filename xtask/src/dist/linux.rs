//! Programs for Linux without a library of the machine, and their Debian packages.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::{run, target, tools};

/// A processor: its target, and its name in a folder and in a Debian package.
pub struct Target {
    pub triple: &'static str,
    pub folder: &'static str,
    pub debian: &'static str,
}

pub const TARGETS: &[Target] = &[
    Target {
        triple: "x86_64-unknown-linux-musl",
        folder: "linux-x86_64",
        debian: "amd64",
    },
    Target {
        triple: "aarch64-unknown-linux-musl",
        folder: "linux-aarch64",
        debian: "arm64",
    },
];

/// The programs, with the packages that they are of.
pub const PROGRAMS: &[(&str, &str)] = &[
    ("leadscrew", "leadscrew"),
    ("board-sim", "leadscrew-board-sim-host"),
];

/// Comes with the compiler, and links for every processor. The C library is in the target.
const LINKER: &str = "rust-lld";

/// What `leadscrew`, as this machine runs it, prints.
pub fn leadscrew(args: &[&str]) -> Result<String> {
    let program = run::programs(&["--bin", "leadscrew"])?.join("leadscrew");
    run::read(run::command(&run::root(), &program.to_string_lossy(), args))
}

/// Writes manual pages and completions to where the manifest of the package looks for them.
pub fn texts() -> Result<()> {
    let folder = run::scratch("dist")?;
    fs::remove_dir_all(&folder)?;
    let man = folder.join("man");
    for (lang, folder) in [("en", man.clone()), ("zh", man.join("zh_CN"))] {
        fs::create_dir_all(&folder)?;
        leadscrew(&["man", "--lang", lang, "--to", &folder.to_string_lossy()])?;
    }
    for (shell, name) in [
        ("bash", "leadscrew.bash"),
        ("fish", "leadscrew.fish"),
        ("zsh", "_leadscrew"),
    ] {
        let script = leadscrew(&["completions", shell])?;
        fs::write(folder.join(name), script).with_context(|| format!("cannot write {name}"))?;
    }
    Ok(())
}

/// Builds the programs for a processor, and packs them.
pub fn make(of: &Target, out: &Path) -> Result<()> {
    ensure(of.triple)?;
    let mut build = run::cargo(&run::root(), &["build", "--quiet", "--locked", "--release"]);
    build.args(["--target", of.triple]);
    for (program, package) in PROGRAMS {
        build.args(["--package", package, "--bin", program]);
    }
    build.env(linker_variable(of.triple), LINKER);
    run::show(build)?;

    let folder = out.join(of.folder);
    fs::create_dir_all(&folder)?;
    for (program, _) in PROGRAMS {
        fs::copy(built(of).join(program), folder.join(program))
            .with_context(|| format!("cargo has built no {program}"))?;
    }
    package(of, out)
}

fn built(of: &Target) -> PathBuf {
    run::root().join("target").join(of.triple).join("release")
}

fn package(of: &Target, out: &Path) -> Result<()> {
    let cargo_deb = tools::ensure(&tools::CARGO_DEB)?;
    let mut pack = run::command(&run::root(), &cargo_deb.to_string_lossy(), &[]);
    pack.args(["--quiet", "--no-build", "--no-strip", "--locked"]);
    pack.args(["--package", "leadscrew", "--target", of.triple]);
    pack.arg("--output").arg(out);
    run::read(pack).map(drop)
}

/// Cargo's variable for the linker of a target.
fn linker_variable(triple: &str) -> String {
    format!(
        "CARGO_TARGET_{}_LINKER",
        triple.to_uppercase().replace('-', "_")
    )
}

/// Makes sure that the compiler has the target.
fn ensure(triple: &str) -> Result<()> {
    let there = || -> Result<bool> {
        let lib = target::rustlib()?.join(triple).join("lib");
        Ok(lib.join("self-contained").is_dir())
    };
    if there()? || target::by_rustup(triple) && there()? {
        return Ok(());
    }
    bail!(
        "`rustup target add {triple}` fails; with a connection to its server it is all that is needed"
    )
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_linker_of_a_target_has_its_variable() {
        assert_eq!(
            super::linker_variable("aarch64-unknown-linux-musl"),
            "CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_LINKER"
        );
    }
}
