//! Writes a file in one step: it always holds the old bytes or the new ones.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use crate::interrupt;

/// Writes `bytes` to a file. They go to a new file next to it, which then replaces it. A link stays a link, and its target
/// is replaced.
///
/// # Errors
/// A file that cannot be written; the old one is unchanged.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    interrupt::whole(|| at_once(path, bytes, true))
}

/// The same without waiting for the disk, for a process that has a beat to keep. The bytes outlive the process, however it
/// ends, but perhaps not a loss of the computer's power.
///
/// # Errors
/// As [`replace`].
pub fn replace_soon(path: &Path, bytes: &[u8]) -> io::Result<()> {
    interrupt::whole(|| at_once(path, bytes, false))
}

fn at_once(path: &Path, bytes: &[u8], wait: bool) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let mut beside = target.clone().into_os_string();
    beside.push(format!(".new-{}", std::process::id()));
    let beside = PathBuf::from(beside);
    let written = File::create(&beside).and_then(|mut file| {
        file.write_all(bytes)?;
        if wait { file.sync_all() } else { Ok(()) }
    });
    written
        .and_then(|()| fs::rename(&beside, &target))
        .inspect_err(|_| {
            // A half-written file is of no use. A failure to remove it changes nothing.
            let _ = fs::remove_file(&beside);
        })
}
