//! Threads: axes led by the spindle's angle.
//!
//! A pass (run-in, stroke, run-out) is a pure function of the predicted spindle angle; nothing accumulates, so nothing
//! can drift, and a re-cut at another speed falls into the same groove. With `h` the travel of the exact helix since
//! the pass's start point, the long axis stands at `w(h)`:
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
//! Joining never changes the start point or the start angle: the axis leaves rest while the exact helix is still `H`
//! before the start point, and from `H` behind it on it stands on the helix. Braking is the mirror image, so the axis
//! cannot pass D's plane whatever the spindle does. The short axis is a function of `w` alone: the taper's line, the
//! run-in towards it and the run-out away from it, each with a rounded corner that its own limits allow, each reaching
//! its point exactly where the geometry says.
//!
//! `H`, `B` and the corners are planned in the background ([`ThreadPlan`]) for the faster of commanded and measured
//! speed with a margin; the tick ([`ThreadRun`]) only evaluates.

mod helix;
mod pace;
mod path;
mod plan;
mod ramp;
mod run;
mod shape;

pub use helix::Helix;
pub(super) use helix::HelixTravel;
pub use plan::ThreadPlan;
pub use run::{Phase, Retract, ThreadPoint, ThreadRun};
