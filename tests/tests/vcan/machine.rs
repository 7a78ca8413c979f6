//! A whole machine on the bus: `board-sim` in one process, `leadscrew` in others.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use crate::bus::{INTERFACE, PATIENCE, Running, SHEETS, code, ours, scratch};

/// An example of the repository.
pub fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples")
        .join(name)
}

/// A program of the test's own.
pub fn program(name: &str, text: &str) -> PathBuf {
    let path = scratch(name);
    std::fs::write(&path, text).unwrap();
    let beside = path.with_file_name("leadscrew.toml");
    std::fs::copy(example("leadscrew.toml"), beside).unwrap();
    path
}

/// A board that runs until it is dropped.
pub struct Board {
    process: Running,
    words: PathBuf,
}

impl Board {
    /// Starts it with its machine and waits until its drives are up.
    pub fn start(args: &[&str]) -> Self {
        let mut all = args.to_vec();
        if args.contains(&"--lockstep") {
            // At rest a second of virtual time may be over before an order has come.
            all.extend(["--set", "9047=0"]);
        } else {
            // Nothing is asserted about time, and this machine may be slow.
            all.extend(["--set", "9027=0"]);
        }
        let board = Self::start_on(INTERFACE, &all);
        board.wait_for("ready");
        board
    }

    /// The same on any bus, without waiting.
    pub fn start_on(bus: &str, args: &[&str]) -> Self {
        Self::start_with(bus, args, &[])
    }

    /// The same with these variables.
    pub fn start_with(bus: &str, args: &[&str], variables: &[(&str, &Path)]) -> Self {
        static COUNT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let words = scratch(&format!("board-{number}.txt"));
        // What is kept in a file is what the test puts there.
        let sheets: &[&str] = match args.contains(&"--state") {
            true => &[],
            false => &["--set", SHEETS],
        };
        let child = Command::new(ours("board-sim"))
            .args(["--bus", bus])
            .args(sheets)
            .args(args)
            .envs(variables.iter().copied())
            .stdin(Stdio::null())
            .stderr(File::create(&words).unwrap())
            .spawn()
            .unwrap();
        Self {
            process: Running(child),
            words,
        }
    }

    /// All that it has said.
    pub fn words(&self) -> String {
        std::fs::read_to_string(&self.words).unwrap()
    }

    /// Waits until it has said this.
    pub fn wait_for(&self, text: &str) {
        let started = std::time::Instant::now();
        while !self.words().contains(text) {
            assert!(
                started.elapsed() < PATIENCE,
                "the board does not say `{text}`: {}",
                self.words()
            );
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
    }

    /// Ends it by Ctrl-C; its exit code and words.
    pub fn interrupt(mut self) -> (Option<i32>, String) {
        interrupt(&self.process.0);
        let code = code(&mut self.process.0);
        (code, self.words())
    }

    /// Its exit code and words, where it ends by itself.
    pub fn wait(mut self) -> (Option<i32>, String) {
        let code = code(&mut self.process.0);
        (code, self.words())
    }

    /// Takes it away at once.
    pub fn kill(mut self) {
        self.process.0.kill().unwrap();
        self.process.0.wait().unwrap();
    }
}

/// Ctrl-C.
pub fn interrupt(child: &Child) {
    signal(child, "-INT");
}

fn signal(child: &Child, name: &str) {
    let pid = child.id().to_string();
    let status = Command::new("kill").args([name, &pid]).status().unwrap();
    assert!(status.success());
}

/// Seconds that anything may take; what hangs is ended, and shows in its exit code 124.
const LIMIT: &str = "300";

/// `leadscrew`, with the bus.
pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(ours("leadscrew"));
    command
        .args(args)
        .args(["--bus", INTERFACE])
        .env("NO_COLOR", "1")
        .stdin(Stdio::null());
    command
}

/// The same to its end.
pub fn leadscrew(args: &[&str]) -> Output {
    let mut limited = Command::new("timeout");
    limited
        .arg(LIMIT)
        .arg(ours("leadscrew"))
        .args(args)
        .args(["--bus", INTERFACE])
        .env("NO_COLOR", "1")
        .stdin(Stdio::null());
    limited.output().unwrap()
}

/// The result of what was started, which must be near its end.
#[track_caller]
pub fn finish(mut child: Child) -> Output {
    let started = std::time::Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!(
                "it does not end: {}",
                both(&child.wait_with_output().unwrap())
            );
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    child.wait_with_output().unwrap()
}

/// `run` in the background, with `--json`.
pub fn run(program: &Path, more: &[&str]) -> Child {
    command(&["run", program.to_str().unwrap(), "--json"])
        .args(more)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// What was printed on either stream.
pub fn both(output: &Output) -> String {
    format!("{}{}", out(output), err(output))
}

/// What was printed on standard output.
pub fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What was printed on standard error.
pub fn err(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What it printed, where it ended well.
#[track_caller]
pub fn good(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", both(output));
    out(output)
}

/// What it said, where it ended with this exit code.
#[track_caller]
pub fn bad(output: &Output, code: i32) -> String {
    assert_eq!(output.status.code(), Some(code), "{}", both(output));
    err(output)
}

/// A field of a line of JSON, as it is written.
#[track_caller]
pub fn field<'a>(json: &'a str, name: &str) -> &'a str {
    let key = format!("\"{name}\":");
    let (_, rest) = json
        .split_once(&key)
        .unwrap_or_else(|| panic!("no field `{name}` in {json}"));
    let end = rest.find([',', '}', ']']).unwrap_or(rest.len());
    rest[..end].trim_matches('"')
}

/// Waits until `status --json` shows what is wanted.
#[track_caller]
pub fn wait_for_status(what: &str, wanted: impl Fn(&str) -> bool) -> String {
    let started = std::time::Instant::now();
    loop {
        let status = good(&leadscrew(&["status", "--json"]));
        if wanted(&status) {
            return status;
        }
        assert!(started.elapsed() < PATIENCE, "{what}: {status}");
        // Whoever asks without a pause leaves no room for the program.
        std::thread::sleep(std::time::Duration::from_millis(300));
    }
}
