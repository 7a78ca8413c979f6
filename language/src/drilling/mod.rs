//! Drilling on the turning centre line and on the side: G83 and G87, and G81, G82, G85, G89 of FANUC B, C and Haas.
//!
//! `hole` makes the moves of one hole; `words` reads the words and keeps them from hole to hole. A drill does not follow
//! the spindle, so these cycles become lines and rapids where the text is. The module must not know the interpreter.

mod hole;
#[cfg(test)]
mod tests;
mod words;

pub use hole::{Hole, Step};
pub use words::{Drill, Kind, Level, Parts};
