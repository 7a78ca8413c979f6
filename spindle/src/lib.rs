//! The angle of a spindle whose encoder has few counts.
//!
//! A pass on the lead follows the spindle's angle. With few counts, or with counts whose edges have no times, the
//! encoder tells it seldom or coarsely. What is here makes an angle of that which an axis can follow:
//!
//! ```text
//! looks ─► Tracker (mean angle, speed, acceleration; swings that are learned) ─► Follower (within limits) ─► angle
//! ```
//!
//! [`Gains`] and [`exp_of_minus`] serve the quick observer too. Angles are turns in 2⁻³² and 2⁻⁴⁸, times are ticks.
//! This crate knows no units of a machine, no axes and no programs. It is a crate of its own because it is built for
//! size: it runs for encoders of few counts alone, whose ticks have room.

#![no_std]

mod follower;
mod looks;
mod tracker;
mod wave;

pub use follower::{Follower, Limits};
pub use looks::{Gains, exp_of_minus};
pub use tracker::{Look, Prediction, Tracker};
pub use wave::Differences;
