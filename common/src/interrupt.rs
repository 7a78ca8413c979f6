//! Ctrl-C, and signals that end a program from elsewhere (SIGTERM, a terminal that closes; not that one under `nohup`).
//!
//! A command that only reads and computes ends at once at any place: in a loop, in a read without data, before a file that
//! nobody opens. Work that must be finished first calls [`defer`]: a moving machine, a transaction with a board, a terminal
//! that is drawn on. The interruption is then only remembered, and [`requested`] returns true. A second interruption does
//! not wait. Signals that come at once are one interruption: `timeout` and service managers signal a process and then the
//! group that it belongs to.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, mpsc};
use std::time::{Duration, Instant};

use leadscrew_core::alarm::Lang;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::failure::Failure;

static REQUESTED: AtomicBool = AtomicBool::new(false);
static STATE: Mutex<State> = Mutex::new(State {
    under_way: 0,
    first: None,
    patience: None,
    last: None,
    lang: Lang::En,
    json: false,
});

/// The longest time for the last report: its reader may have stopped reading.
const LAST_WORDS: Duration = Duration::from_secs(1);
/// The longest time for finishing work without a real machine: the reader of its output may have stopped reading.
const COMPUTED: Duration = Duration::from_secs(10);

/// Signals that are no farther apart are one interruption. A person takes longer to press a key again.
const AT_ONCE: Duration = Duration::from_millis(300);

/// The state that an interruption finds.
struct State {
    /// Number of works that must be finished first.
    under_way: u32,
    /// When the first signal came.
    first: Option<Instant>,
    /// The longest time for them.
    patience: Option<Duration>,
    /// Called before the process ends: gives the terminal back.
    last: Option<fn()>,
    /// Language of the last report.
    lang: Lang,
    json: bool,
}

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts to listen. `lang` and `json` are for the last report.
pub fn watch(lang: Lang, json: bool) {
    {
        let mut state = state();
        (state.lang, state.json) = (lang, json);
    }
    let closes = [SIGHUP].into_iter().filter(|&signal| !ignores(signal));
    // Where it cannot listen, Ctrl-C keeps its usual meaning.
    let Ok(mut signals) = Signals::new(closes.chain([SIGINT, SIGTERM])) else {
        return;
    };
    std::thread::spawn(move || signals.forever().for_each(|_| hear()));
}

/// A signal has come.
fn hear() {
    let mut state = state();
    REQUESTED.store(true, Ordering::Relaxed);
    if state.under_way == 0 {
        end(&state);
    }
    if let Some(first) = state.first {
        if first.elapsed() < AT_ONCE {
            return;
        }
        end(&state);
    }
    state.first = Some(Instant::now());
    if let Some(patience) = state.patience {
        std::thread::spawn(move || {
            std::thread::sleep(patience);
            end(&self::state());
        });
    }
}

/// True where this process was begun with a signal that does nothing: under `nohup` a terminal may close.
fn ignores(signal: i32) -> bool {
    let told = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = told.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Ends the process. The state stays locked until then, so that no work begins that would be left half done.
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

/// Work that must be finished before the process ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnderWay {
    /// A real machine, or a transaction: without a limit of time.
    Machine,
    /// A simulated machine, a recording or a picture: this takes a moment, unless the reader of its output has stopped.
    Computed,
}

/// From here on an interruption is only remembered. The command checks [`requested`], finishes its work and ends.
pub fn defer(what: UnderWay) {
    let mut state = state();
    state.under_way += 1;
    state.patience = match what {
        UnderWay::Machine => None,
        UnderWay::Computed => Some(COMPUTED),
    };
}

/// Does short work that must not be left half done.
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

/// True where the user wants to end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Calls `work` before the process ends, once.
pub fn before_the_end(work: fn()) {
    state().last = Some(work);
}
