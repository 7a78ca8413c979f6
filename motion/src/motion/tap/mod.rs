//! Taps: one master drives the tap axis and the spindle (rigid), or the axis follows the spindle's encoder (ordinary,
//! [`FloatPlan`]).
//!
//! In rigid mode the master is time. A stroke is a straight move of the tap axis with the jerk-limited
//! [`Profile`](super::Profile). The limits of the axis bound the stroke, and so do the limits of the spindle times the
//! lead. The commanded spindle angle is a function of the axis setpoint of the same tick and of nothing else
//! ([`Gear`]). So there is no skew between axis and spindle, and anything that stops the axis (feed hold, override,
//! abort) stops the spindle in phase.
//!
//! A [`Tap`] is a way from R into the hole and back to R, with all its strokes. Equal pecks are stored once, so a hole
//! of any number of high-speed pecks is one segment. A hole of deep pecks has one segment for each time the tap is in
//! the hole. The queue can run dry between two of these segments, but never inside one: a tap that has begun always has
//! its way out. Only a hole that stays locked at its bottom (K198) ends there.
//!
//! This module knows strokes, limits and ticks; it knows nothing of cycles' words, drives or operators.

mod float;
mod gear;
mod plan;
mod run;

pub use float::{Course, FloatPlan, FloatPoint, FloatRun, FloatTick, float_ticks};
pub use gear::{Gear, TapLine};
pub use plan::{Stroke, TAP_STEPS, Tap, TapPart, TapStep, dwell_ticks, stroke};
pub(super) use plan::{ramp, rate, spindle_acceleration};
pub(super) use run::TapRun;

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests;
