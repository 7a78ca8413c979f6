//! G76, G78, G92 and G32: threads ([G76 sheet], [G78 sheet]).
//!
//! `words` reads the words of G76 and G78, `single` those of G92, `stroke` those of G32, `run_out` what J and K leave out.
//! `refuse` has what geometry forbids. `depth` divides the height into passes; `shape`, `slope` and `taper` place a pass;
//! `helix` gives its start angle, `pickup` that of a groove which is there; `moves` makes the moves. `feasible` asks what
//! the machine can do at the commanded speed.

mod depth;
mod feasible;
mod helix;
mod moves;
mod pickup;
mod refuse;
mod run_out;
mod settle;
mod shape;
mod single;
mod slope;
mod stroke;
mod taper;
mod words;

pub use feasible::{
    FINDINGS, ThreadFindings, ThreadReport, chain_report, chain_rpm_max, rpm_max, thread_can_run,
    thread_findings, thread_report,
};
pub use moves::{ThreadMoves, ThreadSummary};
pub(crate) use stroke::Stroked;
pub(crate) use words::{ThreadWords, TwoBlock};
