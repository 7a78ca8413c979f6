//! The compact notation of the tests: `R40.4,2.1` is a rapid to X 40.4 (a diameter) Z 2.1, `F` a cut, `A30,-15/5cw` an arc
//! with its radius.

use leadscrew_core::alarm::Span;
use leadscrew_core::units::Length;

use crate::contour::{Axes, Contour, Cut};
use crate::plane::{Element, Point, Shape};

/// Millimetres as nanometres.
pub fn nm(text: &str) -> i64 {
    let value: f64 = text.parse().expect("a number");
    (value * 1e6).round() as i64
}

fn point(text: &str) -> Point {
    let (x, z) = text.split_once(',').expect("X,Z");
    Point::from_nm(nm(x) / 2, nm(z))
}

/// The centre of the short arc, minus its start.
fn centre(from: Point, to: Point, radius: i64, clockwise: bool) -> (i64, i64) {
    let (dx, dz) = ((to.x - from.x).nm() as f64, (to.z - from.z).nm() as f64);
    let chord = dx.hypot(dz);
    let height = (radius as f64).mul_add(radius as f64, -(chord * chord / 4.0));
    let height = height.max(0.0).sqrt() / chord;
    let side = if clockwise { 1.0 } else { -1.0 };
    // Clockwise, with X up and Z to the right, the centre is on the right.
    let x = (-side * dz).mul_add(height, dx / 2.0);
    let z = (side * dx).mul_add(height, dz / 2.0);
    (x.round() as i64, z.round() as i64)
}

/// A span that tells which element it is of.
pub fn span(line: usize) -> Span {
    Span {
        line: line as u32,
        column: 1,
        end: 2,
    }
}

/// A path in the notation. Each element has its number, from 1, as its line.
pub fn path(start: Point, text: &str) -> Vec<Element> {
    let mut from = start;
    let words = text.split_whitespace().zip(1..);
    words
        .map(|(word, line)| {
            let (kind, rest) = word.split_at(1);
            let (place, arc) = rest.split_once('/').unwrap_or((rest, ""));
            let end = point(place);
            let shape = match kind {
                "R" => Shape::Rapid,
                "F" => Shape::Line,
                _ => {
                    let clockwise = arc.ends_with("cw") && !arc.ends_with("ccw");
                    let radius = nm(arc.trim_end_matches(['c', 'w']));
                    let (i, k) = centre(from, end, radius, clockwise);
                    let (i, k) = (Length::from_nm(i), Length::from_nm(k));
                    Shape::Arc { i, k, clockwise }
                }
            };
            from = end;
            Element {
                end,
                shape,
                span: span(line),
            }
        })
        .collect()
}

/// A contour whose first block has words of `axes`.
pub fn contour(start: &str, axes: &str, text: &str) -> Contour {
    let start = point(start);
    let axes = Axes {
        x: axes.contains('X'),
        z: axes.contains('Z'),
    };
    Contour::new(start, axes, path(start, text)).expect("a contour")
}

/// Moves without their places in the text.
pub fn moves(cuts: impl Iterator<Item = Cut>) -> Vec<(Point, Shape)> {
    cuts.map(|cut| (cut.element.end, cut.element.shape))
        .collect()
}

/// What a cycle should do, from its start.
pub fn expected(start: &str, text: &str) -> Vec<(Point, Shape)> {
    let path = path(point(start), text);
    path.iter()
        .map(|element| (element.end, element.shape))
        .collect()
}
