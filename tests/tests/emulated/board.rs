//! An emulated board, and `leadscrew` on its line.

use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use crate::kernel::Interface;

/// The environment variable that says where the image is.
pub const IMAGE: &str = "LEADSCREW_IMAGE";

/// How long a test waits for anything before it counts as lost.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// Seconds that a command may take; a command that hangs is ended, which its exit code 124 shows.
const LIMIT: &str = "600";

/// What carries the board's frames.
enum Wire {
    /// Its serial line, as a socket: one gateway at a time.
    Line(PathBuf),
    /// The kernel, with an interface behind the serial line: as many as there are.
    Kernel(Interface),
}

/// A board that runs until it is dropped.
pub struct Board {
    wire: Wire,
    /// The emulator, and the file with what it prints; `None` if the board was there before this test.
    emulator: Option<(Running, PathBuf)>,
}

impl Board {
    /// Switches a board on; its memory is empty.
    pub fn start() -> Self {
        Self::start_with(&[])
    }

    /// The same with words on the image's command line.
    pub fn start_with(words: &[&str]) -> Self {
        Self::start_image(IMAGE, words)
    }

    /// The same with the image of this variable.
    pub fn start_image(image: &str, words: &[&str]) -> Self {
        let line = scratch("line");
        let emulator = emulate(&image_of(image), &line, words);
        eventually("there is a line", || line.exists());
        Self::up(Wire::Line(line), Some(emulator))
    }

    /// The one on this machine's serial line, which nobody has used before: an interface of the kernel is made of it.
    pub fn in_kernel() -> Self {
        Self::up(Wire::Kernel(Interface::attach()), None)
    }

    fn up(wire: Wire, emulator: Option<(Running, PathBuf)>) -> Self {
        let board = Self { wire, emulator };
        board.wait_for("the drives come up", |status| {
            field(status, "state") != "starting"
        });
        board
    }

    /// Its line.
    pub fn line(&self) -> &Path {
        match &self.wire {
            Wire::Line(path) => path,
            Wire::Kernel(_) => panic!("this board was there before this test"),
        }
    }

    /// Its second line: what is not on a bus is said there.
    pub fn hand(&self) -> PathBuf {
        hand(self.line())
    }

    /// The value of `--bus` for this board.
    fn bus(&self) -> String {
        match &self.wire {
            Wire::Line(path) => format!("slcan:unix:{}", path.display()),
            Wire::Kernel(interface) => interface.bus(),
        }
    }

    /// Runs `leadscrew` on the board's line, to its end.
    pub fn leadscrew(&self, args: &[&str]) -> Output {
        let output = Command::new("timeout")
            .arg(LIMIT)
            .arg(ours())
            .args(args)
            .args(["--bus", &self.bus()])
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .output();
        output.expect("`timeout` of coreutils")
    }

    /// Starts `leadscrew` on the board's line, in parallel to this test.
    pub fn start_leadscrew(&self, args: &[&str]) -> Running {
        let child = Command::new(ours())
            .args(args)
            .args(["--bus", &self.bus()])
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        Running(Some(child.expect("it starts")))
    }

