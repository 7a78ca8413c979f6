//! Another command of this program, in a process of its own: the one who begins it goes on, and what is checked and kept
//! is the same wherever it is begun.
//!
//! It must not know what the command does. That who has begun it ends does not end it: a program that the machine runs goes
//! on. Whether it has to end is asked where that is known.

use std::ffi::OsString;
use std::io::{self, Read as _};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};

use clap::ValueEnum as _;
use leadscrew_core::alarm::Lang;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use crate::cli::Global;
use crate::itself;
use crate::words::pick;

/// A command under way.
#[derive(Debug)]
pub struct Own {
    ended: Receiver<io::Result<Vec<u8>>>,
    /// To end it before its time.
    pub handle: Handle,
}

/// The process, until it has ended.
#[derive(Clone, Debug)]
pub struct Handle(Arc<Mutex<Option<Child>>>);

impl Own {
    /// Begins a command with the options of this one and what is typed behind them; what it says is JSON, its words in this
    /// language.
    ///
    /// # Errors
    /// No process is to be had.
    pub fn begin(global: &Global, name: &str, typed: &[OsString], lang: Lang) -> io::Result<Self> {
        let mut child = itself::command()
            .args([name, "--json", "--lang", pick(lang, "en", "zh")])
            .args(passed_on(global, name))
            .args(typed)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            // A key that ends this program does not end that one.
            .process_group(0)
            .spawn()?;
        let output = child.stdout.take();
        let handle = Handle(Arc::new(Mutex::new(Some(child))));
        let (send, ended) = channel();
        let own = handle.clone();
        std::thread::spawn(move || {
            let mut said = Vec::new();
            let read = output.map_or(Ok(0), |mut output| output.read_to_end(&mut said));
            // It has said all. While it is waited for nobody ends it: its number may be another's afterwards.
            let mut child = own.0.lock().unwrap_or_else(PoisonError::into_inner);
            let waited = child
                .take()
                .map_or(Ok(()), |mut child| child.wait().map(drop));
            drop(child);
            // Nobody waits where the panel has ended.
            let _ = send.send(read.and(waited).map(|()| said));
        });
        Ok(Self { ended, handle })
    }

    /// What it has said, once it has come to its end.
    pub fn ended(&self) -> Option<io::Result<Vec<u8>>> {
        match self.ended.try_recv() {
            Ok(said) => Some(said),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Ok(Vec::new())),
        }
    }
}

impl Handle {
    /// Of a process that a test has begun.
    #[cfg(test)]
    pub fn of(child: Child) -> Self {
        Self(Arc::new(Mutex::new(Some(child))))
    }

    /// Waits for its end.
    #[cfg(test)]
    pub fn status(&self) -> std::process::ExitStatus {
        let child = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        child.unwrap().wait().unwrap()
    }

    /// Ends it as Ctrl-C does: what has not begun does not begin.
    pub fn interrupt(&self) {
        let child = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let number = child
            .as_ref()
            .and_then(|child| i32::try_from(child.id()).ok());
        if let Some(number) = number {
            // It may just have ended.
            let _ = kill(Pid::from_raw(number), Signal::SIGINT);
        }
    }
}

/// The options that say which board it is, and how programs are read. Single block is a switch of the machine, which an
/// operator may have set since [D513]. A dry run of `retract` only shows what would move, and here it is to move.
fn passed_on(global: &Global, name: &str) -> Vec<OsString> {
    let mut options: Vec<OsString> = vec!["--bus".into(), global.bus.to_string().into()];
    let mut pair = |name: &str, value: OsString| options.extend([name.into(), value]);
    if let Some(node) = global.node {
        pair("--node", node.to_string().into());
    }
    if let Some(rate) = global.bitrate {
        pair(
            "--bitrate",
            (rate.bits_per_second() / 1_000).to_string().into(),
        );
    }
    let dialect = global
        .dialect
        .and_then(|dialect| dialect.to_possible_value());
    if let Some(dialect) = dialect {
        pair("--dialect", dialect.get_name().into());
    }
    for (name, file) in [
        ("--tools", &global.tools),
        ("--variables", &global.variables),
    ] {
        if let Some(file) = file {
            pair(name, file.into());
        }
    }
    for file in &global.params {
        pair("--params", file.into());
    }
    for value in &global.set {
        pair("--set", value.into());
    }
    for (name, is_on) in [
        ("--skip", global.skip),
        ("--optional-stop", global.optional_stop),
        ("--dry-run", global.dry_run && name != "retract"),
    ] {
        if is_on {
            options.push(name.into());
        }
    }
    options
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::cli::Cli;

    #[test]
    fn a_dry_run_is_passed_on_to_programs_and_not_to_the_way_out_of_a_hole() {
        let typed = ["leadscrew", "panel", "--dry-run", "--skip"];
        let global = Cli::try_parse_from(typed).unwrap().global;
        for (name, is_dry) in [("run", true), ("mdi", true), ("retract", false)] {
            let options = passed_on(&global, name);
            let has = |option: &str| options.iter().any(|passed| passed == option);
            assert_eq!((has("--dry-run"), has("--skip")), (is_dry, true), "{name}");
        }
    }
}
