//! Every public entry of the core that a board runs, and of what its images have in common, each once, each with inputs
//! that nobody knows. One function an entry, never inlined, so that a report can name it; one file a room of the core.
//!
//! Text for people (`Display`, the templates of alarms) is not made on a board and is not here.

mod alarm;
mod app;
mod board;
mod bus;
mod cycle;
mod float;
mod journal;
mod link;
mod motion;
mod params;
mod program;
mod services;
mod spindle;
mod units;

/// Calls them all.
pub fn all() {
    units::all();
    alarm::all();
    params::all();
    cycle::all();
    journal::all();
    link::all();
    motion::all();
    float::all();
    spindle::all();
    bus::all();
    services::all();
    board::all();
    app::all();
    program::all();
}
