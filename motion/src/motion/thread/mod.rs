//! Threading passes: the spindle's angle leads the axes.
//!
//! The setpoint of a pass (run-in, stroke, run-out) is a pure function of the predicted spindle angle. Nothing
//! accumulates, so nothing can drift, and a re-cut at another speed falls into the same groove. With `h` the travel of
//! the exact helix since the pass's start point, the long axis stands at `w(h)`:
//!
//! ```text
//!   w ▲                      ____ D's plane
//!     │                   .·'        brake: w = L − ease(L − h), at rest exactly in the plane
//!     │                ╱
//!     │             ╱                locked: w = h
//!     │          ╱
//!     │ ____.·'                      join:  w = ease(h)
//!     └──────┼──────────────────► h
//!        −H  0  H          L−B   L+B
//! ```
//!
//! Joining never changes the start point or the start angle. The axis leaves rest while the exact helix is still `H`
//! before the start point; from `H` after the start point on, the axis stands on the helix. Braking is the mirror
//! image, so the axis cannot pass D's plane, whatever the spindle does. The short axis is a function of `w` alone: the
//! taper's line, the run-in towards this line and the run-out away from it. Run-in and run-out each have a rounded
//! corner that the short axis' limits allow, and each reaches its point exactly where the geometry says.
//!
//! Strokes of G32 that follow each other without a stop are one thread: `chain` makes a plan for each of them, and a plan
//! takes over from the one before it where both are the same straight line. The corner between them is an ease as well, of
//! both axes and of the travel itself.
//!
//! The helix of G34 has a lead that changes; then `h` is the law of `variable`, and everything above it stays.
//!
//! Where the encoder has few counts, the angle is learned, and the axes go after it by a follower; what this takes of the
//! limits is in `swing`.
//!
//! The background plans `H`, `B` and the corners ([`ThreadPlan`]) for the faster of commanded and measured speed, with
//! a margin. The tick ([`ThreadRun`]) only evaluates the plan.

mod chain;
mod change;
mod helix;
mod pace;
mod path;
mod plan;
mod ramp;
mod run;
mod shape;
mod swing;
#[cfg(test)]
mod tests;
mod variable;

pub use chain::Chain;
pub use helix::Helix;
pub(super) use helix::HelixTravel;
pub use plan::ThreadPlan;
pub use run::{Phase, Retract, ThreadPoint, ThreadRun};
