//! Putting new bytes into a file in one step: whatever happens, there is the old file or the new one.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use crate::interrupt;

/// Puts `bytes` into a file. They go into one beside it first, which then takes its place; a link stays a link, and the
/// file behind it is replaced.
///
/// # Errors
/// A file that cannot be written; the old one is as it was.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    interrupt::whole(|| at_once(path, bytes))
}

fn at_once(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let mut beside = target.clone().into_os_string();
    beside.push(format!(".new-{}", std::process::id()));
    let beside = PathBuf::from(beside);
    let written = File::create(&beside)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()));
    written
        .and_then(|()| fs::rename(&beside, &target))
        .inspect_err(|_| {
            // What is half done is of no use; that it cannot be removed either changes nothing.
            let _ = fs::remove_file(&beside);
        })
}
