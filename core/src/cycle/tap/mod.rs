//! G84, G88 and G30 P99: tapping, rigid and with a floating holder, and the way out of a hole ([G84/G88 sheet]).
//!
//! `words` reads the cycle's words, kept from hole to hole; `mode` says when rigid mode begins and ends, and what may stand
//! around it; `speed` settles spindle speed, lead and extraction. `refuse` has what geometry forbids, `feasible` what the
//! machine cannot do, `moves` the moves of the holes. `return_words` and `way_out` are the words and the move of G30 P99.

mod feasible;
mod join;
mod mode;
mod moves;
mod refuse;
mod return_words;
mod speed;
mod way_out;
mod words;

pub use feasible::{TapReport, tap_report, tap_return, tap_spindle};
pub(crate) use feasible::{tap_can_begin, tap_strokes};
pub use join::TapJoin;
pub(crate) use mode::{TapPart, Tapping, orientation, rigid_code};
pub use moves::TapMoves;
pub(crate) use refuse::refuse_tap;
pub(crate) use return_words::is_tap_return;
pub(super) use way_out::way_out;
