//! An emulated board, and `leadscrew` on its line.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// How long anything is waited for before it counts as lost.
const PATIENCE: Duration = Duration::from_secs(60);

/// Seconds that a command may take; what hangs is ended, and shows in its exit code 124.
const LIMIT: &str = "300";

/// A board that runs until it is dropped.
pub struct Board {
    emulator: Child,
    line: PathBuf,
}

impl Board {
    /// Switches one on; its memory is empty.
    pub fn start() -> Self {
        Self::start_with(&[])
    }

    /// The same with words on the image's command line.
    pub fn start_with(words: &[&str]) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let line = std::env::temp_dir().join(format!(
            "leadscrew-emulated-{}-{number}",
            std::process::id()
        ));
        let image = std::env::var("LEADSCREW_IMAGE")
            .expect("`cargo xtask emulated` builds the image of the board and says where it is");
        let mut semihosting = format!("enable=on,target=native,arg={image}");
        for word in words {
            semihosting.push_str(",arg=");
            semihosting.push_str(word);
        }
        let emulator = Command::new("qemu-system-arm")
            .args(["-M", "mps2-an386", "-nographic", "-monitor", "none"])
            .args([
                "-serial",
                &format!("unix:{},server=on,wait=off", line.display()),
            ])
            .args(["-semihosting-config", &semihosting, "-kernel", &image])
            .stdin(Stdio::null())
            .spawn()
            .expect("`qemu-system-arm` (`cargo xtask setup` installs it)");
        let board = Self { emulator, line };
        let started = Instant::now();
        while !board.line.exists() {
            assert!(started.elapsed() < PATIENCE, "there is no line");
            std::thread::sleep(Duration::from_millis(20));
        }
        board.wait_for("the drives come up", |status| {
            field(status, "state") != "starting"
        });
        board
    }

    /// `leadscrew` on its line, to its end.
    pub fn leadscrew(&self, args: &[&str]) -> Output {
        let output = Command::new("timeout")
            .arg(LIMIT)
            .arg(ours())
            .args(args)
            .arg("--bus")
            .arg(format!("slcan:unix:{}", self.line.display()))
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .output();
        output.expect("`timeout` of coreutils")
    }

    /// What it printed, where it ended well.
    #[track_caller]
    pub fn good(&self, args: &[&str]) -> String {
        let output = self.leadscrew(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", both(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// What it said, where it ended with this exit code.
    #[track_caller]
    pub fn bad(&self, args: &[&str], code: i32) -> String {
        let output = self.leadscrew(args);
        assert_eq!(
            output.status.code(),
            Some(code),
            "{args:?}: {}",
            both(&output)
        );
        both(&output)
    }

    /// Waits until `status --json` shows what is wanted.
    #[track_caller]
    pub fn wait_for(&self, what: &str, wanted: impl Fn(&str) -> bool) -> String {
        let started = Instant::now();
        loop {
            // One that starts anew at this moment does not answer.
            let output = self.leadscrew(&["status", "--json"]);
            let status = String::from_utf8_lossy(&output.stdout).into_owned();
            if output.status.success() && wanted(&status) {
                return status;
            }
            assert!(started.elapsed() < PATIENCE, "{what}: {}", both(&output));
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        // One that has ended by itself is gone already.
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
        let _ = std::fs::remove_file(&self.line);
    }
}

/// What was printed on either stream.
pub fn both(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

/// `leadscrew`, built beside the tests.
pub fn ours() -> PathBuf {
    let mut path = std::env::current_exe().expect("this program has a name");
    path.pop();
    path.pop();
    path.push("leadscrew");
    assert!(
        path.is_file(),
        "{} is not built; `cargo xtask emulated` builds it",
        path.display()
    );
    path
}

/// An example of the repository.
pub fn example(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples")
        .join(name)
        .display()
        .to_string()
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
