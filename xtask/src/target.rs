//! The ARM target's `core` for exactly the compiler in use.
//!
//! Normally rustup has fetched it already, because `rust-toolchain.toml` names it. Rustup may be unable to do so: its
//! server is out of reach, or the compiler did not come from rustup. Then the same three libraries come from an archive
//! (in the folder [`ARCHIVE_FOLDER`] or the one that the variable [`ARCHIVE_VARIABLE`] names), or are built here from
//! the library source that Debian packages. In each case the compiler itself checks the result: it refuses libraries of
//! another compiler.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, anyhow, bail};

use crate::{files, run};

/// Cortex-M4F, with hardware floating point registers.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// The variable that names a folder with `thumbv7em-none-eabihf-rust-VERSION.tar.xz`.
const ARCHIVE_VARIABLE: &str = "LEADSCREW_TOOLCHAIN_DIR";
/// The project's own folder for this archive.
const ARCHIVE_FOLDER: &str = "toolchain";

/// The compiler of `rust-toolchain.toml`, and the Debian package of its library source.
const COMPILER: &str = "1.95.0";
const SOURCE_PACKAGE: &str = "rust-src";
const SOURCE_VERSION: &str = "1.95.0+dfsg1-2~bpo13+1";
const SOURCE_SUITE: &str = "trixie-backports";

/// Builds a program of the firmware in its only profile, which is also the flashed one. Gives the program's path.
pub fn build(package: &str, program: &str, more: &[&str]) -> Result<PathBuf> {
    let build = ["build", "--quiet", "--release", "--package", package];
    let build = [&build[..], &["--bin", program], more].concat();
    run::show(run::cargo(&run::firmware(), &build))?;
    Ok(built(program))
}

/// The path of a built program of the firmware.
pub fn built(program: &str) -> PathBuf {
    run::firmware()
        .join("target")
        .join(TARGET)
        .join("release")
        .join(program)
}

/// Makes sure that the target builds.
pub fn ensure() -> Result<()> {
    if works() {
        return Ok(());
    }
    let compiler = run::read(run::command(&run::root(), "rustc", &["--version"]))?;
    if by_rustup(TARGET) && works() {
        return Ok(());
    }
    if compiler.split_whitespace().nth(1) != Some(COMPILER) {
        bail!(
            "rustup cannot add {TARGET}, and the other ways serve rustc {COMPILER} only, while this is {}; \
             use the compiler that rust-toolchain.toml names",
            compiler.trim()
        );
    }
    let archive = match from_archive() {
        Ok(()) => return Ok(()),
        Err(error) => error,
    };
    let source = match from_source() {
        Ok(()) => return Ok(()),
        Err(error) => error,
    };
    bail!(
        "there is no {TARGET} for rustc {COMPILER}:\n\
         - rustup: `rustup target add {TARGET}` fails; with a connection to its server it is all that is needed\n\
         - archive: {archive:#}\n\
         - library source: {source:#}"
    )
}

/// Has rustup add a target. False where it cannot.
pub fn by_rustup(triple: &str) -> bool {
    println!("the target {triple} is missing: trying rustup");
    let rustup = run::command(&run::root(), "rustup", &["target", "add", triple]);
    run::try_quietly(rustup, Duration::from_secs(180))
}

/// True where the compiler accepts the target's `core` and can optimise it together with the program.
fn works() -> bool {
    rustlib().is_ok_and(|rustlib| has_bitcode(&rustlib.join(TARGET).join("lib"))) && compiles()
}

/// True where `core` contains bitcode for link-time optimisation. A build by cargo leaves it out by default.
fn has_bitcode(lib: &Path) -> bool {
    let Ok(entries) = fs::read_dir(lib) else {
        return false;
    };
    entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .any(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let is_core = name.starts_with("libcore-") && name.ends_with(".rlib");
            is_core
                && fs::read(&path)
                    .is_ok_and(|bytes| bytes.windows(7).any(|seven| seven == b".llvmbc"))
        })
}

fn compiles() -> bool {
    // The result goes into a folder of its own: a compiler that runs as root would replace an output file.
    let Ok(dir) = run::scratch("probe") else {
        return false;
    };
    let source = dir.join("probe.rs");
    if fs::write(
        &source,
        "#![no_std]\npub fn probe(a: Option<u8>) -> u8 { a.unwrap_or(0) }\n",
    )
    .is_err()
    {
        return false;
    }
    let args = [
        "--target",
        TARGET,
        "--crate-type",
        "lib",
        "--emit",
        "metadata",
        "--out-dir",
    ];
    let mut probe = run::command(&run::root(), "rustc", &args);
    probe.arg(&dir).arg(&source);
    run::try_quietly(probe, Duration::from_secs(60))
}

