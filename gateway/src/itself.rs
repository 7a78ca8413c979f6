//! This program, to be started once more in a process of its own.

use std::io;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What Linux runs here, whatever has become of its file.
const RUNNING: &str = "/proc/self/exe";

/// A command that starts this program, with no arguments yet.
#[must_use]
pub fn command() -> Command {
    command_of(std::env::current_exe())
}

/// An upgrade of the package removes the file of a program that runs, and its path is no path any more. Where there still
/// is one it is taken: the process has its name from it.
fn command_of(path: io::Result<PathBuf>) -> Command {
    let path = path.ok().filter(|path| path.exists());
    let mut command = Command::new(path.as_deref().unwrap_or(Path::new(RUNNING)));
    if path.is_none()
        && let Some(name) = std::env::args_os().next()
    {
        command.arg0(name);
    }
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_whose_file_was_replaced_starts_itself_all_the_same() {
        let there = command_of(std::env::current_exe());
        assert_eq!(there.get_program(), std::env::current_exe().unwrap());
        let gone = PathBuf::from("/usr/bin/leadscrew (deleted)");
        // The program of these tests, which lists them.
        let listed = command_of(Ok(gone)).arg("--list").output().unwrap();
        let listed = String::from_utf8(listed.stdout).unwrap();
        let own = "a_program_whose_file_was_replaced_starts_itself_all_the_same: test";
        assert!(listed.contains(own), "{listed}");
    }
}
