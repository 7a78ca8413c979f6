//! The first hour at a machine, `docs/first-hour.md` and what belongs to it, on the bus: `board-sim` in one process,
//! `leadscrew` in others. It is what the machine of `leadscrew up` does, command by command.

use std::path::{Path, PathBuf};
use std::process::Command;

use leadscrew_tests::typed_page::{Shell, Step, hour, steps};

use crate::bus::{INTERFACE, PATIENCE, ours, scratch};
use crate::machine::Board;

/// What the page shows otherwise: of its text, and what stands for it here.
const OTHERWISE: [(&str, &str); 4] = [
    ("sim:desk", INTERFACE),
    // Nothing is asserted about time.
    ("· 0 setpoints late ·", "· ... setpoints late ·"),
    (
        "error: no simulated machine `desk` is running; `leadscrew up --name desk` starts it\n",
        "error: no board answers as node 1 on ...\n",
    ),
    // Here time passes until the drives are up.
    (
        "$ leadscrew sim power cycle\n...\n",
        "$ leadscrew sim power cycle\n...\n$ leadscrew status\nnode 1   idle ...\n...\n",
    ),
];

/// The machine of the page.
const MACHINE: [&str; 6] = [
    "--name",
    "desk",
    "--params",
    "params/machines/desk.toml",
    "--at",
    "X=-80,Z=-150",
];

/// A tick that a kernel booted as a program keeps up with, and what such a tick asks of observer and C; no gateway is
/// missed because the computer stands still, and an axis is led by hand for as long as a slow one needs.
const SLOW: [&str; 8] = [
    "9000=5000",
    "9005=15",
    "1420.C=200000",
    "1430.C=100000",
    "9024=0",
    "9027=0",
    "9040=500",
    "9047=0",
];

/// Where the sockets of a machine may be: not on the files of another kernel.
fn sockets() -> PathBuf {
    let folder = match std::env::var_os("LEADSCREW_BOOTED") {
        Some(_) => PathBuf::from("/run/leadscrew-hour"),
        None => scratch("hour-sockets"),
    };
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Machine time while this is typed, where that matters: what only takes its time need not take ours, and between a
/// resume and the next hold there is to be time for a slow computer.
fn speed(step: &Step) -> Option<&'static str> {
    let begins = |names: &[&str]| {
        let command = step.command.strip_prefix("leadscrew ");
        command.is_some_and(|command| names.iter().any(|name| command.starts_with(name)))
    };
    if step.command.ends_with('&')
        || begins(&["jog", "handwheel"])
        || step.command.starts_with("for ")
    {
        Some("1")
    } else if begins(&["hold", "resume"]) {
        Some("0.25")
    } else if begins(&["home", "mdi", "run "]) {
        Some("5")
    } else {
        None
    }
}

#[test]
fn the_first_hour_is_the_same_on_the_bus() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut page = std::fs::read_to_string(root.join("docs/first-hour.md")).unwrap();
    page = hour(&page);
    for (shown, here) in OTHERWISE {
        assert!(page.contains(shown), "{shown}");
        page = page.replace(shown, here);
    }
    let folder = scratch("hour");
    std::fs::create_dir_all(&folder).unwrap();
    for name in ["examples", "params"] {
        let link = folder.join(name);
        // Numbers of processes come again.
        if !link.exists() {
            std::os::unix::fs::symlink(root.join(name), link).unwrap();
        }
    }
    let sockets = sockets();
    let flash = scratch("hour.flash");
    let machine = MACHINE.map(|word| match word {
        "params/machines/desk.toml" => root.join(word).display().to_string(),
        word => word.to_owned(),
    });
    let mut args: Vec<&str> = machine.iter().map(String::as_str).collect();
    args.extend(SLOW.iter().flat_map(|setting| ["--set", setting]));
    args.extend(["--state", flash.to_str().unwrap()]);
    let board = Board::start_with(INTERFACE, &args, &[("XDG_RUNTIME_DIR", &sockets)]);
    board.wait_for("ready");

    let programs = ours("leadscrew");
    let path = std::env::var("PATH").unwrap();
    let mut shell = Command::new("sh");
    shell
        .current_dir(&folder)
        .env("NO_COLOR", "1")
        .env(
            "PATH",
            format!("{}:{path}", programs.parent().unwrap().display()),
        )
        .env("XDG_RUNTIME_DIR", &sockets)
        .env("XDG_STATE_HOME", folder.join("state"))
        .env_remove("LEADSCREW_BUS");
    let mut shell = Shell::start(shell);
    let mut now = "1";
    let steps = steps(&page);
    assert!(steps.len() > 80, "{}", steps.len());
    for step in &steps {
        // Its machine runs, at a time of its own.
        let set_up = ["leadscrew up", "leadscrew sim speed"];
        if set_up.iter().any(|begin| step.command.starts_with(begin)) {
            continue;
        }
        if let Some(speed) = speed(step).filter(|speed| *speed != now) {
            let told = shell.types(&format!("leadscrew sim speed {speed}"));
            assert!(told.contains("power on"), "{told}");
            now = speed;
        }
        shell.does(step, &[" setpoints came late for their SYNC"], PATIENCE);
    }
    shell.end();
    // `down` has ended it.
    let (code, words) = board.wait();
    assert_eq!(code, Some(0), "{words}");
}