/// The folder of the compiler's targets.
pub fn rustlib() -> Result<PathBuf> {
    let sysroot = run::read(run::command(&run::root(), "rustc", &["--print", "sysroot"]))?;
    Ok(Path::new(sysroot.trim()).join("lib").join("rustlib"))
}

/// Removes libraries that do not fit: the compiler does not choose between two.
fn clear(rustlib: &Path) -> Result<()> {
    // This also removes everything built against them: the compiler would miss them.
    let built = run::root().join("target").join(TARGET);
    for dir in [rustlib.join(TARGET), built, run::firmware().join("target")] {
        if dir.exists() {
            fs::remove_dir_all(&dir)
                .with_context(|| format!("cannot take {} away", dir.display()))?;
        }
    }
    Ok(())
}

fn from_archive() -> Result<()> {
    let named = std::env::var_os(ARCHIVE_VARIABLE).map(PathBuf::from);
    let places = [named, Some(run::root().join(ARCHIVE_FOLDER))];
    let archive = places
        .into_iter()
        .flatten()
        .map(|dir| dir.join(archive_name()))
        .find(|archive| archive.is_file())
        .ok_or_else(|| {
            anyhow!(
                "{} is neither in the folder `{ARCHIVE_FOLDER}` of the project nor in one that the variable \
                 {ARCHIVE_VARIABLE} names",
                archive_name()
            )
        })?;
    println!("taking the target from {}", archive.display());
    let rustlib = rustlib()?;
    clear(&rustlib)?;
    let unpack = run::command(
        &rustlib,
        "tar",
        &["-xJf", &archive.to_string_lossy(), TARGET],
    );
    run::read(unpack).context("the archive does not unpack into the compiler's folder")?;
    if works() {
        return Ok(());
    }
    fs::remove_dir_all(rustlib.join(TARGET))
        .context("cannot take the unfit libraries away again")?;
    bail!(
        "{} was made by another compiler than this one, or without bitcode",
        archive.display()
    )
}

fn archive_name() -> String {
    format!("{TARGET}-rust-{COMPILER}.tar.xz")
}

fn from_source() -> Result<()> {
    let rustlib = rustlib()?;
    let library = rustlib.join("src").join("rust").join("library");
    if !library.join("core").join("Cargo.toml").is_file() {
        let unpacked = debian_source()?;
        files::copy(&unpacked, &library)
            .context("cannot put the library source into the compiler's folder")?;
        fs::remove_dir_all(run::scratch("rust-src")?)?;
    }
    println!("building core for {TARGET} from its source");
    let dir = run::scratch("build-std")?;
    if dir.join("target").exists() {
        // The result of an earlier build would be taken for this build's.
        fs::remove_dir_all(dir.join("target"))?;
    }
    fs::create_dir_all(dir.join("src"))?;
    fs::write(
        dir.join("Cargo.toml"),
        "[package]\nname = \"probe\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[workspace]\n",
    )?;
    fs::write(dir.join("src").join("lib.rs"), "#![no_std]\n")?;
    let args = [
        "build",
        "--release",
        "--target",
        TARGET,
        "-Z",
        "build-std=core,alloc,compiler_builtins",
    ];
    let mut build = run::cargo(
        &dir,
        &[
            &args[..],
            &["-Z", "build-std-features=compiler-builtins-mem"],
        ]
        .concat(),
    );
    build
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTFLAGS", "-C embed-bitcode=yes")
        .env("CARGO_TARGET_DIR", dir.join("target"));
    run::read(build).context("core does not build")?;

    let built = dir.join("target").join(TARGET).join("release").join("deps");
    clear(&rustlib)?;
    let into = rustlib.join(TARGET).join("lib");
    fs::create_dir_all(&into).with_context(|| format!("cannot write into {}", into.display()))?;
    for entry in fs::read_dir(&built)? {
        let path = entry?.path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let wanted = ["libcore-", "liballoc-", "libcompiler_builtins-"]
            .iter()
            .any(|start| name.starts_with(start));
        if wanted && name.ends_with(".rlib") {
            fs::copy(&path, into.join(&name))?;
        }
    }
    if works() {
        Ok(())
    } else {
        bail!(
            "what was built in {} does not fit this compiler",
            built.display()
        )
    }
}

