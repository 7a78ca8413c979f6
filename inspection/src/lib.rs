//! The threads of a lathe program, and the parts that a simulated machine makes of them.
//!
//! A [`Finder`] sees the calls of a program and their moves, and finds the threads: which moves cut each, in which pass,
//! and what it is called, where nobody says so. [`Cutting`] takes the positions of a machine tick by tick and cuts each
//! thread with them; what is done is measured and compared with its norm ([`Cut`]).
//!
//! Knows nothing of files, words of people and pictures, and not where positions come from.

mod cutting;
mod guess;
mod plan;
mod stretch;

pub use cutting::{Cutting, Instant};
pub use plan::{Declared, Finder, Flat, Plan, Refusal, Wish, tool_of};

use leadscrew_core::call::{CutIn, ThreadCycle};
use leadscrew_metrology::{Designation, Inspection, Measured, Mm, NoThread, Stock, Tool, Work};

/// The edge of one tool, or of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Number of the tool; `None` for all.
    pub tool: Option<u32>,
    /// Its shape.
    pub shape: Tool,
}

/// What was not told and had to be assumed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Assumed {
    /// The name of the thread was guessed.
    pub thread: bool,
    /// The edge of the tool has the norm's shape.
    pub tool: bool,
    /// The surface before the cut is in the middle of the norm's limits.
    pub surface: bool,
    /// The face is at Z0, or where the strokes begin.
    pub face: bool,
    /// It is a bolt.
    pub side: bool,
}

/// A thread of a program with all that is needed to cut it.
#[derive(Clone, Debug)]
pub struct Job {
    /// Source line of its first cycle.
    pub line: u32,
    /// The words that cut it.
    pub cycle: ThreadCycle,
    /// Where its passes go down.
    pub cut_in: CutIn,
    /// What it should be.
    pub thread: Designation,
    /// The edge that cuts it.
    pub tool: Tool,
    /// Its number, 0 where the program has named none.
    pub tool_number: u32,
    /// The part before the cut, in work coordinates.
    pub stock: Stock,
    /// Distance of work coordinates from those of the machine: radius, Z.
    pub origin: (Mm, Mm),
    /// Its moves: first, last, pass.
    pub passes: Vec<(u64, u64, u32)>,
    /// What had to be assumed.
    pub assumed: Assumed,
}

/// A thread that was cut.
#[derive(Clone, Debug)]
pub struct Cut {
    /// What was asked.
    pub job: Job,
    /// The part.
    pub work: Work,
    /// What was found, and how it compares.
    pub found: Result<(Measured, Inspection), NoThread>,
}

impl Cut {
    /// Good, bad, or not judged.
    #[must_use]
    pub fn verdict(&self) -> Option<bool> {
        match &self.found {
            Ok((_, inspection)) => inspection.verdict(),
            Err(NoThread) => Some(false),
        }
    }
}
