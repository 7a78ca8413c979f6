//! What is counted: rows `plan/…` for what the background does once a move or a call, `move/…` for expansion, `tick/…`
//! for one tick.

use audit::work::{Commanding, Grooves, ThreadPass, Threads, TimedMove, Tracking, Work};

use crate::count::{count, spin};

/// Counts everything.
pub fn all() {
    count("known-loop-2000", 100, || (), |(), _| spin(1000));

    let threads = Threads::o0013();
    once("plan/g76", || threads.check());
    steps("move/g76", &threads);
    let grooves = Grooves::o0008();
    once("plan/g75", || grooves.check());
    steps("move/g75", &grooves);

    let line = TimedMove::line();
    once("plan/line", || line.plan());
    steps("tick/line", &line);
    let arc = TimedMove::arc();
    once("plan/arc", || arc.plan());
    steps("tick/arc", &arc);
    let pass = ThreadPass::o0013();
    once("plan/thread", || pass.plan());
    steps("tick/thread", &pass);
    steps("tick/observer", &Tracking::at_300_rpm());
    steps("tick/drive", &Commanding::x());
}

fn once<R>(name: &str, mut what: impl FnMut() -> R) {
    count(name, 1, || (), |(), _| what());
}

fn steps<W: Work>(name: &str, work: &W) {
    count(
        name,
        work.steps(),
        || work.begin(),
        |state, number| work.step(state, number),
    );
}
