//! Parameter sets for tests: the built-in machine with other values.

use leadscrew_core::params::{Entry, Params};

/// The built-in machine with these raw values.
///
/// # Panics
/// Where there is no such parameter, or a value is outside its range: the values of these tests are right.
#[must_use]
pub fn with(values: &[(&str, i64)]) -> Params {
    let mut params = Params::sheets();
    for (key, raw) in values {
        set(&mut params, key, *raw);
    }
    params
}

/// Sets one of them.
///
/// # Panics
/// As [`with`].
pub fn set(params: &mut Params, key: &str, raw: i64) {
    let entry = Entry::find_text(key).expect("a parameter");
    params.set(entry, raw).expect("in its range");
}
