//! Ctrl-C, and what ends a program from elsewhere (SIGTERM, a terminal that goes away).
//!
//! A command that only reads and computes ends at once, wherever it is: in a loop, in a read that nothing comes from,
//! before a file that nobody opens. What has to be brought to an end first says so ([`defer`]): a machine that moves, a
//! transaction with a board, a terminal that is drawn on. There the wish is remembered, and [`requested`] tells it. A
//! second one does not wait.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, mpsc};
use std::time::Duration;

use leadscrew_core::alarm::Lang;

use crate::failure::Failure;

static REQUESTED: AtomicBool = AtomicBool::new(false);
static STATE: Mutex<State> = Mutex::new(State {
    under_way: 0,
    patience: None,
    last: None,
    lang: Lang::En,
    json: false,
});

/// How long the last words may take: who reads them may have stopped reading.
const LAST_WORDS: Duration = Duration::from_secs(1);
/// How long what is no real machine may take to come to its end: whoever takes its output may have stopped.
const COMPUTED: Duration = Duration::from_secs(10);

/// What an interruption finds.
struct State {
    /// How much has to be brought to an end first.
    under_way: u32,
    /// How long that may take.
    patience: Option<Duration>,
    /// What is done before the process ends: a terminal is given back.
    last: Option<fn()>,
    /// How the end is told.
    lang: Lang,
    json: bool,
}

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts to listen; `lang` and `json` are for what is told at the end.
pub fn watch(lang: Lang, json: bool) {
    let mut state = state();
    (state.lang, state.json) = (lang, json);
    let hear = || {
        let state = self::state();
        let second = REQUESTED.swap(true, Ordering::Relaxed);
        if state.under_way == 0 || second {
            end(&state);
        }
        if let Some(patience) = state.patience {
            std::thread::spawn(move || {
                std::thread::sleep(patience);
                end(&self::state());
            });
        }
    };
    // Where no handler can be set, Ctrl-C keeps its usual meaning.
    let _ = ctrlc::set_handler(hear);
}

/// Ends the process. The state is held until then: nothing begins any more that would be left half done.
fn end(state: &State) -> ! {
    let (last, lang, json) = (state.last, state.lang, state.json);
    let (told, done) = mpsc::channel();
    std::thread::spawn(move || {
        if let Some(last) = last {
            last();
        }
        Failure::Ended.report_last(lang, json);
        let _ = told.send(());
    });
    let _ = done.recv_timeout(LAST_WORDS);
    std::process::exit(i32::from(Failure::INTERRUPTED))
}

/// What has to be brought to an end before the process may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnderWay {
    /// A real machine, or a transaction: it takes the time it takes.
    Machine,
    /// A simulated machine, a recording or a picture: it takes a moment, unless nobody takes what it writes.
    Computed,
}

/// From here on an interruption is only remembered; the command looks for it with [`requested`], brings what is under way
/// to its end, and ends.
pub fn defer(what: UnderWay) {
    let mut state = state();
    state.under_way += 1;
    state.patience = match what {
        UnderWay::Machine => None,
        UnderWay::Computed => Some(COMPUTED),
    };
}

/// Does something that may not be left half done and takes a moment.
pub fn whole<T>(work: impl FnOnce() -> T) -> T {
    state().under_way += 1;
    let done = work();
    let mut state = state();
    state.under_way -= 1;
    if state.under_way == 0 && requested() {
        end(&state);
    }
    done
}

/// The user wants to end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Has this done before the process ends, once.
pub fn before_the_end(work: fn()) {
    state().last = Some(work);
}
