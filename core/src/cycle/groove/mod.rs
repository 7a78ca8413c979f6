//! G75: grooves ([G75 sheet]).
//!
//! `words` reads the words, `refuse` has what geometry forbids, `moves` the moves; `count` counts infeeds and columns
//! without making their moves, and `feasible` asks for their travel and time.

mod count;
mod feasible;
mod moves;
mod refuse;
mod words;

pub use count::GrooveCount;
pub use feasible::groove_warning;
pub(super) use feasible::{groove_clear_of_zones, groove_time, groove_within_limits};
pub use moves::GrooveMoves;
pub(super) use refuse::refuse_groove;
pub(crate) use words::GrooveWords;
