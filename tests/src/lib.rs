//! Whole-system tests; the tests themselves are in `tests/`.

pub mod machine;
