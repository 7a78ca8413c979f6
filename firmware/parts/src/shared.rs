//! Data that two contexts share: words and rings. At any access, the other side may interrupt one side of a ring or
//! either side of a word.
//!
//! In the tests of this crate each access calls [`point`], where the other side may run. So the tests can try all orders.

use core::sync::atomic::{AtomicU32, Ordering};

use heapless::spsc::{Consumer, Producer};

#[cfg(test)]
pub(crate) use self::tested::{interrupted_by, point};

/// An access to shared data comes next.
#[cfg(not(test))]
#[inline(always)]
const fn point() {}

/// A number.
pub(crate) struct Word(AtomicU32);

impl Word {
    pub(crate) const fn new(value: u32) -> Self {
        Self(AtomicU32::new(value))
    }

    pub(crate) fn get(&self) -> u32 {
        point();
        self.0.load(Ordering::Acquire)
    }

    pub(crate) fn set(&self, value: u32) {
        point();
        self.0.store(value, Ordering::Release);
    }
}

/// The end of a ring where values go in.
pub(crate) struct In<'a, T>(pub(crate) Producer<'a, T>);

impl<T> In<'_, T> {
    /// False where there is no room.
    pub(crate) fn put(&mut self, value: T) -> bool {
        point();
        self.0.enqueue(value).is_ok()
    }

    pub(crate) fn has_room(&self) -> bool {
        point();
        self.0.ready()
    }
}

/// The end of a ring where values come out.
pub(crate) struct Out<'a, T>(pub(crate) Consumer<'a, T>);

impl<T> Out<'_, T> {
    pub(crate) fn take(&mut self) -> Option<T> {
        point();
        self.0.dequeue()
    }

    pub(crate) fn peek(&self) -> Option<&T> {
        point();
        self.0.peek()
    }

    pub(crate) fn is_empty(&self) -> bool {
        point();
        !self.0.ready()
    }
}

#[cfg(test)]
mod tested {
    extern crate std;

    use core::cell::RefCell;
    use std::rc::Rc;

    std::thread_local! {
        static INTERRUPTS: RefCell<Option<Rc<dyn Fn()>>> = const { RefCell::new(None) };
    }

    /// Sets what runs at each access from now on.
    pub(crate) fn interrupted_by(by: Option<Rc<dyn Fn()>>) {
        INTERRUPTS.set(by);
    }

    /// An access to shared data comes next.
    pub(crate) fn point() {
        let by = INTERRUPTS.with_borrow(Clone::clone);
        if let Some(by) = by {
            by();
        }
    }
}
