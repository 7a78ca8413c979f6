//! The functions that a browser, or an interpreter in a test, calls. The one file with `unsafe`: the exported names.
//!
//! The caller asks for room with `leadscrew_room`, writes a message there, calls `leadscrew_answer`, and reads as many
//! bytes at the place that it gives as `leadscrew_length` says. The module has one thread: nothing else runs in between.
//! After a trap `leadscrew_panic` says why: a panic ends the module, and its message is all that is left.

use std::cell::RefCell;
use std::sync::Once;

use crate::messages::{Session, answer};

thread_local! {
    static SESSION: RefCell<Session> = RefCell::default();
    static MESSAGE: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static PANIC: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Room for a message of `length` bytes. The first call also arranges that a panic leaves its words.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn leadscrew_room(length: usize) -> *mut u8 {
    static HOOK: Once = Once::new();
    if cfg!(target_arch = "wasm32") {
        HOOK.call_once(|| {
            std::panic::set_hook(Box::new(|info| {
                PANIC.with_borrow_mut(|words| *words = info.to_string().into_bytes());
            }));
        });
    }
    MESSAGE.with_borrow_mut(|message| {
        message.clear();
        message.resize(length, 0);
        message.as_mut_ptr()
    })
}

/// Answers the message; gives the first byte of the answer.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn leadscrew_answer() -> *const u8 {
    let said =
        MESSAGE.with_borrow(|message| SESSION.with_borrow_mut(|session| answer(session, message)));
    ANSWER.with_borrow_mut(|answer| {
        *answer = said;
        answer.as_ptr()
    })
}

/// The length of the last answer.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn leadscrew_length() -> usize {
    ANSWER.with_borrow(Vec::len)
}

/// The first byte of the words of a panic; the length is that of the answer then.
// SAFETY: no other symbol of the module has this name.
#[unsafe(no_mangle)]
pub extern "C" fn leadscrew_panic() -> *const u8 {
    let words = PANIC.with_borrow(Clone::clone);
    ANSWER.with_borrow_mut(|answer| {
        *answer = words;
        answer.as_ptr()
    })
}
