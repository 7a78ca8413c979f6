//! Turns moves into strokes: the picture of a program's path.

use leadscrew_core::call::Position;
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_language::whose::Whose;
use leadscrew_verification::arc;

use crate::plot::{Kind, Stroke};

/// The most strokes. A picture cannot show more, and a program of any length must fit into memory.
const MOST: usize = 200_000;

/// Collects the strokes of a program in work coordinates.
#[derive(Debug)]
pub struct Drawing {
    strokes: Vec<Stroke>,
    at: (f64, f64),
    origin: (f64, f64),
    left_out: u64,
}

impl Drawing {
    /// An empty picture. The tool stands at `start` (machine coordinates).
    pub fn new(start: &Position) -> Self {
        Self {
            strokes: Vec::new(),
            at: place(start),
            origin: (0.0, 0.0),
            left_out: 0,
        }
    }

    /// Adds a move. `origin` is its work origin; the picture uses the latest one.
    pub fn push(&mut self, step: &Move, origin: &Position) {
        self.origin = place(origin);
        let (from, to) = (self.at, place(&step.to));
        self.at = to;
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

    /// The strokes in work coordinates.
    pub fn finish(self) -> Drawn {
        let (z, x) = self.origin;
        let mut strokes = self.strokes;
        for point in strokes.iter_mut().flat_map(|stroke| &mut stroke.points) {
            *point = (point.0 - z, point.1 - x);
        }
        Drawn {
            strokes,
            origin: self.origin,
            left_out: self.left_out,
        }
    }
}

/// The picture of a path.
#[derive(Debug)]
pub struct Drawn {
    /// The strokes in work coordinates.
    pub strokes: Vec<Stroke>,
    /// The work zero in millimetres of the machine: Z, radius.
    pub origin: (f64, f64),
    /// The number of strokes that did not fit.
    pub left_out: u64,
}

pub(crate) fn mm(nm: i64) -> f64 {
    nm as f64 / 1e6
}

fn place(position: &Position) -> (f64, f64) {
    (mm(position.z.nm()), mm(position.x.nm()))
}