/// Fetches and unpacks Debian's package of the library source, without touching the machine's own package lists.
fn debian_source() -> Result<PathBuf> {
    for program in ["apt-get", "dpkg-deb"] {
        if !run::have(program) {
            bail!("the library source comes from Debian, and there is no {program} here");
        }
    }
    let mirror = debian_mirror()?;
    let dir = run::scratch("rust-src")?;
    for part in ["lists/partial", "cache/archives/partial", "unpacked"] {
        fs::create_dir_all(dir.join(part))?;
    }
    let keyring = "/usr/share/keyrings/debian-archive-keyring.gpg";
    let list = dir.join("sources.list");
    fs::write(
        &list,
        format!("deb [signed-by={keyring}] {mirror} {SOURCE_SUITE} main\n"),
    )?;
    let option = |name: &str, path: PathBuf| format!("{name}={}", path.display());
    let options = [
        option("Dir::Etc::SourceList", list),
        "Dir::Etc::SourceParts=/dev/null".into(),
        option("Dir::State::Lists", dir.join("lists")),
        option("Dir::Cache", dir.join("cache")),
        "APT::Sandbox::User=".into(),
        // The machine's hooks are for its own package lists, not for these.
        "APT::Update::Post-Invoke::=true".into(),
    ];
    let apt_get = |what: &[&str]| {
        let mut args: Vec<&str> = options
            .iter()
            .flat_map(|option| ["-o", option.as_str()])
            .collect();
        args.extend_from_slice(what);
        run::read(run::command(&dir, "apt-get", &args))
    };
    let wanted = format!("{SOURCE_PACKAGE}={SOURCE_VERSION}");
    println!("fetching {wanted}");
    apt_get(&["update"]).with_context(|| format!("cannot read {SOURCE_SUITE} from the mirror"))?;
    apt_get(&["download", &wanted])
        .with_context(|| format!("the mirror does not give {wanted}"))?;
    let package = fs::read_dir(&dir)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .find(|path| path.extension().is_some_and(|extension| extension == "deb"))
        .ok_or_else(|| anyhow!("apt-get left no package in {}", dir.display()))?;
    let unpacked = dir.join("unpacked");
    run::read(run::command(
        &dir,
        "dpkg-deb",
        &[
            "-x",
            &package.to_string_lossy(),
            &unpacked.to_string_lossy(),
        ],
    ))?;
    let library = unpacked
        .join("usr/src")
        .join(format!("rustc-{COMPILER}"))
        .join("library");
    if library.join("core").join("Cargo.toml").is_file() {
        Ok(library)
    } else {
        bail!("{wanted} holds no {}", library.display())
    }
}

/// The Debian mirror that this machine uses.
fn debian_mirror() -> Result<String> {
    let format = "$(CREATED_BY) $(ORIGIN) $(REPO_URI)";
    let targets = run::read(run::command(
        Path::new("/"),
        "apt-get",
        &["indextargets", "--format", format],
    ))?;
    let mut words = targets.lines().map(|line| line.split_whitespace());
    words
        .find_map(|mut line| match (line.next(), line.next(), line.next()) {
            (Some("Packages"), Some("Debian"), Some(uri)) if !uri.contains("security") => {
                Some(uri.to_owned())
            }
            _ => None,
        })
        .ok_or_else(|| {
            anyhow!(
                "this machine's apt knows no Debian mirror (is `apt-get update` still to be done?)"
            )
        })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Cargo has two profiles, one of them for a build without a name. The flashed image must not depend on the name.
    #[test]
    fn what_is_flashed_has_one_profile() {
        let manifest = fs::read_to_string(run::firmware().join("Cargo.toml")).unwrap();
        let mut profiles: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        let mut place = None;
        for line in manifest.lines() {
            if let Some(name) = line.strip_prefix('[') {
                place = name.strip_prefix("profile.").map(str::to_owned);
            } else if let Some(name) = &place
                && line.contains('=')
                && !line.starts_with('#')
            {
                profiles.entry(name.clone()).or_default().push(line);
            }
        }
        assert!(profiles.contains_key("release]"));
        for (name, lines) in &profiles {
            let Some(part) = name.strip_prefix("release") else {
                assert!(name.starts_with("dev"), "a further profile: {name}");
                continue;
            };
            let mut dev = profiles[&format!("dev{part}")].clone();
            // The default of `dev` differs in these three.
            let own = [
                "debug-assertions = false",
                "overflow-checks = false",
                "incremental = false",
            ];
            if part == "]" {
                assert!(own.iter().all(|line| dev.contains(line)));
                dev.retain(|line| !own.contains(line));
            }
            assert_eq!(&dev, lines, "{name}");
        }
        assert_eq!(profiles.len() % 2, 0, "{:?}", profiles.keys());
    }
}
