//! Whole-system tests; the tests themselves are in `tests/`.
