//! Values that belong to one context.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, Ordering};

/// A value in its place from the beginning, to be had once: nothing large is ever built on the stack.
pub struct Once<T> {
    taken: AtomicBool,
    value: UnsafeCell<T>,
}

// SAFETY: whoever takes it first has it alone ([`Once::take`]).
unsafe impl<T: Send> Sync for Once<T> {}

impl<T> Once<T> {
    /// With this value.
    pub const fn new(value: T) -> Self {
        Self {
            taken: AtomicBool::new(false),
            value: UnsafeCell::new(value),
        }
    }

    /// The value.
    ///
    /// # Panics
    /// The second time.
    #[expect(clippy::mut_from_ref, reason = "it is given away once")]
    pub fn take(&'static self) -> &'static mut T {
        first(&self.taken);
        // SAFETY: only the first gets this far.
        unsafe { &mut *self.value.get() }
    }
}

/// Goes on the first time.
#[inline(never)]
fn first(taken: &AtomicBool) {
    assert!(!taken.swap(true, Ordering::AcqRel), "it starts once");
}

impl<T> Once<MaybeUninit<T>> {
    /// Puts the value in.
    ///
    /// # Panics
    /// The second time.
    pub fn put(&'static self, value: T) -> &'static mut T {
        self.take().write(value)
    }
}

/// A place for a value that one interrupt uses, and nobody else. It is filled before that interrupt is enabled.
pub struct Owned<T> {
    /// All bits zero while it is empty: nothing of it is in the flash.
    filled: AtomicBool,
    value: UnsafeCell<MaybeUninit<T>>,
}

// SAFETY: the value moves to its interrupt once, before it runs ([`Owned::fill`]), and only that interrupt has it then
// ([`Owned::with`]): it is used from one context at a time.
unsafe impl<T: Send> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// Nothing is in it.
    pub const fn empty() -> Self {
        Self {
            filled: AtomicBool::new(false),
            value: UnsafeCell::new(MaybeUninit::uninit()),
        }
    }

    /// Puts the value in, once.
    ///
    /// # Safety
    /// The interrupt that uses it has not been enabled yet.
    pub unsafe fn fill(&self, value: T) {
        // SAFETY: nobody else looks at it before its interrupt is enabled.
        unsafe { (*self.value.get()).write(value) };
        self.filled.store(true, Ordering::Release);
    }

    /// Uses the value, if there is one.
    ///
    /// # Safety
    /// Only from its interrupt, which does not interrupt itself, and not from within `f`.
    pub unsafe fn with(&self, f: impl FnOnce(&mut T)) {
        if self.filled.load(Ordering::Acquire) {
            // SAFETY: it has been filled, and its interrupt is the only one that calls this.
            f(unsafe { (*self.value.get()).assume_init_mut() });
        }
    }
}
