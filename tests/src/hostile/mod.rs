//! Input of any content: the conditions that must always hold. One file for each input; each takes bytes and panics where a
//! condition does not hold. The fuzzers in `fuzz/` call these functions, and the ordinary tests replay their corpora
//! through them.

mod device;
mod language;
mod link;
mod machine;
mod parameters;
mod program;
mod sdo;
mod slcan;
mod staging;
mod stored;

pub use device::device;
pub use language::language;
pub use link::link;
pub use machine::machine;
pub use parameters::parameters;
pub use program::program;
pub use sdo::sdo;
pub use slcan::slcan;
pub use staging::staging;
pub use stored::stored;
