//! From planned segments to setpoints, one setpoint per tick.
//!
//! All motion follows one principle: a master drives a path parameter. The master is time or, for threads, the
//! spindle's angle ([`ThreadPlan`], [`ThreadRun`]). In a rigid tap time drives the axis, and the spindle is geared to
//! the axis ([`Tap`]).
//!
//! For a move driven by time, [`plan`] makes a [`Path`], a speed and a ramp in the background. In the tick the
//! [`Profile`] turns the rate from operator and spindle into a jerk-limited distance, and the path turns this distance
//! into a position. Feed hold, override and abort are rates; they need no new plan. The tick is constant work on
//! integers, without a division.
//!
//! Cuts that follow one another under G64 are joined: the look-ahead of the background plans how fast each corner is
//! passed, the profile goes on from one path to the next, and two means round the corner.
//!
//! This module knows nothing of program text, the insides of cycles, or the bus.

mod arc;
mod ease;
mod executor;
mod flow;
mod jog;
mod lead;
mod limits;
mod line;
mod path;
pub mod plan;
mod profile;
mod rate;
mod rounding;
mod run;
mod segment;
mod shape;
mod tap;
mod thread;
mod turn;
mod wide;

pub use arc::{ARC_TOLERANCE, Arc, ArcError, Bend};
pub use executor::{Arrival, Aside, Conditions, Executor, Law, Motion, Setpoint, programmed};
pub use flow::{CUTS_AHEAD, STRETCHES_OF_A_CUT, Stretch};
pub use jog::{AxisPress, AxisTravel, Jog, JogConditions, Press, Wheel};
pub use lead::turns_over;
pub use limits::{Corner, Limits, Pace, PathLimits};
pub use line::Line;
pub use path::{Heading, Path};
pub use plan::{Scaling, Timed};
pub use profile::{CAPACITY, Profile, Progress, Ramp, to_units};
pub use rate::{PathRate, Rate, Travel};
pub use rounding::Mean;
pub use run::{Run, Step};
pub use segment::{Action, Cut, Epoch, Pass, Plan, Segment, Stops, Task, WaysOut};
pub use tap::{Course, FloatPlan, FloatPoint, FloatRun, FloatTick, float_ticks};
pub use tap::{Gear, Stroke, TAP_STEPS, Tap, TapLine, TapPart, TapStep, dwell_ticks, stroke};
pub use thread::{Chain, Helix, Phase, Retract, ThreadPlan, ThreadPoint, ThreadRun};
pub use turn::Orientation;
