//! The first hour at a machine, `docs/first-hour.md` and what belongs to it, on a machine that `leadscrew up` has not
//! started: its commands, typed one after the other into one shell. It must not know what keeps the machine running.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::typed_page::{Shell, Step, hour, steps};

/// The name of the machine.
pub const NAME: &str = "desk";
/// Its parameters.
pub const PARAMS: &str = "params/machines/desk.toml";
/// Where its slides stand when the power comes, in millimetres, X a diameter.
pub const AT: [i32; 2] = [-80, -150];

/// What a slow computer asks for: no gateway is missed because it stands still, and an axis is led by hand for as long
/// as it needs.
pub const PATIENT: [&str; 4] = ["9024=0", "9027=0", "9040=500", "9047=0"];

/// Of the page and what stands for it: time passes here until the drives are up.
pub const POWER: (&str, &str) = (
    "$ leadscrew sim power cycle\n...\n",
    "$ leadscrew sim power cycle\n...\n$ leadscrew status\nnode 1   idle ...\n...\n",
);

/// The place of the commands.
pub struct Place {
    /// Where they are typed: a folder that is there.
    pub folder: PathBuf,
    /// Where the sockets of the machine are: their `XDG_RUNTIME_DIR`.
    pub sockets: PathBuf,
    /// `leadscrew`.
    pub program: PathBuf,
    /// How long anything may take.
    pub patience: Duration,
}

/// The repository.
#[must_use]
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Types the hour on the machine that is there. `otherwise` has of the page what it shows otherwise, and what stands for
/// it; lines that end with one of `beside` are passed over.
///
/// # Panics
/// Where a command prints something else than is shown.
pub fn type_hour(place: &Place, otherwise: &[(&str, &str)], beside: &[&str]) {
    let root = repository();
    let page = std::fs::read_to_string(root.join("docs/first-hour.md")).expect("the page");
    let mut page = hour(&page);
    for (shown, here) in otherwise {
        assert!(page.contains(shown), "{shown}");
        page = page.replace(shown, here);
    }
    for name in ["examples", "params"] {
        let link = place.folder.join(name);
        // Numbers of processes come again.
        if !link.exists() {
            std::os::unix::fs::symlink(root.join(name), link).expect("a link");
        }
    }
    let mut shell = shell(place);
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
        shell.does(step, beside, place.patience);
    }
    shell.end();
}

fn shell(place: &Place) -> Shell {
    let path = std::env::var("PATH").expect("a path");
    let programs = place.program.parent().expect("a folder").display();
    let mut shell = Command::new("sh");
    shell
        .current_dir(&place.folder)
        .env("NO_COLOR", "1")
        .env("PATH", format!("{programs}:{path}"))
        .env("XDG_RUNTIME_DIR", &place.sockets)
        .env("XDG_STATE_HOME", place.folder.join("state"))
        .env_remove("LEADSCREW_BUS");
    Shell::start(shell)
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
