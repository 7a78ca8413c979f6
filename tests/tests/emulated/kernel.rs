//! The board behind an interface of the kernel: `slcand` turns a serial line of the
//! machine into one, and everybody hears it.
//!
//! `cargo xtask emulated` runs each of these tests alone, where the kernel has CAN, with a board that has just been
//! switched on, and says in `LEADSCREW_TERMINAL` which line it is on.

use std::path::Path;
use std::process::Command;

use crate::board::{Board, Running, both, eventually, example, field, program};
use crate::run::same_as_simulated;

/// A CAN interface behind a serial line.
pub struct Interface {
    /// The process that makes the interface, as long as this is held.
    _slcand: Running,
}

impl Interface {
    /// No other interface has this name.
    const NAME: &str = "emulated0";

    /// Makes the interface from the serial line, at 1 Mbit/s, and switches it on.
    pub fn attach() -> Self {
        let terminal = std::env::var("LEADSCREW_TERMINAL")
            .expect("`cargo xtask emulated` says on which serial line the board is");
        let slcand = Running::start(
            "slcand",
            &["-F", "-o", "-c", "-f", "-s8", &terminal, Self::NAME],
        );
        eventually("slcand has made an interface", Self::is_there);
        let up = Command::new("ip")
            .args(["link", "set", Self::NAME, "up"])
            .output()
            .expect("`ip` (`cargo xtask setup` installs it)");
        assert!(up.status.success(), "{}", both(&up));
        Self { _slcand: slcand }
    }

    /// The value of `--bus` for this interface.
    pub fn bus(&self) -> String {
        format!("socketcan:{}", Self::NAME)
    }

    fn is_there() -> bool {
        Path::new("/sys/class/net").join(Self::NAME).exists()
    }
}

#[test]
fn a_thread_by_g76() {
    same_as_simulated(&Board::in_kernel(), &example("o0013-g76-m68x6.nc"));
}

#[test]
fn override_hold_and_resume_from_other_terminals_while_a_program_runs() {
    let board = Board::in_kernel();
    // However fast its time goes: it waits here.
    board.order_with(&["override", "feed", "0"]);
    board.wait_for("it is told", |status| field(status, "feed") == "0");
    let path = program("O0001\nG98\nG0 X50 Z0\nG1 Z-200 F6000\nG0 Z5\nM30\n");
    let running = board.start_leadscrew(&["run", &path, "--json"]);
    board.wait_for("the program runs", |status| field(status, "line") == "4");
    board.order("hold");
    board.wait_for("it holds", |status| field(status, "state") == "hold");
    board.order_with(&["override", "feed", "100"]);
    let held = board.wait_for("it is told again", |status| field(status, "feed") == "100");
    for (name, value) in [("state", "hold"), ("mz", "0")] {
        assert_eq!(field(&held, name), value, "{held}");
    }
    board.order("resume");
    let output = running.finish();
    assert_eq!(output.status.code(), Some(0), "{}", both(&output));
    assert_eq!(field(&both(&output), "ok"), "true");
    let status = board.good(&["status", "--json"]);
    assert_eq!((field(&status, "mx"), field(&status, "mz")), ("50", "5"));
}

#[test]
fn a_stop_in_a_hole_is_an_alarm_and_retract_brings_the_tap_out() {
    let board = Board::in_kernel();
    // Half a minute of its time in the hole: however fast that goes, there is time for a stop.
    let path = program("O0084\nG98\nG0 X50 Z0\nM29 S200\nG84 Z-30 P9999 F200\nG80\nM30\n");
    let running = board.start_leadscrew(&["run", &path, "--json"]);
    board.wait_for("the tap is in its hole", |status| {
        status.contains("\"in_hole\":true")
    });
    board.order("stop");
    let output = running.finish();
    assert_eq!(output.status.code(), Some(4), "{}", both(&output));
    assert!(both(&output).contains("4300"), "{}", both(&output));
    let refused = board.bad(&["retract"], 4);
    assert!(refused.contains("leadscrew reset"), "{refused}");
    board.order("reset");
    board.wait_for("it is ready again", |status| {
        field(status, "state") == "idle"
    });
    board.good(&["retract"]);
    let status = board.good(&["status", "--json"]);
    assert!(!status.contains("\"in_hole\":true"), "{status}");
}

#[test]
fn parameters_are_read_and_pushed_while_somebody_watches() {
    let board = Board::in_kernel();
    let _watching = board.start_leadscrew(&["record", "-o", "/dev/null"]);
    crate::params::pulled_pushed_and_compared(&board);
}
