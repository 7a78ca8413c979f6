//! Taps: one master drives the tap axis and the spindle (rigid), or the axis follows the spindle's encoder (ordinary,
//! [`FloatPlan`]).
//!
//! In rigid mode the master is time: a stroke is a straight piece of the tap axis with the jerk-limited
//! [`Profile`](super::Profile), bounded by what the axis bears and by what the spindle bears times the lead. The
//! commanded spindle angle is a function of the axis setpoint of the same tick and of nothing else ([`Gear`]), so there
//! is no skew between them, and whatever stops the axis (feed hold, override, abort) stops the spindle in phase.
//!
//! A [`Tap`] is a way from R into the hole and back to R, with all its strokes: pecks that are alike are stored once, so
//! that a hole of any number of high-speed pecks is one segment, and a deep peck is one for each time the tap is in the
//! hole. The queue can run dry between two of them, never inside: what has begun has its way out. Only a hole that stays
//! locked at its bottom (K198) ends there.
//!
//! Knows strokes, limits and ticks; knows nothing of cycles' words, drives or operators.

mod float;
mod gear;
mod plan;
mod run;

pub use float::{FloatPlan, FloatPoint, FloatRun, FloatTick, float_ticks};
pub use gear::{Gear, TapLine};
pub use plan::{Stroke, TAP_STEPS, Tap, TapPart, TapStep, dwell_ticks, stroke};
pub(super) use run::TapRun;

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests;
