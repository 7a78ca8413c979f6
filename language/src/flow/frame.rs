//! The stack of what runs: the main program, and what it has called.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use super::jumps::Loop;
use crate::lines::Place;
use crate::variables::Locals;

/// A program that was called, or the main program.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its number.
    pub(super) number: u32,
    /// The front of the program: searches begin there.
    pub(super) start: Place,
    /// The first block of each pass.
    pub(super) entry: Place,
    /// Where its caller goes on.
    pub(super) back: Place,
    /// The word that called it.
    pub(super) called: Span,
    /// Passes after this one.
    pub(super) left: u32,
    /// What its local variables are at the front of each pass; `None` where it has its caller's.
    pub(super) arguments: Option<Box<Locals>>,
    /// The loops around the next block, from outside.
    pub(super) loops: Vec<Loop>,
    /// The modal calls in force, the latest last.
    pub(super) modals: Vec<Modal>,
}

/// A macro that is called after each motion.
#[derive(Clone, Debug)]
pub struct Modal {
    pub(super) called: Span,
    pub(super) number: u32,
    pub(super) passes: u32,
    pub(super) arguments: Box<Locals>,
}

impl Frame {
    /// The main program, before anything of it is known.
    pub(super) const fn main() -> Self {
        Self {
            number: 0,
            start: Place::START,
            entry: Place::START,
            back: Place::START,
            called: Span {
                line: 0,
                column: 0,
                end: 0,
            },
            left: 0,
            arguments: None,
            loops: Vec::new(),
            modals: Vec::new(),
        }
    }

    /// The alarm of a subprogram that does not return.
    pub(super) fn left_open(&self, span: Span) -> Alarm {
        let figure = [Arg::Int(i64::from(self.number))];
        Alarm::new(Code::SubprogramOpen, span).with(figure)
    }
}
