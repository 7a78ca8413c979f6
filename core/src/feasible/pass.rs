//! The synchronous moves of a pass, gathered from the stream of moves.

use heapless::Vec;

use crate::call::Position;
use crate::moves::{Move, MoveKind};

/// A pass: its start position, and its one to three moves in order.
#[derive(Clone, Debug)]
pub(crate) struct Pass {
    pub from: Position,
    pub moves: Vec<Move, 3>,
}

/// Gathers passes from a stream of moves. It takes each move with the position at which the move begins, and returns a
/// pass after the pass's last move.
#[derive(Clone, Debug)]
pub(crate) struct Gather(Pass);

impl Gather {
    pub const fn new() -> Self {
        Self(Pass {
            from: Position::ZERO,
            moves: Vec::new(),
        })
    }

    /// The last gathered pass.
    pub fn pass(self) -> Pass {
        self.0
    }

    pub fn take(&mut self, from: Position, next: &Move) -> Option<&Pass> {
        let pass = &mut self.0;
        let last = |next: &Move| matches!(&next.kind, MoveKind::Thread(thread) if thread.last);
        if pass.moves.last().is_some_and(last) {
            pass.moves.clear();
        }
        if !matches!(next.kind, MoveKind::Thread(_)) {
            pass.moves.clear();
            return None;
        }
        if pass.moves.is_empty() {
            pass.from = from;
        }
        // A pass has at most three moves; any further move would not be planned.
        pass.moves.push(*next).ok()?;
        last(next).then_some(&*pass)
    }
}
