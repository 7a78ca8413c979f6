//! The panel on a terminal of its own: keys are typed, and the machine is asked what has come of them.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::process::Child;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use nix::sys::termios::{Termios, tcgetattr};
use rustix::termios::Winsize;
use serde_json::Value;

use crate::{LIMIT, User, bad, good};

/// What the program asks a terminal: which of kitty's flags it has, and what it is.
const QUESTION: &[u8] = b"\x1b[?u\x1b[c";
/// Such flags, and a plain terminal. One without them says the latter alone.
const WITH_RELEASE: &[u8] = b"\x1b[?0u\x1b[?62c";
const WITHOUT: &[u8] = b"\x1b[?62c";

/// After this time a key is pressed again.
const SOON: Duration = Duration::from_secs(1);

const SIZE: Winsize = Winsize {
    ws_row: 24,
    ws_col: 80,
    ws_xpixel: 0,
    ws_ypixel: 0,
};

struct Terminal {
    ends: crate::pty::Ends,
    before: Termios,
    child: Child,
    keys: File,
    drawn: Arc<Mutex<Vec<u8>>>,
    reader: JoinHandle<()>,
}

impl Terminal {
    /// A panel on a terminal that answers so to the question.
    fn start(user: &User, args: &[&str], answer: &'static [u8]) -> Self {
        let ends = crate::pty::open(Some(SIZE));
        let before = tcgetattr(&ends.slave).unwrap();
        let end = || ends.slave.try_clone().unwrap();
        let child = user
            .command(&[&["monitor"], args].concat())
            .stdin(end())
            .stdout(end())
            .stderr(end())
            .spawn()
            .unwrap();
        let keys = File::from(ends.master.try_clone().unwrap());
        let (mut output, mut answers) = (keys.try_clone().unwrap(), keys.try_clone().unwrap());
        // What is drawn has to be taken, or the panel would wait for room.
        let drawn = Arc::new(Mutex::new(Vec::new()));
        let all = Arc::clone(&drawn);
        let reader = std::thread::spawn(move || {
            let (mut bytes, mut answered) = ([0; 4096], false);
            // Ends with an error once nobody has the other end.
            while let Ok(count @ 1..) = output.read(&mut bytes) {
                let mut drawn = all.lock().unwrap();
                drawn.extend_from_slice(&bytes[..count]);
                if !answered && drawn.windows(QUESTION.len()).any(|at| at == QUESTION) {
                    answered = true;
                    answers.write_all(answer).unwrap();
                }
            }
        });
        let terminal = Self {
            ends,
            before,
            child,
            keys,
            drawn,
            reader,
        };
        // Typed before anything can be seen it is for nobody.
        (&terminal.keys).write_all(b"s").unwrap();
        terminal.wait_for("G54");
        terminal
    }

    fn text(&self) -> String {
        String::from_utf8_lossy(&self.drawn.lock().unwrap()).into_owned()
    }

