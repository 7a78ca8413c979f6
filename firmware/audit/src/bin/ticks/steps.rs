//! What is counted.

use crate::count::{count, spin};

/// Counts everything.
pub fn all() {
    count("known-loop-2000", 100, || (), |(), _| spin(1000));
}
