//! The steps that are counted, the same on the emulated board and on the host (`tests/examples/tick.rs`).
//!
//! A work is a sequence of steps from a state of its own; every step is one tick, or one move.

mod board;
mod bus;
mod calls;
mod cycle;
mod motion;
mod spindle;

use board::WholeBoard;
use bus::Commanding;
use cycle::{Grooves, Threads};
use motion::{ThreadPass, TimedMove};
use spindle::Tracking;

/// A sequence of steps.
pub trait Work {
    /// What the steps go on from.
    type State;
    /// What a step gives.
    type Out;

    /// How many steps there are.
    fn steps(&self) -> usize;

    /// The state before the first step.
    fn begin(&self) -> Self::State;

    /// What has to happen before step `number` and is not counted.
    fn prepare(&self, _state: &mut Self::State, _number: usize) {}

    /// Step `number`, from 0.
    fn step(&self, state: &mut Self::State, number: usize) -> Self::Out;

    /// What has to happen after a step and is not counted.
    fn finish(&self, _state: &mut Self::State, _out: &Self::Out) {}

    /// Kinds of steps that are told apart; what is added to the name of each.
    fn kinds(&self) -> &'static [&'static str] {
        &[""]
    }

    /// Which kind the step was that led to this state, as an index into [`Work::kinds`]; not counted.
    fn kind(&self, _state: &Self::State) -> usize {
        0
    }
}

/// Who counts.
pub trait Counter {
    /// Counts every step of a work.
    fn steps<W: Work>(&mut self, name: &str, work: &W);
    /// Counts something that happens once.
    fn once<R>(&mut self, name: &str, what: impl FnMut() -> R);
}

/// Everything that is counted: `plan/…` is what the background does once a call or a move, `move/…` a move of an
/// expansion, `tick/…` a part of a tick, `board/…` a whole one.
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

    for program in [
        board::MOVES,
        board::SEVEN_DRIVES,
        board::ORDINARY_TAP,
        board::TAPS,
        board::DEEP_TAP,
        board::STOP_IN_THREAD,
        board::STOP_IN_TAP,
    ] {
        counter.steps("board", &WholeBoard::new(program));
    }
}

/// How many steps of at most `limit` there are until `is_last`.
fn until(limit: usize, mut is_last: impl FnMut(usize) -> bool) -> usize {
    (0..limit).take_while(|number| !is_last(*number)).count()
}
