//! From the encoder's counts to the angle of the spindle at any instant.
//!
//! A sample comes in once a tick, with the time of the last edge if the hardware captures that time. A motion that
//! follows the spindle asks for the angle at the instant at which its setpoint takes effect. This module knows nothing
//! of programs, axes or the bus.

mod learner;
mod looks;
mod observer;
mod resolution;
#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::arithmetic_side_effects)]
mod tests;

pub use leadscrew_spindle::{Differences, Follower, Limits, Prediction, Tracker};
pub use learner::Learner;
pub use observer::{EncoderSample, Observer, SpindleEvent};
pub use resolution::Resolution;
