//! Every public function of the core that a board runs, and of the part that all images share. Each is called once,
//! with arbitrary inputs. One function for each entry, never inlined, so that a report can name it; one file for each
//! module of the core.
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
mod offsets;
mod params;
mod program;
mod services;
mod spindle;
mod units;

/// Calls all entries.
pub fn all() {
    units::all();
    alarm::all();
    params::all();
    cycle::all();
    journal::all();
    link::all();
    motion::all();
    offsets::all();
    float::all();
    spindle::all();
    bus::all();
    services::all();
    board::all();
    app::all();
    program::all();
}
