//! Standard output: results, for people or for programs. It remembers whether anything was written, so that `--json` gives
//! its one result also where a command ends before it has one.

use std::io::{self, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::failure::{Failure, Outcome};
use crate::json::Json;

/// One flag for the process: there is one standard output.
static WRITTEN: AtomicBool = AtomicBool::new(false);
/// The holder of the lock writes.
static TURN: Mutex<()> = Mutex::new(());

/// Writes a result to standard output. Where its reader is gone (`| head`), nothing is written: the exit code still tells
/// how the command ends.
///
/// # Errors
/// Standard output that cannot be written.
pub fn write(bytes: &[u8]) -> Outcome {
    match part(bytes) {
        Err(Failure::ReaderGone) => Ok(()),
        written => written,
    }
}

/// Writes a part of what has no end, or a far one, to standard output: nobody needs the rest where its reader is gone.
///
/// # Errors
/// Standard output that cannot be written, or whose reader is gone.
pub fn part(bytes: &[u8]) -> Outcome {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    put(bytes)
}

/// Writes one object as a line if nothing has been written yet. Nothing can be written after it.
pub fn last_json(fill: impl FnOnce(&mut Json)) {
    let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    if !is_written() {
        // Nobody is left to be told of a failure.
        let _ = put(&line(fill));
    }
    std::mem::forget(turn);
}

fn put(bytes: &[u8]) -> Outcome {
    WRITTEN.store(true, Ordering::Relaxed);
    let mut to = io::stdout().lock();
    let written = to.write_all(bytes).and_then(|()| to.flush());
    written.map_err(|error| Failure::stdout(&error))
}

/// Writes one object as a line.
///
/// # Errors
/// As [`write()`].
pub fn json(fill: impl FnOnce(&mut Json)) -> Outcome {
    write(&line(fill))
}

/// One object as a line.
#[must_use]
pub fn line(fill: impl FnOnce(&mut Json)) -> Vec<u8> {
    let mut json = Json::new();
    json.object(fill);
    let mut bytes = json.into_bytes();
    bytes.push(b'\n');
    bytes
}

/// True where something has been written.
#[must_use]
pub fn is_written() -> bool {
    WRITTEN.load(Ordering::Relaxed)
}
