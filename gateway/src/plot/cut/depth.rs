//! What views of a hole have in common, tapped or drilled: depth below R, downwards. It must not know how the hole is made.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{Group, Rectangle};

use super::labelled;
use super::pane::{Area, Pane};
use crate::plot::{frame, px, text};
use crate::words::pick;

/// The places of the view of the depth, with room for labels beside it, and of the view next to that.
pub(super) fn beside(area: Area) -> (Area, Area) {
    let middle = area.left + 0.62 * (area.right - area.left);
    let depth = Area {
        right: middle - 120.0,
        ..area
    };
    let next = Area {
        left: middle + 96.0,
        ..area
    };
    (depth, next)
}

/// The material between these depths, where they are known.
pub(super) fn material(inside: &mut Group, pane: &Pane, material: (Option<f64>, Option<f64>)) {
    let (Some(face), end) = material else {
        return;
    };
    let Area {
        left,
        right,
        bottom: edge,
        ..
    } = pane.area;
    let top = pane.place((0.0, face)).1;
    let end = end.map_or(edge, |end| pane.place((0.0, end)).1.min(edge));
    inside.append(
        Rectangle::new()
            .set("class", "stock")
            .set("x", px(left))
            .set("y", px(top))
            .set("width", px(right - left))
            .set("height", px((end - top).max(0.0))),
    );
}

/// R, and the depths of surface and bottom.
pub(super) fn marks(
    document: &mut Group,
    pane: &Pane,
    (surface, bottom): (Option<f64>, f64),
    lang: Lang,
) {
    let area = pane.area;
    let mut level = |depth: f64, class: &str, words: &str, above: bool| {
        let y = pane.place((0.0, depth)).1;
        frame::line(document, class, [(area.left, y), (area.right, y)]);
        let left = area.right - frame::width(words) - 6.0;
        let y = if above { y - 4.0 } else { y + 14.0 };
        document.append(text(left, y, "key", words));
    };
    level(0.0, "mark", "R", true);
    if let Some(face) = surface {
        level(face, "surface", pick(lang, "surface", "工件表面"), false);
    }
    level(bottom, "mark", pick(lang, "bottom", "孔底"), false);
}

/// Labels beside the view, each at its depth, and above them what they are.
pub(super) fn labels(document: &mut Group, pane: &Pane, of: &[(f64, String)], name: &str) {
    let area = pane.area;
    let heights: Vec<f64> = of
        .iter()
        .map(|(depth, _)| pane.place((0.0, *depth)).1)
        .collect();
    for n in labelled(&heights, 14.0) {
        let y = heights[n] + 4.5;
        document.append(text(area.right + 10.0, y, "depth-of", &of[n].1));
    }
    if !of.is_empty() {
        document.append(text(area.right + 10.0, area.top - 8.0, "name", name));
    }
}
