//! The synchronous moves of a pass, gathered from the stream of moves.

use crate::cycle::{Move, MoveKind};
use crate::program::Position;
use crate::units::Length;

/// A pass: where it starts, and its one to three moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    pub from: Position,
    moves: [Move; 3],
    count: usize,
}

impl Pass {
    /// A pass that so far has its first move.
    fn new(from: Position, first: Move) -> Self {
        Self {
            from,
            moves: [first; 3],
            count: 1,
        }
    }

    /// Its moves in order.
    pub fn moves(&self) -> &[Move] {
        self.moves.get(..self.count).unwrap_or(&[])
    }

    /// The last move.
    pub fn last(&self) -> &Move {
        self.moves().last().unwrap_or(&self.moves[0])
    }

    /// Where the last move begins.
    pub fn last_from(&self) -> Position {
        let before = self.count.saturating_sub(2);
        match self.moves.get(before) {
            Some(before) if self.count > 1 => before.to,
            _ => self.from,
        }
    }

    /// Its way on the long axis.
    pub fn stroke(&self) -> Length {
        let long_x = matches!(self.last().kind, MoveKind::Thread(thread) if thread.long_x);
        if long_x {
            (self.last().to.x - self.from.x).abs()
        } else {
            (self.last().to.z - self.from.z).abs()
        }
    }

    fn push(&mut self, next: Move) {
        if let Some(place) = self.moves.get_mut(self.count) {
            *place = next;
            self.count = self.count.wrapping_add(1);
        }
    }
}

/// Gathers passes: takes each move with the position it begins at, and gives a pass when its last move has come.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gather {
    pass: Option<Pass>,
    /// It has all its moves.
    closed: bool,
}

impl Gather {
    pub fn take(&mut self, from: Position, next: &Move) -> Option<&Pass> {
        let MoveKind::Thread(thread) = next.kind else {
            self.pass = None;
            return None;
        };
        match &mut self.pass {
            Some(pass) if !self.closed => pass.push(*next),
            pass => *pass = Some(Pass::new(from, *next)),
        }
        self.closed = thread.last;
        self.pass.as_ref().filter(|_| thread.last)
    }
}
