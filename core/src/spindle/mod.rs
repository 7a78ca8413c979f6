//! Where the spindle is: the encoder's counts in, the angle at any instant out.
//!
//! Knows nothing of programs, axes or the bus. A sample comes in once a tick, with the time of the last edge where the
//! hardware captures it; what follows the spindle asks for the angle at the instant its setpoint takes effect.

mod coarse;
mod observer;
#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::arithmetic_side_effects)]
mod tests;

pub use coarse::Coarse;
pub use observer::{EncoderSample, Observer, SpindleEvent};
