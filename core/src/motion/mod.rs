//! Segments in, setpoints out, one for each tick.
//!
//! All motion is one idea: a path parameter driven by a master, which is time or, for threads, the spindle's angle
//! ([`ThreadPlan`], [`ThreadRun`]); a tap's spindle is geared to an axis that time drives ([`Tap`]).
//! Where it is time, [`plan`] makes a move into a [`Path`], a speed and a ramp in the background; in
//! the tick the [`Profile`] turns the rate the operator and the spindle leave into a distance,
//! jerk-limited, and the path turns the distance into a position. Feed hold, override and abort are
//! rates; nothing is replanned for them. The tick is integers, constant work and no division.
//!
//! Knows nothing of program text, cycles' insides or the bus.

mod arc;
mod ease;
mod executor;
mod lead;
mod limits;
mod line;
mod path;
pub mod plan;
mod profile;
mod rate;
mod run;
mod segment;
mod shape;
mod tap;
mod thread;
mod wide;

pub use arc::{ARC_TOLERANCE, Arc, ArcError};
pub use executor::{Arrival, Conditions, Executor, Law, Motion, Setpoint};
pub use limits::{Limits, Pace};
pub use line::Line;
pub use path::Path;
pub use plan::Timed;
pub use profile::{CAPACITY, Profile, Progress, Ramp};
pub use rate::{PathRate, Rate, Travel};
pub use run::{Run, Step};
pub use segment::{Action, Cut, Epoch, Pass, Plan, Segment, Stops, Task, WaysOut};
pub use tap::{FloatPlan, FloatPoint, FloatRun, FloatTick, float_ticks};
pub use tap::{Gear, Stroke, TAP_STEPS, Tap, TapLine, TapPart, TapStep, dwell_ticks, stroke};
pub use thread::{Helix, Phase, Retract, ThreadPlan, ThreadPoint, ThreadRun};