    /// What it printed, where it ended well.
    #[track_caller]
    pub fn good(&self, args: &[&str]) -> String {
        let output = self.leadscrew(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", both(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Gives an order. If the host is so slow that the order is not confirmed in time, gives it again.
    #[track_caller]
    pub fn order(&self, name: &str) {
        self.order_with(&[name]);
    }

    /// An order with what belongs to it.
    #[track_caller]
    pub fn order_with(&self, args: &[&str]) {
        self.ordered(args, 0);
    }

    /// What it said of an order that ended with this exit code once it was confirmed.
    #[track_caller]
    pub fn ordered(&self, args: &[&str], code: i32) -> String {
        for _ in 0..10 {
            let output = self.leadscrew(args);
            match output.status.code() {
                Some(ended) if ended == code => return both(&output),
                Some(3) if both(&output).contains("does not confirm") => {}
                _ => panic!("{args:?}: {}", both(&output)),
            }
        }
        panic!("{args:?} is never confirmed");
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
            // A board that is just starting anew does not answer.
            let output = self.leadscrew(&["status", "--json"]);
            let status = String::from_utf8_lossy(&output.stdout).into_owned();
            if output.status.success() && wanted(&status) {
                return status;
            }
            assert!(
                started.elapsed() < PATIENCE,
                "{what}: {}{}",
                both(&output),
                String::from_utf8_lossy(&self.said())
            );
            // Asking without a pause would leave no room for a program.
            std::thread::sleep(Duration::from_millis(200));
        }
    }

    /// What emulator and image have printed.
    pub fn said(&self) -> Vec<u8> {
        let said = self.emulator.as_ref().map(|(_, path)| std::fs::read(path));
        said.map(|said| said.expect("what it said"))
            .unwrap_or_default()
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        if let Some((emulator, said)) = &mut self.emulator {
            emulator.end();
            let _ = std::fs::remove_file(said);
        }
        if let Wire::Line(path) = &self.wire {
            let _ = std::fs::remove_file(path);
            let _ = std::fs::remove_file(hand(path));
        }
    }
}

/// The second line beside this one.
fn hand(line: &Path) -> PathBuf {
    line.with_extension("hand")
}

/// Where the image of this variable is.
pub fn image_of(variable: &str) -> String {
    std::env::var(variable)
        .expect("`cargo xtask emulated` builds the images of the board and says where they are")
}

/// Starts the image; gives where it says what it prints, too.
fn emulate(image: &str, line: &Path, words: &[&str]) -> (Running, PathBuf) {
    let mut semihosting = format!("enable=on,target=native,arg={image}");
    for word in words {
        semihosting.push_str(",arg=");
        semihosting.push_str(word);
    }
    let serial = |line: &Path| format!("unix:{},server=on,wait=off", line.display());
    let said = scratch("said");
    let emulator = Command::new("qemu-system-arm")
        .args(["-M", "mps2-an386", "-nographic", "-monitor", "none"])
        .args(["-serial", &serial(line), "-serial", &serial(&hand(line))])
        .args(["-semihosting-config", &semihosting, "-kernel", image])
        .stdin(Stdio::null())
        .stdout(File::create(&said).expect("a place for what it says"))
        .spawn()
        .expect("`qemu-system-arm` (`cargo xtask setup` installs it)");
    (Running(Some(emulator)), said)
}

/// A process that ends when its holder is dropped.
pub struct Running(Option<Child>);

impl Running {
    /// Another program, with nothing of its own said.
    pub fn start(program: &str, args: &[&str]) -> Self {
        let child = Command::new(program)
            .args(args)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        Self(Some(child.unwrap_or_else(|error| {
            panic!("`{program}` (`cargo xtask setup` installs it): {error}")
        })))
    }

    /// Ends it at once.
    pub fn end(&mut self) {
        if let Some(mut child) = self.0.take() {
            // A process that has ended by itself is gone already.
            let _ = child.kill();
            let _ = child.wait();
        }
    }

    /// Waits until it has said this for people; what does not in time is ended.
    #[track_caller]
    pub fn wait_for_words(&mut self, words: &str) {
        let child = self.0.as_mut().expect("it has not been ended");
        let mut stderr = child.stderr.take().expect("it is listened to");
        let wanted = words.to_owned();
        let listener = std::thread::spawn(move || {
            let mut said = String::new();
            let heard = BufReader::new(&mut stderr).lines().map_while(Result::ok);
            for line in heard {
                if line.contains(&wanted) {
                    return Ok(stderr);
                }
                said.push_str(&line);
            }
            Err(said)
        });
        let started = Instant::now();
        while !listener.is_finished() {
            if started.elapsed() > PATIENCE {
                // With it ends what it says.
                let _ = child.kill();
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        match listener.join().expect("a listener") {
            // Whoever still writes must not find nobody there.
            Ok(stderr) => child.stderr = Some(stderr),
            Err(said) => panic!("it never says `{words}`: {said}"),
        }
    }

    /// What it printed, at its end, which must be near.
    #[track_caller]
    pub fn finish(mut self) -> Output {
        let mut child = self.0.take().expect("it has not been ended");
        let started = Instant::now();
        while child.try_wait().expect("a process").is_none() {
            if started.elapsed() > PATIENCE {
                let _ = child.kill();
                panic!(
                    "it does not end: {}",
                    both(&child.wait_with_output().expect("its output"))
                );
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        child.wait_with_output().expect("its output")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.end();
    }
}

/// Waits until a condition holds, or fails.
#[track_caller]
pub fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let started = Instant::now();
    while !holds() {
        assert!(started.elapsed() < PATIENCE, "{what}: not in time");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A file of the test's own; nothing is there yet. In a machine that is started for the tests alone numbers of
/// processes come again, and its files stay.
pub fn scratch(name: &str) -> PathBuf {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let process = std::process::id();
    let path = std::env::temp_dir().join(format!("leadscrew-emulated-{process}-{number}-{name}"));
    match std::fs::remove_file(&path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => panic!("{error}"),
        _ => path,
    }
}

/// A program of the test's own.
pub fn program(text: &str) -> String {
    let path = scratch("program.nc");
    std::fs::write(&path, text).expect("a place for a program");
    path.display().to_string()
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
