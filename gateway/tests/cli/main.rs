//! The built binary as a user meets it: exit codes, what goes to which stream, golden output, and what it says to
//! people who get it wrong.
//!
//! Golden cases lie in `tests/golden/`, one folder a case. `LEADSCREW_BLESS=1 cargo test -p leadscrew --test cli`
//! writes what the binary says now, and `cargo xtask renew` does that with all else that the program writes; read the
//! difference before it is committed.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use self::folder::Folder;

/// The root of the repository: messages show paths as they were typed, so tests type them from there.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn leadscrew(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(args)
        .current_dir(root())
        .env("NO_COLOR", "1")
        .env_remove("LEADSCREW_BUS")
        .output()
        .unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

impl Folder {
    fn new(name: &str) -> Self {
        let folder = Self::empty(name);
        // The programs of the tests are written as the examples are.
        let machine = root().join("examples/leadscrew.toml");
        std::fs::copy(machine, folder.file("leadscrew.toml")).unwrap();
        folder
    }
}

/// What to do where a file is not as the binary says now.
const RENEW: &str = "if this is meant, `cargo xtask renew` writes it anew";

/// Compares with the file, or writes it.
fn golden(path: &Path, actual: &str) {
    if std::env::var_os("LEADSCREW_BLESS").is_some() {
        std::fs::write(path, actual).unwrap();
        return;
    }
    let expected = std::fs::read_to_string(path)
        .unwrap_or_else(|error| panic!("{}: {error}; {RENEW}", path.display()));
    for (n, (expected, actual)) in expected.lines().zip(actual.lines()).enumerate() {
        let line = n + 1;
        assert_eq!(expected, actual, "{}, line {line}; {RENEW}", path.display());
    }
    assert_eq!(
        expected.lines().count(),
        actual.lines().count(),
        "{}; {RENEW}",
        path.display()
    );
}

/// The folders of `tests/golden/KIND`.
fn cases(kind: &str) -> Vec<String> {
    let folder = format!("tests/golden/{kind}");
    let mut cases: Vec<String> = std::fs::read_dir(root().join(&folder))
        .unwrap()
        .map(|entry| format!("{folder}/{}", entry.unwrap().file_name().to_str().unwrap()))
        .collect();
    cases.sort();
    assert!(!cases.is_empty());
    cases
}

/// The programs in `examples`; those of its folders have tests of their own.
fn examples() -> Vec<String> {
    let entries = std::fs::read_dir(root().join("examples")).unwrap();
    let programs: Vec<String> = entries
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.file_type().unwrap().is_file())
        .map(|entry| format!("examples/{}", entry.file_name().to_str().unwrap()))
        .filter(|name| name.ends_with(".nc"))
        .collect();
    assert!(!programs.is_empty());
    programs
}

/// Writes a program into a folder; gives its name.
fn write(folder: &Folder, name: &str, text: &str) -> String {
    let program = folder.file(name);
    std::fs::write(&program, text).unwrap();
    program
}

mod certified;
mod check;
mod corners;
mod dialects;
mod drives;
mod expand;
mod explain;
#[path = "../folder/mod.rs"]
mod folder;
mod interrupt;
mod json;
mod kept;
mod machine;
mod macros;
mod manual;
mod measure;
mod plausible;
mod plot;
mod recovery;
mod strokes;
mod subprograms;
mod taps;
mod texts;
mod tools;
mod usage;
mod variables;
