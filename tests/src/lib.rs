//! Whole-system tests; the tests themselves are in `tests/`.

pub mod bench;
pub mod gateway;
pub mod hostile;
pub mod hour;
pub mod limits;
pub mod long_program;
pub mod machine;
pub mod params;
pub mod random;
pub mod soak;
pub mod stream;
mod transfer;
pub mod typed_page;
pub mod watch;
