//! Machine functions of machine files in words: names of inputs and outputs, and what an M code does to them.
//!
//! ```toml
//! [io.coolant]
//! at = "output:1"          # or "pin:PB11", or "401:5:out0" at the block of inputs and outputs with node 5
//! reset_off = true         # an input instead: invert = true
//! [m.8]
//! set = "coolant"          # or clear; pulse = "200 ms" beside set
//! answer = "flow=1"
//! within = "2 s"
//! when = "before"          # or "after": after the motion
//! ```
//!
//! A table becomes the row of its M code (9401 to 9416), a name the number of its contact. Boards keep the numbers alone,
//! so names end here.

mod place;
mod read;
#[cfg(test)]
mod tests;
mod write;

use std::fmt;
use std::ops::Range;

use leadscrew_core::params::{Contact, Entry, Params, ROWS};

pub use place::Side;
pub(super) use read::{apply, contact_number, names};
pub use write::words;
pub(super) use write::{Rewritten, line, rewritten};

/// The key of the names.
pub(super) const IO: &str = "io";

/// The key of the tables of M codes.
pub(super) const M: &str = "m";

/// The number of the first row.
const FIRST_ROW: u16 = 9401;

/// 9421, 9422, 9461 and 9463.
const INVERTED: u16 = 9421;
const RESET_OFF: u16 = 9422;
const BLOCK_NODE: u16 = 9461;
const SAFE: u16 = 9463;

/// An input or output of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Io {
    /// Which of the two.
    pub side: Side,
    /// Its number.
    pub contact: Contact,
}

impl fmt::Display for Io {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.side.name(), self.contact.number())
    }
}

/// A name of one, which a file gives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// The name.
    pub name: String,
    /// What it names.
    pub io: Io,
}

/// The table of an M code in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Table {
    /// The row that it has got, from 1.
    row: u8,
    /// The file names the row.
    pinned: bool,
    /// The bytes of its key in the file.
    key: Range<usize>,
    /// The bytes of its value: of all of it where it is written within braces.
    value: Range<usize>,
    /// Where each of its values begins.
    fields: Vec<usize>,
}

/// The parameter of a row, counted from 1.
fn entry(row: u8) -> Option<&'static Entry> {
    let number = (FIRST_ROW - 1).checked_add(u16::from(row))?;
    Entry::find(number, None).ok()
}

/// The row that a parameter is, counted from 1.
#[must_use]
pub fn row_of(entry: &Entry) -> Option<u8> {
    let row = entry.no.checked_sub(FIRST_ROW - 1)?;
    u8::try_from(row)
        .ok()
        .filter(|row| (1..=ROWS).contains(row))
}

/// The rows of a set, with their numbers.
fn rows(params: &Params) -> impl Iterator<Item = (u8, i64)> {
    (1..=ROWS).map(|row| (row, entry(row).map_or(0, |entry| params.get(entry))))
}
