//! A lathe in a browser tab: language, board and plant behind one function that takes a message and gives an answer.
//!
//! Messages and answers are JSON, the same that a server could carry. Knows no file, no socket and no clock: the page says
//! how many ticks go by.

#![forbid(unsafe_op_in_unsafe_fn)]

mod boundary;
mod examples;
mod machine;
mod messages;
mod program;
mod thread;

pub use examples::{FOLDERS, Folder};
pub use messages::{Session, answer};
