//! Ctrl-C, and what ends a program from elsewhere (SIGTERM, a terminal that goes away): remembered, so that the machine can
//! be brought to a controlled stop first, and the terminal given back as it was. A second one does not wait.

use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);
static DRAWING: AtomicBool = AtomicBool::new(false);

/// Starts to listen.
pub fn watch() {
    let remember = || {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            give_back();
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

/// Takes the whole terminal to draw on.
///
/// # Errors
/// It is none, or does not do that.
pub fn take_terminal() -> std::io::Result<ratatui::DefaultTerminal> {
    DRAWING.store(true, Ordering::Relaxed);
    ratatui::try_init()
}

/// Gives the terminal back as it was, where it was taken.
pub fn give_back() {
    if DRAWING.swap(false, Ordering::Relaxed) {
        // A terminal that is gone takes nothing back.
        let _ = ratatui::try_restore();
    }
}
