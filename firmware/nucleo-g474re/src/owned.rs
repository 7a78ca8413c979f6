//! Values that belong to one context.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, Ordering};

/// A static value that can be taken once: so nothing large is ever built on the stack.
pub struct Once<T> {
    taken: AtomicBool,
    value: UnsafeCell<T>,
}

// SAFETY: the first caller that takes the value has it alone ([`Once::take`]).
unsafe impl<T: Send> Sync for Once<T> {}

impl<T> Once<T> {
    /// Holds this value.
    pub const fn new(value: T) -> Self {
        Self {
            taken: AtomicBool::new(false),
            value: UnsafeCell::new(value),
        }
    }

    /// Takes the value.
    ///
    /// # Panics
    /// At the second call.
    #[expect(clippy::mut_from_ref, reason = "it is given away once")]
    pub fn take(&'static self) -> &'static mut T {
        first(&self.taken);
        // SAFETY: only the first caller gets this far.
        unsafe { &mut *self.value.get() }
    }
}

/// Returns at the first call only.
#[inline(never)]
fn first(taken: &AtomicBool) {
    assert!(!taken.swap(true, Ordering::AcqRel), "it starts once");
}

impl<T> Once<MaybeUninit<T>> {
    /// Puts the value in.
    ///
    /// # Panics
    /// At the second call.
    pub fn put(&'static self, value: T) -> &'static mut T {
        self.take().write(value)
    }
}

/// A place for a value that only one interrupt uses. It is filled before this interrupt is enabled.
pub struct Owned<T> {
    /// All bits are zero while it is empty: so nothing of it is in the flash.
    filled: AtomicBool,
    value: UnsafeCell<MaybeUninit<T>>,
}

// SAFETY: the value moves to its interrupt once, before the interrupt runs ([`Owned::fill`]). After that only this
// interrupt uses it ([`Owned::with`]): one context at a time.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// An empty place.
    pub const fn empty() -> Self {
        Self {
            filled: AtomicBool::new(false),
            value: UnsafeCell::new(MaybeUninit::uninit()),
        }
    }

    /// Puts the value in, once.
    ///
    /// # Safety
    /// The interrupt that uses the value is not enabled yet.
    pub unsafe fn fill(&self, value: T) {
        // SAFETY: nothing else uses the value before its interrupt is enabled.
        unsafe { (*self.value.get()).write(value) };
        self.filled.store(true, Ordering::Release);
    }

    /// Uses the value, if there is one.
    ///
    /// # Safety
    /// Called from the value's interrupt only, which does not interrupt itself, and not from within `f`.
    pub unsafe fn with(&self, f: impl FnOnce(&mut T)) {
        if self.filled.load(Ordering::Acquire) {
            // SAFETY: the value was filled in, and its interrupt is the only caller.
            f(unsafe { (*self.value.get()).assume_init_mut() });
        }
    }
}
