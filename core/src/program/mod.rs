//! Program text in, calls out.
//!
//! The lexer turns bytes into words with their columns, the block collects one line's words, the interpreter resolves
//! every modal meaning (units, offsets, increments, dialect, first blocks of cycles, program flow) and yields [`Call`]s:
//! linear, in machine units, each with the place it came from. Memory is bounded by one line, whatever the length of
//! the program. Knows nothing of what a cycle does with its words, nor of motion.

mod call;

pub use call::*;
