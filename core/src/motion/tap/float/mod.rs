//! Ordinary tapping: the spindle turns in speed mode, the axis follows its encoder through stop and reversal, and a
//! floating holder takes what is left between them.
//!
//! The axis is a pure function of the measured spindle angle, as in a thread ([`Law`](law::Law)): with `h` the travel of
//! the exact helix since R, inwards,
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
//! The spindle turns while the axis still stands at R, and nothing lies behind R to run in from. So the axis leaves R when
//! the helix is still H above it and is on it H below: there the axis is ahead of the tap's own pitch by a part of H, which
//! the holder takes, or nothing at all where R is H before the material [D93].
//!
//! Who turns the spindle is the tap as well: it goes from one turning point to the next (the bottom, R, and those of the
//! pecks) with commands that never ask more than the spindle's ramp (9004) and that follow the measured angle, so that it
//! comes to rest where it should and not after a time ([`Turner`](turner::Turner)) [D94]. The axis follows what the spindle
//! really does.
//!
//! Knows angles, limits and ticks; knows nothing of cycles' words, drives or operators.

mod course;
mod law;
mod plan;
mod run;
mod turner;

pub use plan::{FloatPlan, float_ticks};
pub use run::{FloatPoint, FloatRun, FloatTick};

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests;
