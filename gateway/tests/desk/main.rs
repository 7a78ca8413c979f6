//! Simulated machines that stay, with real processes: `up`, `down`, `sim`, and other commands over `sim:NAME`.

mod agent;
mod away;
mod by_hand;
mod clients;
mod explain;
mod fleet;
mod from;
mod functions;
mod life;
mod mdi;
mod page;
mod panel;
mod pickup;
#[path = "../pty/mod.rs"]
mod pty;
mod shop;
mod tune;
mod tutorial;
mod typed;
#[path = "../../../tests/src/typed_page.rs"]
mod typed_page;
mod wheel;

use std::io::Write as _;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use serde_json::Value;

/// Nothing takes so long on any computer.
const LIMIT: Duration = Duration::from_secs(300);

/// A move of half an hour.
const LONG: &str = "G98 G1 Z-30 F1\nM30\n";

/// A move of a moment.
const SHORT: &str = "G98 G1 X-4 Z-1 F3000\nM30\n";

/// A user with folders of its own, and no machine yet. At its end its machines end.
struct User(PathBuf);

impl User {
    fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("ls-desk-{}-{number}", std::process::id()));
        std::fs::create_dir_all(path.join("run")).unwrap();
        Self(path)
    }

    /// A user whose machine `desk` runs. It does not watch the gateway: on a busy computer a command may be silent for
    /// longer than a second, and a program would be held.
    #[track_caller]
    fn with_machine() -> Self {
        Self::with_machine_of(&["9024=0"])
    }

    /// The same, and it waits for the frames of a press as long as it may, for the same reason.
    #[track_caller]
    fn patient() -> Self {
        Self::with_machine_of(&["9024=0", "9040=500"])
    }

    #[track_caller]
    fn with_machine_of(values: &[&str]) -> Self {
        let user = Self::new();
        let set = values.iter().flat_map(|value| ["--set", value]);
        good(&user.does(&["up"].into_iter().chain(set).collect::<Vec<_>>()));
        user
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = self.program_of(env!("CARGO_BIN_EXE_leadscrew"));
        command.args(args);
        command
    }

    /// A shell that reads its commands from the input and finds the programs that are tested. Nobody waits for ever for a
    /// command that does not end.
    fn with_path(&self) -> Command {
        let binary = Path::new(env!("CARGO_BIN_EXE_leadscrew")).parent().unwrap();
        let path = std::env::var("PATH").unwrap();
        let mut shell = self.program_of("timeout");
        shell.args(["900", "sh"]);
        shell.env("PATH", format!("{}:{path}", binary.display()));
        shell
    }

    fn program_of(&self, name: &str) -> Command {
        let mut command = Command::new(name);
        command
            .current_dir(&self.0)
            .env("NO_COLOR", "1")
            .env("XDG_RUNTIME_DIR", self.0.join("run"))
            .env("XDG_STATE_HOME", self.0.join("state"))
            .env("LEADSCREW_BUS", "sim:desk")
            .stdin(Stdio::null());
        command
    }

    /// Carries out a command.
    fn does(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    #[track_caller]
    fn json(&self, args: &[&str]) -> Value {
        let output = self.does(&[args, &["--json"]].concat());
        serde_json::from_str(&good(&output)).unwrap()
    }

    /// The machine around the board.
    #[track_caller]
    fn machine(&self) -> Value {
        self.json(&["sim", "state"])["machine"].take()
    }

    /// A program in its folder.
    fn program(&self, text: &str) -> String {
        let path = self.0.join("part.nc");
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }

    /// A run under way.
    #[track_caller]
    fn run(&self, text: &str) -> Child {
        let program = self.program(text);
        let mut command = self.command(&["run", &program, "--json"]);
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let run = piped.spawn().unwrap();
        self.wait_for("run");
        run
    }

    /// Waits until the board is in this state.
    #[track_caller]
    fn wait_for(&self, state: &str) -> Value {
        let end = Instant::now() + LIMIT;
        loop {
            let status = self.json(&["status", "--node", "1"]);
            if status["state"] == state {
                return status;
            }
            assert!(Instant::now() < end, "{status}");
        }
    }

    fn socket(&self, name: &str) -> PathBuf {
        self.0.join("run/leadscrew").join(name)
    }

    /// A client of the bus that is no command of ours.
    fn client(&self) -> UnixStream {
        let mut client = UnixStream::connect(self.socket("desk.sock")).unwrap();
        client.set_read_timeout(Some(LIMIT)).unwrap();
        client.write_all(b"S8\rO\r").unwrap();
        client
    }
}

impl Drop for User {
    fn drop(&mut self) {
        // A test that fails leaves any of these behind.
        for name in ["desk", "other", "third"] {
            let _ = self.does(&["down", "--name", name]);
        }
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[track_caller]
fn good(output: &Output) -> String {
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{told}");
    text(&output.stdout)
}

/// What it says where it ends with this code.
#[track_caller]
fn bad(output: &Output, code: i32) -> String {
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{told}");
    told
}

fn exists(path: &Path) -> bool {
    std::fs::symlink_metadata(path).is_ok()
}
