//! Turns moves into strokes: the picture of a program's path.

use std::f64::consts::TAU;

use leadscrew_core::call::Position;
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_language::whose::Whose;

use crate::length::sweep;
use crate::plot::{Kind, Stroke};

/// The most strokes. A picture cannot show more, and a program of any length must fit into memory.
const MOST: usize = 200_000;
/// Largest angle between two points of an arc.
const ARC_STEP: f64 = TAU / 90.0;

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

/// Points along a circle in the Z–X plane as it is drawn: Z to the right, X upwards.
pub(crate) fn arc(
    from: (f64, f64),
    to: (f64, f64),
    centre: (f64, f64),
    clockwise: bool,
) -> Vec<(f64, f64)> {
    let radius = (from.0 - centre.0).hypot(from.1 - centre.1);
    let start = (from.1 - centre.1).atan2(from.0 - centre.0);
    let sweep = sweep(from, to, centre, clockwise);
    let steps = (sweep.abs() / ARC_STEP).ceil().max(1.0) as usize;
    let mut points = vec![from];
    points.extend((1..steps).map(|n| {
        let at = start + sweep * n as f64 / steps as f64;
        (centre.0 + radius * at.cos(), centre.1 + radius * at.sin())
    }));
    points.push(to);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_turn_the_right_way() {
        // A rounded outer corner, upwards and then to the left: counter-clockwise.
        let corner = arc((0.0, 0.0), (-2.0, 2.0), (-2.0, 0.0), false);
        assert!(
            corner
                .iter()
                .all(|p| p.0 <= 1e-9 && p.1 >= -1e-9 && p.0 >= -2.0 - 1e-9),
            "{corner:?}"
        );
        // A fillet, to the left and then upwards: clockwise.
        let fillet = arc((0.0, 0.0), (-2.0, 2.0), (0.0, 2.0), true);
        assert!(
            fillet
                .iter()
                .all(|p| p.1 >= -1e-9 && p.1 <= 2.0 + 1e-9 && p.0 <= 1e-9),
            "{fillet:?}"
        );
        let turn = arc((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), false);
        assert!(turn.len() > 80);
        let turn = arc((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), true);
        assert!(turn.len() > 80 && turn[1].1 < 0.0);
    }
}
