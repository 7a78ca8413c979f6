//! Takes a release apart as a user does: unpacks the packages and runs what is in them.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use object::elf::{EM_AARCH64, EM_X86_64, FileHeader64, PT_INTERP};
use object::read::elf::{FileHeader, ProgramHeader};
use object::{Endianness, elf};
use serde_json::Value;

use super::linux::{self, Target};
use super::{FIRMWARE, VERSION, out, sums};
use crate::{image, run, setup};

/// Runs programs of another processor.
const EMULATOR: setup::Tool = setup::Tool {
    program: "qemu-aarch64",
    package: "qemu-user",
};
/// The machine that the unit starts in the check.
const MACHINE: &str = "dist-check";
const TRIES: u32 = 100;
const BETWEEN_TRIES: Duration = Duration::from_millis(200);

/// Checks what `dist` has made.
pub fn check() -> Result<()> {
    let out = out();
    ensure!(
        out.is_dir(),
        "there is no {}: `cargo xtask dist` makes it",
        out.display()
    );
    sums::check(&out)?;
    run::read(run::command(
        &out,
        "sha256sum",
        &["--check", "--quiet", "SHA256SUMS"],
    ))?;
    for target in linux::TARGETS {
        of_linux(target, &out).with_context(|| target.triple.to_owned())?;
        println!("{}: its programs run", target.triple);
    }
    firmware(&out.join(FIRMWARE)).context(FIRMWARE)?;
    for file in [
        "page/index.html",
        "page/leadscrew.wasm",
        "manual/index.html",
    ] {
        ensure!(out.join(file).is_file(), "there is no {file}");
    }
    for (program, _) in linux::PROGRAMS {
        materials(&out, program)?;
    }
    materials(&out, image::PROGRAM)?;
    println!("{}: checked", out.display());
    Ok(())
}

fn of_linux(target: &Target, out: &Path) -> Result<()> {
    let folder = run::scratch("unpacked")?.join(target.folder);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let package = out.join(format!("leadscrew_{VERSION}-1_{}.deb", target.debian));
    let package = package.to_string_lossy();
    let field = |name: &str| run::read(run::command(out, "dpkg-deb", &["-f", &package, name]));
    ensure!(
        field("Architecture")?.trim() == target.debian,
        "the package is of another processor"
    );
    ensure!(
        field("Depends")?.trim().is_empty(),
        "the package needs others"
    );
    run::read(run::command(
        out,
        "dpkg-deb",
        &["-x", &package, &folder.to_string_lossy()],
    ))?;

    for (program, _) in linux::PROGRAMS {
        let packed = fs::read(folder.join("usr/bin").join(program))?;
        ensure!(
            packed == fs::read(out.join(target.folder).join(program))?,
            "{program} is packed as another"
        );
        is_static(&packed, target).with_context(|| (*program).to_owned())?;
    }
    let emulator = emulator(target)?;
    let examples = folder.join("usr/share/doc/leadscrew/examples");
    let start = |program: &str, args: &[&str]| {
        let program = folder.join("usr/bin").join(program);
        let program = program.to_string_lossy();
        let all: Vec<&str> = emulator
            .into_iter()
            .chain([&*program])
            .chain(args.iter().copied())
            .collect();
        run::command(&examples, all[0], &all[1..])
    };
    for (program, _) in linux::PROGRAMS {
        let told = run::read(start(program, &["--version"]))?;
        ensure!(
            told.trim().ends_with(VERSION),
            "{program} says it is {told}"
        );
    }
    let told = run::read(start("leadscrew", &["check", "shaft.nc"]))?;
    ensure!(told.contains("shaft.nc: ok"), "check says: {told}");
    let help = run::read(start("leadscrew", &["--help"]))?;
    pages(&folder, &commands(&help))?;
    completions(&folder)?;
    unit(&folder, start)
}

/// A program of this processor that needs no other file.
fn is_static(bytes: &[u8], target: &Target) -> Result<()> {
    let header = FileHeader64::<Endianness>::parse(bytes)?;
    let endian = header.endian()?;
    let machine = match target.debian {
        "amd64" => EM_X86_64,
        _ => EM_AARCH64,
    };
    ensure!(
        header.e_machine(endian) == machine,
        "it is of another processor"
    );
    let parts = header.program_headers(endian, bytes)?;
    let loader = parts
        .iter()
        .any(|part: &elf::ProgramHeader64<_>| part.p_type(endian) == PT_INTERP);
    ensure!(!loader, "it needs a loader, so it is not static");
    Ok(())
}

/// The emulator for a target that is not this machine's.
fn emulator(target: &Target) -> Result<Option<&'static str>> {
    if target.triple.starts_with(std::env::consts::ARCH) {
        return Ok(None);
    }
    ensure!(
        target.debian == "arm64",
        "nothing here runs programs of {}: check it on such a machine",
        target.triple
    );
    setup::tools(&[EMULATOR])?;
    Ok(Some(EMULATOR.program))
}

