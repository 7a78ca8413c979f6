//! The tap journal: what survives a loss of power at any moment, and the way out of a hole it leads to.

mod cuts;
mod refusals;
mod ways_out;
