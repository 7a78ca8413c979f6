//! A turned contour near by: its cuts to scale, with the lines of the program that make them.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::Group;

use super::pane::{Across, Area, Pane, Range};
use super::told;
use crate::place::SourceLine;
use crate::plot::text;
use crate::words::pick;

/// A cut of one block.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The line of the program as the machine counts it.
    pub line: u32,
    /// Its way: Z, radius.
    pub points: Vec<(f64, f64)>,
}

/// The cuts of one tool at a feed.
#[derive(Clone, Debug)]
pub struct Contour {
    /// In the order of cutting.
    pub pieces: Vec<Piece>,
}

/// Draws the view.
pub(super) fn draw(document: &mut Group, area: Area, contour: &Contour, n: usize, lang: Lang) {
    let points = || {
        contour
            .pieces
            .iter()
            .flat_map(|piece| piece.points.iter().copied())
    };
    let Some(range) = Range::of(points()) else {
        return;
    };
    let range = range.with_room(0.06, 0.12);
    let pane = Pane::true_to_scale(area, Across::X, range, format!("contour{n}"));
    let mut inside = pane.frame(document);
    for piece in &contour.pieces {
        let pixels = piece.points.iter().map(|point| pane.place(*point));
        inside.append(told("line feed", pixels, "", piece.line, lang));
    }
    document.append(inside);
    let mut taken: Vec<(f64, f64)> = Vec::new();
    let is_own = |piece: &&Piece| SourceLine(piece.line).file().is_none();
    for piece in contour.pieces.iter().rev().filter(is_own) {
        // In the middle of the cut, above it.
        let half = (piece.points.len() - 1) / 2;
        let pair = (piece.points.get(half), piece.points.get(half + 1));
        let (Some(&(z, r)), Some(&(z2, r2))) = pair else {
            continue;
        };
        let (x, y) = pane.place((f64::midpoint(z, z2), f64::midpoint(r, r2)));
        let words = piece.line.to_string();
        let is_free = |(x2, y2): &(f64, f64)| (x2 - x).abs() > 24.0 || (y2 - y).abs() > 14.0;
        if taken.iter().all(is_free) {
            taken.push((x, y));
            document.append(text(x, y - 4.0, "below", &words));
        }
    }
    let words = pick(
        lang,
        "cuts with the numbers of their lines, to scale",
        "切削段与程序行号，按比例",
    );
    document.append(text(area.left, area.top - 8.0, "key", words));
}
