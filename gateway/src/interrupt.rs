//! Ctrl-C: remembered, so that the machine can be brought to a controlled stop first. A second one does not wait.

use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Starts to listen.
pub fn watch() {
    let remember = || {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    // Where no handler can be set, Ctrl-C keeps its usual meaning.
    let _ = ctrlc::set_handler(remember);
}

/// The user wants to end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
