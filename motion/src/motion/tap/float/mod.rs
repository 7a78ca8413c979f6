//! Ordinary tapping: the spindle turns in speed mode, the axis follows the spindle's encoder through stop and reversal,
//! and a floating holder takes up the remaining difference between them.
//!
//! The axis is a pure function of the measured spindle angle, as in a thread ([`Law`](law::Law)). With `h` the travel
//! of the exact helix since R, inwards:
//!
//! ```text
//!   w ▲
//!   L │            ____ bottom: never passed; the last micrometres rounded
//!     │         .·'
//!     │       ╱            locked: w = h, in and out, standing and reversing
//!     │     ╱
//!   0 │ _.·'               join and leave at R: w = ease(h), from rest to rest
//!     └──┼──┼──────┼──► h
//!       −H  H      L
//! ```
//!
//! The spindle turns while the axis still stands at R, and there is no room before R for a run-in. So the axis leaves R
//! when the helix is still H above R, and the axis is on the helix from H below R on. Between these points the axis is
//! ahead of the tap's own pitch by a part of H. The holder takes up this part; if R lies H before the material, there
//! is nothing to take up [D93].
//!
//! The tap also commands the spindle. It turns the spindle from one turning point to the next: the bottom, R, and those
//! of the pecks. The commands never ask more than the spindle's ramp (9004). They follow the measured angle, so that
//! the spindle comes to rest at the right angle and not after a fixed time ([`Turner`](turner::Turner)) [D94]. The axis
//! follows the real movement of the spindle.
//!
//! This module knows angles, limits and ticks; it knows nothing of cycles' words, drives or operators.

mod course;
mod law;
mod plan;
mod run;
mod turner;

pub use course::Course;
pub use plan::{FloatPlan, float_ticks};
pub use run::{FloatPoint, FloatRun, FloatTick};

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests;
