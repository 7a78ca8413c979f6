//! What is wrong with the calls of a lathe program, or hardly meant, before anything moves.
//!
//! ```text
//! calls ─► Verifier ─► Findings: alarms, warnings, figures of cycles
//! ```
//!
//! A [`Verifier`] takes the calls of a program in their order, for one [`Machine`]. It expands each one and looks at
//! its geometry, its travel and its physics, and at what is plausible. What is found goes to whoever implements
//! [`Findings`]: `leadscrew check` and the page of the browser lathe.
//!
//! It must not know text, files or words of people. Nothing here is a number that a machine moves by.

mod figures;
mod hole;
mod path;
mod plausible;
mod remains;
mod threads;
mod verifier;

pub use figures::{CycleFigures, ThreadFigures};
pub use hole::Hole;
pub use path::{arc, nanometres, sweep};
pub use verifier::{Findings, Machine, Verifier};
