//! From a call to its moves; a step is a move.

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::call::{GrooveCall, ThreadCall};
use leadscrew_core::cycle::{GrooveMoves, ThreadMoves};
use leadscrew_core::moves::Move;

use super::{Work, calls};

/// The moves of a G76.
pub struct Threads(ThreadCall);

/// The moves of a G75.
pub struct Grooves(GrooveCall);

impl Threads {
    /// The [G76 sheet]'s example.
    pub fn o0013() -> Self {
        Self(calls::o0013())
    }

    /// The work before the first move: the check of all passes.
    pub fn check(&self) -> Result<ThreadMoves, Alarm> {
        ThreadMoves::new(&self.0, Span::default())
    }
}

impl Grooves {
    /// The [G75 sheet]'s example.
    pub fn o0008() -> Self {
        Self(calls::o0008())
    }

    /// The work before the first move.
    pub fn check(&self) -> Result<GrooveMoves, Alarm> {
        GrooveMoves::new(&self.0, Span::default())
    }
}

impl Work for Threads {
    type State = ThreadMoves;
    type Out = Option<Move>;

    fn steps(&self) -> usize {
        self.begin().count()
    }

    fn begin(&self) -> ThreadMoves {
        self.check().expect("the sheet's example")
    }

    fn step(&self, moves: &mut ThreadMoves, _: usize) -> Option<Move> {
        moves.next()
    }
}

impl Work for Grooves {
    type State = GrooveMoves;
    type Out = Option<Move>;

    fn steps(&self) -> usize {
        self.begin().count()
    }

    fn begin(&self) -> GrooveMoves {
        self.check().expect("the sheet's example")
    }

    fn step(&self, moves: &mut GrooveMoves, _: usize) -> Option<Move> {
        moves.next()
    }
}