    /// Waits until it has drawn this.
    #[track_caller]
    fn wait_for(&self, text: &str) {
        let end = Instant::now() + LIMIT;
        while !self.text().contains(text) {
            assert!(Instant::now() < end, "{:?}", self.text());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn types(&mut self, keys: &str) {
        self.keys.write_all(keys.as_bytes()).unwrap();
    }

    /// Types these keys until the board says so. On a busy computer what the panel knows is old, and a key is for nobody:
    /// it is pressed again after this time.
    #[track_caller]
    fn until(&mut self, user: &User, keys: &str, time: Duration, done: impl Fn(&Value) -> bool) {
        let end = Instant::now() + LIMIT;
        loop {
            self.types(keys);
            let again = Instant::now() + time;
            while Instant::now() < again {
                let status = user.json(&["status", "--node", "1"]);
                if done(&status) {
                    return;
                }
                assert!(Instant::now() < end, "{keys:?}: {status}");
            }
        }
    }

    /// Types these keys until this is drawn, for the same reason.
    #[track_caller]
    fn draws(&mut self, keys: &str, text: &str) {
        let (end, from) = (Instant::now() + LIMIT, self.text().len());
        while !self.text()[from..].contains(text) {
            assert!(Instant::now() < end, "{:?}", self.text());
            self.types(keys);
            let again = Instant::now() + Duration::from_secs(1);
            while !self.text()[from..].contains(text) && Instant::now() < again {
                std::thread::sleep(Duration::from_millis(5));
            }
        }
    }

    /// Types a key that asks and presses Enter, some time behind it, as often as it takes.
    #[track_caller]
    fn enter(&mut self, user: &User, key: &str, done: impl Fn(&Value) -> bool) {
        let end = Instant::now() + LIMIT;
        loop {
            self.types(key);
            std::thread::sleep(Duration::from_millis(100));
            self.types("\r");
            let status = user.json(&["status", "--node", "1"]);
            if done(&status) {
                return;
            }
            assert!(Instant::now() < end, "{status}");
        }
    }

    /// Its exit code, and what it has drawn. The terminal is what it was.
    #[track_caller]
    fn end(mut self) -> (Option<i32>, String) {
        let code = self.child.wait().unwrap().code();
        let after = tcgetattr(self.ends.slave.as_fd()).unwrap();
        assert_eq!(after.local_flags, self.before.local_flags);
        assert_eq!(after.input_flags, self.before.input_flags);
        assert_eq!(after.output_flags, self.before.output_flags);
        let drawn = Arc::clone(&self.drawn);
        drop((self.ends, self.keys));
        self.reader.join().unwrap();
        let drawn = drawn.lock().unwrap();
        (code, String::from_utf8_lossy(&drawn).into_owned())
    }
}

/// Waits until the board says so.
#[track_caller]
fn wait(user: &User, done: impl Fn(&Value) -> bool) -> Value {
    let end = Instant::now() + LIMIT;
    loop {
        let status = user.json(&["status", "--node", "1"]);
        if done(&status) {
            return status;
        }
        assert!(Instant::now() < end, "{status}");
    }
}

fn mz(status: &Value) -> f64 {
    status["mz"].as_f64().unwrap()
}

#[test]
fn keys_change_the_mode_run_a_line_jog_hold_and_leave() {
    let user = User::with_machine();
    let mut terminal = Terminal::start(&user, &[], WITH_RELEASE);
    terminal.until(&user, "md", SOON, |status| status["mode"] == "mdi");
    // A line, which Space holds and resume lets go on. Letters that no line takes would be keys; Esc closes a line.
    terminal.draws("\x1b[27u:", "di>");
    terminal.types("G98 G1 Z-1 F20");
    terminal.enter(&user, "", |status| status["state"] == "run");
    terminal.until(&user, " ", SOON, |status| status["state"] == "hold");
    // Nobody leaves while it is under way.
    terminal.types("q");
    terminal.enter(&user, "r", |status| status["state"] != "hold");
    wait(&user, |status| {
        mz(status) == -1.0 && status["state"] == "idle"
    });
    // Whether the line has ended here too is shown, not told: the mode changes once it has.
    terminal.until(&user, "mm", SOON, |status| status["mode"] == "manual");
    // Left, and its repetitions: towards Z minus, for as long as it takes.
    let end = Instant::now() + LIMIT;
    while mz(&user.json(&["status", "--node", "1"])) > -1.1 {
        assert!(Instant::now() < end);
        terminal.types("\x1b[1;1:1D");
        for _ in 0..10 {
            std::thread::sleep(Duration::from_millis(30));
            terminal.types("\x1b[1;1:2D");
        }
        terminal.types("\x1b[1;1:3D");
    }
    let place = wait(&user, |status| status["state"] == "idle");
    let still = |status: &Value| mz(status) == mz(&user.json(&["status", "--node", "1"]));
    wait(&user, still);
    assert!(mz(&place) < -1.0);
    // Each is counted from the one before; where only one of them has been heard, both are typed anew.
    let feed = |user: &User| user.json(&["status", "--node", "1"])["override"]["feed"].clone();
    let end = Instant::now() + LIMIT;
    while feed(&user) != 80 {
        assert!(Instant::now() < end);
        good(&user.does(&["override", "feed", "100"]));
        std::thread::sleep(SOON);
        terminal.types("jj");
        std::thread::sleep(SOON);
    }
    terminal.until(&user, "s", SOON, |status| status["state"] == "alarm");
    terminal.enter(&user, "e", |status| status["state"] == "idle");
    terminal.types("q");
    let (code, drawn) = terminal.end();
    assert_eq!(code, Some(0));
    // The flags of the keyboard are set on the picture's screen and taken back before it is left.
    assert!(drawn.contains("\x1b[>3u"), "{drawn:?}");
    let behind = "\x1b[<1u\x1b[?1004l\x1b[?2004l\x1b[?25h\x1b[?1049l";
    assert!(drawn.ends_with(behind), "{drawn:?}");
}

#[test]
fn the_panel_stays_when_its_machine_is_gone_and_operates_the_next_one() {
    let user = User::with_machine();
    let mut terminal = Terminal::start(&user, &[], WITH_RELEASE);
    good(&user.does(&["down"]));
    terminal.wait_for("nothing is ordered");
    // Keys order nothing, now or later.
    terminal.types("mds r\r");
    good(&user.does(&["up"]));
    terminal.wait_for("heard again after");
    let status = user.json(&["status", "--node", "1"]);
    assert_eq!(
        (&status["state"], &status["mode"], &status["hold"]),
        (&"idle".into(), &"manual".into(), &false.into())
    );
    terminal.until(&user, "md", SOON, |status| status["mode"] == "mdi");
    terminal.types("q");
    assert_eq!(terminal.end().0, Some(0));
}

#[test]
fn a_board_that_has_started_again_is_read_anew_by_the_panel() {
    let user = User::with_machine();
    let mut terminal = Terminal::start(&user, &[], WITH_RELEASE);
    // More in the log than the next start will have.
    for _ in 0..12 {
        good(&user.does(&["reset"]));
    }
    // A question that waits is for nobody.
    terminal.types("e");
    good(&user.does(&["sim", "power", "cycle"]));
    terminal.wait_for("has started again");
    user.wait_for("idle");
    terminal.draws("s", "4300 emergency stop");
    terminal.types("q");
    assert_eq!(terminal.end().0, Some(0));
}

#[test]
fn a_panel_whose_machine_is_gone_is_left_by_a_key() {
    let user = User::new();
    for args in [&[][..], &["--watch"]] {
        good(&user.does(&["up"]));
        let mut terminal = Terminal::start(&user, args, WITHOUT);
        good(&user.does(&["down"]));
        terminal.wait_for("nothing is ordered");
        terminal.types("q");
        assert_eq!(terminal.end().0, Some(0));
    }
}

/// Nobody signals it: the terminal is not that of its session.
#[test]
fn a_panel_whose_terminal_is_gone_ends() {
    let user = User::with_machine();
    // Before its question is answered, and when it has drawn.
    for is_answered in [false, true] {
        let ends = crate::pty::open(Some(SIZE));
        let end = || ends.slave.try_clone().unwrap();
        let mut child = user
            .command(&["monitor"])
            .stdin(end())
            .stdout(end())
            .stderr(end())
            .spawn()
            .unwrap();
        let mut screen = File::from(ends.master);
        let (mut drawn, mut bytes) = (Vec::new(), [0; 4096]);
        let until = if is_answered {
            b"G54".as_slice()
        } else {
            QUESTION
        };
        while !drawn.windows(until.len()).any(|at| at == until) {
            let count = screen.read(&mut bytes).unwrap();
            drawn.extend_from_slice(&bytes[..count]);
            if is_answered && drawn.ends_with(QUESTION) {
                screen.write_all(WITHOUT).unwrap();
            }
        }
        drop(screen);
        let end = Instant::now() + LIMIT;
        let code = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status.code();
            }
            if Instant::now() > end {
                child.kill().unwrap();
                panic!("it goes on");
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        // It was not aborted.
        assert_eq!(code, Some(2), "{is_answered}");
    }
    user.json(&["status", "--node", "1"]);
}

#[test]
fn without_a_release_an_arrow_is_a_step_and_the_panel_says_so() {
    let user = User::patient();
    let mut terminal = Terminal::start(&user, &["--lang", "zh"], WITHOUT);
    // In manual it moves nothing.
    terminal.draws("\x1b[D", "能");
    terminal.until(&user, "mi", SOON, |status| status["mode"] == "step");
    // A step that is on its way is not asked for again.
    let long = SOON * 20;
    terminal.until(&user, "4\x1b[D", long, |status| mz(status) == -1.0);
    terminal.types("q");
    let (code, drawn) = terminal.end();
    assert_eq!(code, Some(0));
    assert!(!drawn.contains("\x1b[>3u"));
}

#[test]
fn a_line_that_another_has_typed_and_that_is_refused_is_shown_as_that() {
    let user = User::new();
    std::fs::write(user.0.join("door.toml"), "door_input = 1\n").unwrap();
    good(&user.does(&["up", "--machine", "door.toml"]));
    let mut terminal = Terminal::start(&user, &["--watch"], WITHOUT);
    good(&user.does(&["sim", "door", "open"]));
    bad(&user.does(&["mdi", "M3 S500"]), 1);
    terminal.wait_for("refused: line 1: 4506");
    terminal.types("q");
    let (_, drawn) = terminal.end();
    assert!(!drawn.contains("reset"), "{drawn}");
}

#[test]
fn who_watches_orders_nothing_and_a_pipe_is_no_terminal() {
    let user = User::with_machine();
    let mut terminal = Terminal::start(&user, &["--watch"], WITHOUT);
    terminal.types("s m d e\r r\r");
    terminal.types("q");
    let (code, drawn) = terminal.end();
    assert_eq!(code, Some(0));
    assert!(!drawn.contains("\x1b[?u"));
    let status = user.json(&["status", "--node", "1"]);
    assert_eq!(
        (&status["state"], &status["mode"], &status["hold"]),
        (&"idle".into(), &"manual".into(), &false.into())
    );
    for args in [&["monitor"][..], &["monitor", "--watch"]] {
        let told = bad(&user.does(args), 2);
        assert!(told.contains("`status --json` is for programs"), "{told}");
    }
}
