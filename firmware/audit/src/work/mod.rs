//! The steps that are counted, the same on the emulated board and on the host (`core/examples/tick.rs`).
//!
//! A work is a sequence of steps from a state of its own; every step is one tick, or one move.

mod bus;
mod calls;
mod cycle;
mod motion;
mod spindle;

pub use bus::Commanding;
pub use cycle::{Grooves, Threads};
pub use motion::{ThreadPass, TimedMove};
pub use spindle::Tracking;

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
    /// Step `number`, from 0.
    fn step(&self, state: &mut Self::State, number: usize) -> Self::Out;
}

/// How many steps of at most `limit` there are until `is_last`.
fn until(limit: usize, mut is_last: impl FnMut(usize) -> bool) -> usize {
    (0..limit).take_while(|number| !is_last(*number)).count()
}
