//! Program text in, calls out.
//!
//! The lexer turns bytes into words with their columns, the block collects one line's words, the interpreter resolves
//! every modal meaning (units, offsets, increments, dialect, first blocks of cycles, program flow) and yields [`Call`]s:
//! linear, in machine units, each with the place it came from. Memory is bounded by one line, whatever the length of
//! the program. Knows nothing of what a cycle does with its words, nor of motion.
//!
//! [`Interpreter`] takes lines, [`Events`] iterates over a program in memory, [`Reader`] takes pieces of a stream.

mod arc;
mod block;
mod call;
mod choice;
mod codes;
mod groove;
mod interpreter;
mod lexer;
mod modal;
mod motion;
mod options;
mod plan;
mod reader;
mod run_out;
mod scale;
mod speeds;
mod state;
mod tap;
mod tap_mode;
mod tap_notes;
mod tap_return;
mod tap_speed;
mod tapper;
#[cfg(test)]
mod tests;
mod thread;

pub use arc::ARC_END_TOLERANCE;
pub use call::*;
pub use choice::{HandChoice, Selection, SpindleChoice};
pub use interpreter::{Event, Interpreter};
pub use lexer::MAX_LINE;
pub use modal::Modal;
pub use options::{Dialect, Options};
pub use reader::{Events, Reader};
pub use tap_notes::{Extraction, LengthUnit, Plane, TapNotes};
pub use tapper::{Hand, TapSpindle};
