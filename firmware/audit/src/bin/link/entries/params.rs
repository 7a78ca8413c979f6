//! The parameter set.

use audit::any::{any, sink};
use leadscrew_core::params::{Entry, Params};

/// Calls all entries of this module.
pub fn all() {
    set_and_get();
    check();
}

#[inline(never)]
fn set_and_get() {
    let params: Params = any();
    for entry in Entry::all() {
        sink((params.get(entry), entry.allows(any())));
    }
    sink(Entry::find(any(), None).is_ok());
}

#[inline(never)]
fn check() {
    let params: Params = any();
    params.check(sink);
    sink(params.validate().is_ok());
}