/// The commands of `--help`.
fn commands(help: &str) -> Vec<&str> {
    let list = help.split_once("Commands:\n").map_or("", |(_, list)| list);
    let lines = list.lines().take_while(|line| !line.is_empty());
    // What is wrapped is indented further.
    let rows = lines.filter_map(|line| line.strip_prefix("  ").filter(|row| !row.starts_with(' ')));
    let names = rows.filter_map(|row| row.split_whitespace().next());
    names.filter(|name| *name != "help").collect()
}

/// Each command has its manual page, in English and in Chinese, and the first page names each.
fn pages(folder: &Path, commands: &[&str]) -> Result<()> {
    let read = |below: &str, name: &str| {
        let page = folder
            .join("usr/share/man")
            .join(below)
            .join(format!("{name}.1.gz"));
        run::read(run::command(
            folder,
            "gzip",
            &["-dc", &page.to_string_lossy()],
        ))
    };
    ensure!(
        commands.len() > 30,
        "--help lists {} commands",
        commands.len()
    );
    for (below, heading) in [("man1", ".SH NAME"), ("zh_CN/man1", ".SH 名称")] {
        let first = read(below, "leadscrew")?;
        for command in commands {
            ensure!(
                first.contains(&format!("leadscrew\\-{command}(1)")),
                "the first page of {below} has no {command}"
            );
            let page = read(below, &format!("leadscrew-{command}"))?;
            ensure!(
                page.contains(heading),
                "the page {command} of {below} has no {heading}"
            );
        }
    }
    Ok(())
}

fn completions(folder: &Path) -> Result<()> {
    let bash = folder.join("usr/share/bash-completion/completions/leadscrew");
    run::read(run::command(
        folder,
        "bash",
        &["-n", &bash.to_string_lossy()],
    ))?;
    for file in [
        "fish/vendor_completions.d/leadscrew.fish",
        "zsh/vendor-completions/_leadscrew",
    ] {
        let script = fs::read_to_string(folder.join("usr/share").join(file))?;
        ensure!(
            script.contains("leadscrew"),
            "{file} completes something else"
        );
    }
    Ok(())
}

/// Starts and ends what the unit names.
fn unit(folder: &Path, start: impl Fn(&str, &[&str]) -> std::process::Command) -> Result<()> {
    let text = fs::read_to_string(folder.join("usr/lib/systemd/user/leadscrew@.service"))?;
    let line = |key: &str| -> Result<Vec<String>> {
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix(key))
            .with_context(|| format!("no {key}"))?;
        let mut words = line.split_whitespace();
        ensure!(
            words.next() == Some("/usr/bin/leadscrew"),
            "{key} is not what is installed"
        );
        Ok(words.map(|word| word.replace("%i", MACHINE)).collect())
    };
    let (begin, end) = (line("ExecStart=")?, line("ExecStop=")?);
    let words = |line: &[String]| -> Vec<String> { line.to_vec() };
    let of = |line: Vec<String>| {
        let args: Vec<&str> = line.iter().map(String::as_str).collect();
        let mut command = start("leadscrew", &args);
        // What it keeps is of this check alone.
        command.env("XDG_STATE_HOME", folder.join("state"));
        command
    };
    let mut service = of(words(&begin))
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()?;
    let ended = (0..TRIES).any(|_| {
        std::thread::sleep(BETWEEN_TRIES);
        run::read(of(words(&end))).is_ok()
    });
    if !ended {
        // It has ended by itself or is ended here.
        let _ = service.kill();
    }
    let status = service.wait()?;
    ensure!(
        ended && status.success(),
        "the unit's machine did not start and end ({status})"
    );
    Ok(())
}

fn firmware(folder: &Path) -> Result<()> {
    let file = |ending: &str| -> Result<Vec<u8>> {
        let path: PathBuf = folder.join(format!("{}-{VERSION}.{ending}", image::PROGRAM));
        fs::read(&path).with_context(|| format!("there is no {}", path.display()))
    };
    let named = format!("Leadscrew board {VERSION}");
    for ending in ["bin", "elf"] {
        let bytes = file(ending)?;
        let told = bytes
            .windows(named.len())
            .any(|part| part == named.as_bytes());
        ensure!(told, "the .{ending} does not say that it is {named}");
    }
    let hex = String::from_utf8(file("hex")?)?;
    ensure!(
        image::bytes_of(&hex)? == file("bin")?,
        ".hex and .bin are not the same"
    );
    let eds = fs::read_to_string(folder.join("leadscrew.eds"))?;
    ensure!(eds.contains("[100A]"), "the EDS lacks object 100Ah");
    Ok(())
}

fn materials(out: &Path, program: &str) -> Result<()> {
    let path = out.join("sbom").join(format!("{program}.cdx.json"));
    let bill: Value = serde_json::from_str(&fs::read_to_string(&path)?)?;
    let names: Vec<_> = bill["components"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|one| one["name"].as_str())
        .collect();
    if bill["metadata"]["component"]["version"] != VERSION || !names.contains(&"leadscrew-core") {
        bail!(
            "{} is not of {VERSION}, or lacks what it is made of",
            path.display()
        );
    }
    Ok(())
}
