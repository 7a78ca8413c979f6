//! Virtual metrology of a program: its threads, cut by the simulated machine's positions and measured, and its grooves and
//! contours ([`turned`]).
//!
//! [`plan`] finds the threads in the text, [`guess`] what they are called, [`samples`] turns the machine's ticks into cuts,
//! [`sheet`], [`result`] and [`picture`] tell what was found. How a part is cut and measured is in `leadscrew_metrology`.

pub mod edge;
pub mod guess;
pub mod picture;
pub mod plan;
pub mod result;
pub mod samples;
pub mod sheet;
pub mod turned;

use leadscrew_metrology::{Designation, Inspection, Measured, Mm, NoThread, Stock, Tool, Work};

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
    pub fn verdict(&self) -> Option<bool> {
        match &self.found {
            Ok((_, inspection)) => inspection.verdict(),
            Err(NoThread) => Some(false),
        }
    }
}
