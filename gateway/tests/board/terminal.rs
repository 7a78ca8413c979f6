//! The view on a terminal: however it ends, the terminal is afterwards what it was before.

use std::os::fd::AsFd as _;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use nix::sys::signal::{Signal, kill};
use nix::sys::termios::{LocalFlags, Termios, tcgetattr};
use nix::unistd::Pid;

use crate::root;
use crate::server::{Options, Server};

struct View {
    terminal: crate::pty::Ends,
    before: Termios,
    child: Child,
    reader: std::thread::JoinHandle<Vec<u8>>,
}

impl View {
    fn start(bus: &str) -> Self {
        let terminal = crate::pty::open(None);
        let before = tcgetattr(&terminal.slave).unwrap();
        let end = || terminal.slave.try_clone().unwrap();
        let child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
            .args(["monitor", "--bus", bus])
            .current_dir(root())
            .stdin(end())
            .stdout(end())
            .stderr(end())
            .spawn()
            .unwrap();
        let mut master = std::fs::File::from(terminal.master.try_clone().unwrap());
        // What is drawn has to be taken, or the view would wait for room.
        let reader = std::thread::spawn(move || {
            let mut drawn = Vec::new();
            // Ends with an error once nobody has the other end.
            let _ = std::io::Read::read_to_end(&mut master, &mut drawn);
            drawn
        });
        Self {
            terminal,
            before,
            child,
            reader,
        }
    }

    fn settings(&self) -> Termios {
        tcgetattr(self.terminal.slave.as_fd()).unwrap()
    }

    fn wait_until_drawing(&mut self) {
        let end = Instant::now() + Duration::from_secs(300);
        while self.settings().local_flags.contains(LocalFlags::ICANON) {
            assert!(self.child.try_wait().unwrap().is_none(), "it has ended");
            assert!(Instant::now() < end, "it does not draw");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Its exit code, and what it has drawn.
    #[track_caller]
    fn end(mut self) -> (Option<i32>, String) {
        let code = self.child.wait().unwrap().code();
        let after = self.settings();
        assert_eq!(after.local_flags, self.before.local_flags);
        assert_eq!(after.input_flags, self.before.input_flags);
        assert_eq!(after.output_flags, self.before.output_flags);
        drop(self.terminal);
        let drawn = self.reader.join().unwrap();
        (code, String::from_utf8_lossy(&drawn).into_owned())
    }
}

#[test]
fn a_view_that_is_ended_gives_the_terminal_back() {
    let server = Server::start(&Options::default());
    for signal in [Signal::SIGTERM, Signal::SIGHUP, Signal::SIGINT] {
        let mut view = View::start(&server.bus());
        view.wait_until_drawing();
        kill(Pid::from_raw(view.child.id().cast_signed()), signal).unwrap();
        let (code, drawn) = view.end();
        assert_eq!(code, Some(0), "{signal}");
        // The screen behind the picture comes back.
        assert!(drawn.contains("\u{1b}[?1049h"), "{signal}");
        assert!(drawn.ends_with("\u{1b}[?1049l"), "{signal}: {drawn:?}");
    }
}
