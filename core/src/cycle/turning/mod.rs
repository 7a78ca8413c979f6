//! G90 and G94: one cut of a turning cycle, along Z or along X.
//!
//! A cycle is four straight moves, so its calls are lines and rapids: this room has words only.

mod words;

pub(crate) use words::{Turning, TurningWords};
