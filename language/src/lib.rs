//! The shop's language: what a published program says, resolved where its text is.
//!
//! The core reads plain blocks and makes calls of them, in the memory of one line. Part of the language needs more memory
//! than a line: a program that jumps, a contour that a cycle reads before it cuts, a radius that looks at the next corner.
//! That part is here, in bounded memory that does not grow with the text.
//!
//! ```text
//! text ─► statements ─► plain blocks ─► calls ─► calls of the contour cycles ─► calls with the nose compensated
//!          macros, flow   core::program            contour                        nose
//! ```
//!
//! - [`text`] cuts lines into blocks; [`lines`] reads them from any place of the text, and [`whose`] numbers those of
//!   several files.
//! - [`statement`] tells what a block is; [`expression`] and [`word`] calculate in it, with [`variables`].
//! - [`dialect`] makes of a block of any control one of the G-code system A.
//! - [`flow`] carries out assignments, jumps, loops and calls, and so decides which block comes next; [`outline`] is what
//!   its searches see.
//! - [`reader`] is the whole way: text in, events of the core out.
//! - [`drilling`] reads the words of the cycles of a drill and makes their moves.
//! - [`heading`] reads the comments in the first lines of a file, [`mod@stock`] that which declares the stock.
//! - [`roughing`] reads the words of the cycles G70–G73, and [`contour`] makes their moves from the contour that the
//!   program describes.
//! - [`plane`] has the words for paths in the plane of the tool: points and elements (lines and arcs).
//! - [`geometry`] says where such elements meet, and what lies beside them.
//! - [`corner`] puts a chamfer or a rounding between two of them.
//! - [`nose`] moves the path so that a round nose keeps to it.
//! - `path` joins corners and nose to the events of the core.
//!
//! This crate has floating point: a macro calculates in it, and so does geometry between exact ends. Each function comes
//! from one portable library, so the result has the same bits on every machine.
//!
//! It must not know sockets, files, boards or commands. Its input are bytes that can be read again from a place, and the
//! subprograms that whoever has them hands over by their numbers; its output are the calls of the core, with alarms that
//! name line, column, cause and remedy.
//!
//! ```
//! use leadscrew_core::call::CallKind;
//! use leadscrew_core::params::Params;
//! use leadscrew_core::program::{Event, Options};
//! use leadscrew_language::flow::{Rules, Trouble};
//! use leadscrew_language::reader::Reader;
//! use leadscrew_language::variables::Kept;
//!
//! let text = "#1=20\nWHILE[#1GT14]DO1\nG0 X#1\n#1=#1-2\nEND1\nM30\n".as_bytes();
//! let params = Params::slant_bed();
//! let mut reader = Reader::new(text, &params, Options::default(), Kept::default(), Rules::default());
//! let mut diameters = Vec::new();
//! while !reader.is_over() {
//!     reader.step(&mut |event| {
//!         if let Event::Call(call) = event
//!             && let CallKind::Rapid(to) = call.kind
//!         {
//!             diameters.push(2 * to.x.nm() / 1_000_000);
//!         }
//!     })?;
//! }
//! assert_eq!(diameters, [20, 18, 16]);
//! # Ok::<(), Trouble>(())
//! ```

pub mod arguments;
pub mod behind;
pub mod contour;
pub mod corner;
pub mod dialect;
pub mod drilling;
pub mod expression;
#[cfg(test)]
mod figures;
pub mod flow;
pub mod geometry;
pub mod heading;
pub mod lines;
mod macro_a;
pub mod nose;
pub mod outline;
mod path;
pub mod plane;
#[cfg(test)]
mod random;
pub mod reader;
#[cfg(test)]
mod reading;
pub mod roughing;
pub mod statement;
pub mod steps;
pub mod stock;
pub mod text;
pub mod value;
pub mod variables;
pub mod whose;
pub mod word;
