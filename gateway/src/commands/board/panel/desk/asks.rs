//! What the desk asks of the panel's own thread, which alone waits for the bus and begins processes. Values alone.

use leadscrew_panel::Claim;

use crate::start::Shown;

/// A line to be carried out, or the way out of a hole.
pub struct Line {
    /// Answers whether it has begun.
    pub ticket: u64,
    /// Which of the two.
    pub what: What,
    /// The answer is Chinese.
    pub zh: bool,
}

/// What is begun as a line is.
pub enum What {
    /// The line.
    Line(String),
    /// The way out of a hole, at this speed of the spindle.
    Retract(Option<u32>),
}

/// A line that a program is started at, and what its page was shown of that.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StartAt {
    /// The line.
    pub line: u32,
    /// What would happen.
    pub shown: Shown,
}

/// A program to be sent and begun.
pub struct Program {
    /// Answers whether it is being sent.
    pub ticket: u64,
    /// Its name.
    pub name: String,
    /// The tag of its text.
    pub tag: String,
    /// It stays as it is.
    pub claim: Claim,
    /// The line that it is started at, not its first one.
    pub start: Option<StartAt>,
    /// It follows a handwheel.
    pub wheel: bool,
    /// The answer is Chinese.
    pub zh: bool,
}

/// What the panel's own thread is asked.
#[derive(Default)]
pub struct Asks {
    /// Orders of which the board has to say whether it has refused them.
    pub reasons: Vec<u64>,
    /// A press of a page was refused, and its page is told why.
    pub press: bool,
    /// Lines.
    pub lines: Vec<Line>,
    /// Programs.
    pub programs: Vec<Program>,
    /// Holds and stops that were given before.
    pub halts: u64,
}
