//! The parameter set: typed access to every number, generated from `params/*.toml`.
//!
//! A definition is written once, in those files; the build script makes of it an accessor of [`Params`], an [`Entry`]
//! (number, unit, range: what a machine needs to take or refuse a value) and its [`Text`] (what a person reads).
//! [`set`](Params::set) takes a value only in its range, [`Params::check`] refuses a set that cannot work. This room
//! knows nothing of files, buses or storage.
//!
//! X: travel, speeds, accelerations and limits are those of the slide, on the radius. Offsets are written as diameters,
//! as they are programmed, and handed out as radii.

mod check;
mod entry;
mod set;
#[cfg(test)]
mod tests;
pub mod unit;

pub use check::PROFILE_TICKS;
pub use entry::{Entry, FindError, Part, Text};
pub use set::SetError;
pub use unit::{Unit, ValueError, Writing};

use crate::units::{Acceleration, Axis, Feed, Jerk, Length};

/// A complete parameter set: every value in the smallest step of its unit, within its range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Params {
    raw: [i64; SLOTS],
}

impl Params {
    /// The built-in machine: a small slant-bed lathe (`params/machines/slant-bed.toml`).
    #[must_use]
    pub const fn slant_bed() -> Self {
        Self { raw: BUILT_IN }
    }
}

impl Default for Params {
    fn default() -> Self {
        Self::slant_bed()
    }
}

include!(concat!(env!("OUT_DIR"), "/params.rs"));
