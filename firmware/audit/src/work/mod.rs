//! The steps that are counted, the same on the emulated board and on the host (`tests/examples/tick.rs`).
//!
//! A work is a sequence of steps with a state of its own. Every step is one tick, or one move.

mod anew;
mod board;
mod bus;
mod calls;
mod cycle;
mod motion;
mod spindle;

use anew::BeginAnew;
use board::WholeBoard;
use bus::Commanding;
use cycle::{Grooves, Threads};
use motion::{ThreadPass, TimedMove};
use spindle::Tracking;

/// A sequence of steps.
pub trait Work {
    /// The state between the steps.
    type State;
    /// The result of a step.
    type Out;

    /// The number of steps.
    fn steps(&self) -> usize;

    /// The state before the first step.
    fn begin(&self) -> Self::State;

    /// Prepares step `number`; not counted.
    fn prepare(&self, _state: &mut Self::State, _number: usize) {}

    /// Step `number`, from 0.
    fn step(&self, state: &mut Self::State, number: usize) -> Self::Out;

    /// Does the work after a step; not counted.
    fn finish(&self, _state: &mut Self::State, _out: &Self::Out) {}

    /// The kinds of steps; each is appended to the name.
    fn kinds(&self) -> &'static [&'static str] {
        &[""]
    }

    /// The kind of the step that led to this state, as an index into [`Work::kinds`]; not counted.
    fn kind(&self, _state: &Self::State) -> usize {
        0
    }
}

/// Counts the steps.
pub trait Counter {
    /// Counts every step of a work.
    fn steps<W: Work>(&mut self, name: &str, work: &W);
    /// Counts something that happens once.
    fn once<R>(&mut self, name: &str, what: impl FnMut() -> R);
}

/// Counts everything: `plan/…` is the background's work for a call or a move, `move/…` a move of an expansion, `tick/…`
/// a part of a tick, `board/…` a whole tick.
pub fn all(counter: &mut impl Counter) {
    let threads = Threads::o0013();
    counter.once("plan/g76", || threads.check());
    counter.steps("move/g76", &threads);
    let grooves = Grooves::o0008();
    counter.once("plan/g75", || grooves.check());
    counter.steps("move/g75", &grooves);

    let line = TimedMove::line();
    counter.once("plan/line", || line.plan());
    counter.steps("tick/line", &line);
    let arc = TimedMove::arc();
    counter.once("plan/arc", || arc.plan());
    counter.steps("tick/arc", &arc);
    let pass = ThreadPass::o0013();
    counter.once("plan/thread", || pass.plan());
    counter.steps("tick/thread", &pass);
    counter.steps("tick/observer", &Tracking::at_300_rpm());
    counter.steps("tick/drive", &Commanding::x());
    counter.steps("tick/begin-anew", &BeginAnew::new());

    for program in [
        board::MOVES,
        board::SEVEN_DRIVES,
        board::LAGS,
        board::LAGS_FORWARD,
        board::LEARNED,
        board::ORDINARY_TAP,
        board::TAPS,
        board::DEEP_TAP,
        board::SURFACE,
        board::JOINED,
        board::STOP_IN_THREAD,
        board::STOP_IN_TAP,
    ] {
        counter.steps("board", &WholeBoard::new(program));
    }
}

/// The number of steps until `is_last`, `limit` at most.
fn until(limit: usize, mut is_last: impl FnMut(usize) -> bool) -> usize {
    (0..limit).take_while(|number| !is_last(*number)).count()
}
