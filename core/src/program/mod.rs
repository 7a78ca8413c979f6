//! Program text in, calls out.
//!
//! The interpreter takes blocks of `text`, resolves every modal meaning (units, offsets, increments,
//! dialect, motion, spindle) and yields [`Call`](crate::call::Call)s: linear, in machine units, each with the place it came
//! from. A block of a cycle goes to the cycle's room. Memory is bounded by one line, whatever the length of the program.
//! Knows nothing of what a cycle does with its words, nor of motion.
//!
//! [`Interpreter`] takes lines, [`Events`] iterates over a program in memory, [`Reader`] takes pieces of a stream.

mod arc;
mod carried;
mod data;
mod in_force;
mod interpreter;
mod motion;
mod reader;
mod speeds;
mod state;
#[cfg(test)]
mod tests;

pub use crate::text::{Dialect, Event, LETTER_O, LETTERS, MAX_LINE, Options, slip};
pub use arc::ARC_END_TOLERANCE;
pub use carried::{Carried, CarriedFeed};
pub use in_force::InForce;
pub use interpreter::{Interpreter, is_free_m};
pub use motion::Way;
pub use reader::{Events, Reader};
