//! The page `docs/first-hour.md`: its commands, typed one after the other into one shell, print what the page shows.
//!
//! A `console` block has commands behind `$ ` and, below each, what it prints on either output; `...` stands for what the
//! page leaves out. It must not know what the commands are about.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use crate::{LIMIT, User};

/// Where the shell is between two commands, with the exit code of the last one.
const MARK: &str = "---- exit code ";

/// A command of the page, and what it prints.
#[derive(Debug, PartialEq, Eq)]
struct Step {
    line: usize,
    command: String,
    shown: String,
}

/// The commands of a page in their order.
fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut inside = false;
    for (index, line) in page.lines().enumerate() {
        if line.starts_with("```") {
            inside = line == "```console";
        } else if let Some(command) = line.strip_prefix("$ ").filter(|_| inside) {
            steps.push(Step {
                line: index + 1,
                command: command.to_owned(),
                shown: String::new(),
            });
        } else if inside {
            let step = steps.last_mut().expect("a block begins with a command");
            step.shown += line;
            step.shown += "\n";
        }
    }
    steps
}

/// True where `told` is `shown`, with anything for each `...`.
fn is_shown(shown: &str, told: &str) -> bool {
    let mut pieces = shown.split("...");
    let Some(mut rest) = pieces.next().and_then(|first| told.strip_prefix(first)) else {
        return false;
    };
    let mut pieces = pieces.peekable();
    if pieces.peek().is_none() {
        return rest.is_empty();
    }
    while let Some(piece) = pieces.next() {
        if pieces.peek().is_none() {
            return rest.ends_with(piece);
        }
        let Some(at) = rest.find(piece) else {
            return false;
        };
        rest = &rest[at + piece.len()..];
    }
    false
}

/// A shell in which the commands are typed.
pub struct Shell {
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Shell {
    /// Starts one whose two outputs are one, with the programs that are tested.
    pub fn start(command: &mut Command) -> (Self, Child) {
        let binary = Path::new(env!("CARGO_BIN_EXE_leadscrew")).parent().unwrap();
        let path = std::env::var("PATH").unwrap();
        command
            .env("PATH", format!("{}:{path}", binary.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut shell = Self {
            input: child.stdin.take().unwrap(),
            output: BufReader::new(child.stdout.take().unwrap()),
        };
        assert_eq!(shell.types("exec 2>&1"), "");
        (shell, child)
    }

    /// Types a command. Gives what has been printed until the shell takes the next one.
    pub fn types(&mut self, command: &str) -> String {
        // The exit code stays what it was, for a page that asks for it.
        let typed = format!("{command}\nlast=$?; echo; echo \"{MARK}$last\"; (exit $last)\n");
        self.input.write_all(typed.as_bytes()).unwrap();
        let mut told = String::new();
        loop {
            let mut line = String::new();
            let count = self.output.read_line(&mut line).unwrap();
            assert!(count > 0, "the shell has ended behind `{command}`: {told}");
            if line.starts_with(MARK) {
                break;
            }
            told += &line;
        }
        told.strip_suffix('\n').unwrap_or(&told).to_owned()
    }
}

#[test]
fn the_page_of_the_first_hour_prints_what_it_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = std::fs::read_to_string(root.join("docs/first-hour.md")).unwrap();
    let user = User::new();
    for folder in ["examples", "params"] {
        std::os::unix::fs::symlink(root.join(folder), user.0.join(folder)).unwrap();
    }
    let (mut shell, mut child) = Shell::start(user.shell().env_remove("LEADSCREW_BUS"));
    let steps = steps(&page);
    assert!(steps.len() > 30, "{}", steps.len());
    for step in &steps {
        let Step {
            line,
            command,
            shown,
        } = step;
        let end = Instant::now() + LIMIT;
        loop {
            let told = shell.types(command);
            if is_shown(shown, &told) {
                break;
            }
            // Somebody who looks too early looks again.
            let again = command.starts_with("leadscrew status") && Instant::now() < end;
            assert!(
                again,
                "docs/first-hour.md:{line}: `{command}` is to print\n{shown}and prints\n{told}"
            );
        }
    }
    drop(shell);
    child.wait().unwrap();
}

#[test]
fn a_page_is_taken_apart_and_compared_to_the_letter() {
    let page = "text\n$ no\n```sh\n$ no\n```\n```console\n$ a b\nx ... y\n$ c\n```\n";
    let step = |line, command: &str, shown: &str| Step {
        line,
        command: command.to_owned(),
        shown: shown.to_owned(),
    };
    assert_eq!(steps(page), [step(7, "a b", "x ... y\n"), step(9, "c", "")]);
    for (shown, told, same) in [
        ("", "", true),
        ("", "x\n", false),
        ("x\n", "x\n", true),
        ("x\n", "x\ny\n", false),
        ("x\n...\nz\n", "x\ny\ny\nz\n", true),
        ("x\n...\nz\n", "x\ny\nzz\n", false),
        ("x ... z\n", "x z\n", false),
        ("a...b...c\n", "a1b2c\n", true),
        ("a...b...c\n", "a1c\n", false),
        ("...c\n", "abc\n", true),
        ("a\n...\n", "a\nb\n", true),
        ("a\n...\n", "b\na\n", false),
    ] {
        assert_eq!(is_shown(shown, told), same, "{shown:?} {told:?}");
    }
}
