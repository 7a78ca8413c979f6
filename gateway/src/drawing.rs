//! Turns moves into strokes: the picture of a program's path.

use leadscrew_core::call::Position;
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_language::whose::Whose;
use leadscrew_verification::arc;

use crate::plot::{Kind, Stroke};

/// The most strokes. A picture cannot show more, and a program of any length must fit into memory.
const MOST: usize = 200_000;

/// Collects the strokes of a program, each in the work coordinates of its move.
#[derive(Debug)]
pub struct Drawing {
    strokes: Vec<Stroke>,
    zeros: Vec<Zero>,
    at: Position,
    number: u64,
    left_out: u64,
}

/// A work zero, from a move on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Zero {
    /// The number of its first move.
    from: u64,
    origin: Position,
}

/// The work zeros of a program, gone through with its moves.
#[derive(Debug)]
pub struct Zeros {
    list: Vec<Zero>,
    now: usize,
}

impl Zeros {
    /// X and Z of the zero of a move, in machine coordinates. Moves come in the order of their numbers; 0 is between two.
    pub fn at(&mut self, number: u64) -> (i64, i64) {
        let next = |zeros: &Self| zeros.list.get(zeros.now + 1).map(|zero| zero.from);
        while next(self).is_some_and(|from| from <= number) {
            self.now += 1;
        }
        let zero = self.list.get(self.now).map(|zero| zero.origin);
        zero.map_or((0, 0), |zero| (zero.x.nm(), zero.z.nm()))
    }
}

impl Drawing {
    /// An empty picture. The tool stands at `start` (machine coordinates).
    pub const fn new(start: Position) -> Self {
        Self {
            strokes: Vec::new(),
            zeros: Vec::new(),
            at: start,
            number: 0,
            left_out: 0,
        }
    }

    /// Adds a move; `origin` is its work zero.
    pub fn push(&mut self, step: &Move, origin: &Position) {
        self.number += 1;
        let is_new = self.zeros.last().is_none_or(|zero| zero.origin != *origin);
        if is_new && self.zeros.len() < MOST {
            self.zeros.push(Zero {
                from: self.number,
                origin: *origin,
            });
        }
        let from = place(&std::mem::replace(&mut self.at, step.to), origin);
        let to = place(&step.to, origin);
        let (kind, points) = match step.kind {
            MoveKind::Rapid => (Kind::Rapid, vec![from, to]),
            MoveKind::Feed(_) => (Kind::Feed, vec![from, to]),
            MoveKind::Tap(_) => (Kind::Tap, vec![from, to]),
            MoveKind::Thread(_) => (Kind::Thread, vec![from, to]),
            MoveKind::Arc {
                i, k, clockwise, ..
            } => {
                let centre = (from.0 + mm(k.nm()), from.1 + mm(i.nm()));
                (Kind::Feed, arc(from, to, centre, clockwise))
            }
            MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => return,
        };
        if self.strokes.len() == MOST {
            self.left_out += 1;
        } else {
            let line = match Whose::line(step.span.line) {
                Whose::Program => step.span.line,
                Whose::Subprogram(_) => 0,
            };
            self.strokes.push(Stroke { kind, line, points });
        }
    }

    /// The strokes and the zeros that they are by.
    pub fn finish(self) -> Drawn {
        Drawn {
            strokes: self.strokes,
            zeros: Zeros {
                list: self.zeros,
                now: 0,
            },
            left_out: self.left_out,
        }
    }
}

/// The picture of a path.
#[derive(Debug)]
pub struct Drawn {
    /// The strokes in work coordinates.
    pub strokes: Vec<Stroke>,
    /// The work zeros.
    pub zeros: Zeros,
    /// The number of strokes that did not fit.
    pub left_out: u64,
}

pub(crate) fn mm(nm: i64) -> f64 {
    nm as f64 / 1e6
}

/// Z and radius in millimetres by a work zero.
fn place(position: &Position, origin: &Position) -> (f64, f64) {
    let (z, x) = (position.z - origin.z, position.x - origin.x);
    (mm(z.nm()), mm(x.nm()))
}
