//! Bytes to blocks, and what stays in force from block to block.
//!
//! The lexer turns bytes into words with their columns. The [`Block`] collects the words of one block and refuses what is
//! wrong whatever the words mean. [`Scale`] turns the number of a word into a quantity. [`Modal`] holds what earlier
//! blocks have set and every word is read by: units, coordinate systems, feed, spindle speed. [`Plan`] takes up the
//! actions of a block in the order in which the machine does them.
//!
//! Every cycle reads its words with these. The module knows no cycle, no motion and no program flow.

mod block;
mod codes;
mod lexer;
mod modal;
mod options;
mod plan;
mod scale;

pub(crate) use block::{Block, Letters, Word, g_arg};
pub(crate) use codes::{Group, Known, MGroup, is_machine_code, m_code};
pub(crate) use lexer::{Comment, Cursor, Ended};
pub(crate) use modal::{AXES, Modal, ModalFeed, PLANE_AXES, out_of_range};
pub(crate) use plan::Plan;
pub(crate) use scale::{Range, Scale, seconds};

pub use lexer::{LETTER_O, LETTERS, MAX_LINE, slip};
pub use options::{Dialect, Options};
pub use plan::Event;
