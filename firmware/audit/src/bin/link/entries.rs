//! Every public entry of the core that a board runs, each once, each with inputs that nobody knows. One function an
//! entry, never inlined, so that a report can name it.

use audit::any::{any, sink};
use leadscrew_core::{program, units};

/// Calls them all.
pub fn all() {
    lead();
    feed();
    start_angle();
}

#[inline(never)]
fn lead() {
    if let Some(lead) = units::Lead::new(any(), any()) {
        sink((lead.numerator(), lead.denominator(), lead.rounded()));
    }
}

#[inline(never)]
fn feed() {
    sink(any::<program::FeedRate>().nominal());
}

#[inline(never)]
fn start_angle() {
    sink(program::start_angle(any(), any()).turns());
}
