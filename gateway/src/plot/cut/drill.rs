//! Drilled holes near by: their pecks side by side, each from where its feed begins to where it ends, and beside them where
//! the holes are, seen along the axis of the part. Holes that are alike lie one upon the other.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{Group, Rectangle};

use super::pane::{Area, Axes, Pane, Range};
use super::{depth, told};
use crate::number::measured;
use crate::plot::{frame, px, text};
use crate::words::pick;

/// Where a hole is in the work, and how many pecks it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// C in degrees.
    pub angle: f64,
    /// X as a radius at the end of its first feed, millimetres.
    pub radius: f64,
    /// Z there.
    pub z: f64,
    /// Feeds into it.
    pub pecks: u32,
}

/// A feed into a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peck {
    /// Number of its hole from 1.
    pub hole: u32,
    /// Its number in the hole from 1.
    pub number: u32,
    /// The line of the program as the machine counts it.
    pub line: u32,
    /// Depth below R at its ends, millimetres.
    pub depth: (f64, f64),
    /// Depth at which it comes to what no peck before has taken.
    pub fresh: f64,
}

impl Peck {
    /// The millimetres of depth that it takes.
    pub fn cuts(&self) -> f64 {
        self.depth.1 - self.fresh
    }
}

/// Drilled holes with one R.
#[derive(Clone, Debug)]
pub struct Drilled {
    /// Name of the axis that travels.
    pub axis: &'static str,
    /// R in the work, millimetres; X is a diameter.
    pub level: f64,
    /// From R to the bottom, millimetres.
    pub bottom: f64,
    /// From R to where the material begins and to where it ends, millimetres, where that is known.
    pub material: (Option<f64>, Option<f64>),
    /// In the order of cutting.
    pub holes: Vec<Hole>,
    /// Of all holes, in the order of cutting.
    pub pecks: Vec<Peck>,
}

impl Drilled {
    /// They are about the axis of the part, and not on it.
    pub fn is_around(&self) -> bool {
        self.axis == "X" || self.holes.iter().any(|hole| hole.radius != 0.0)
    }
}

/// Half of the width of a peck, where pecks are one apart.
const HALF: f64 = 0.3;

/// Draws both views.
pub(super) fn draw(document: &mut Group, area: Area, drilled: &Drilled, n: usize, lang: Lang) {
    if !drilled.is_around() {
        let right = area.right - 110.0;
        return draw_pecks(document, Area { right, ..area }, drilled, n, lang);
    }
    let (pecks, around) = depth::beside(area);
    draw_pecks(document, pecks, drilled, n, lang);
    draw_around(document, around, drilled, n, lang);
}

/// Depth over the pecks.
fn draw_pecks(document: &mut Group, area: Area, drilled: &Drilled, n: usize, lang: Lang) {
    let most = drilled.pecks.iter().map(|peck| peck.number).max();
    let most = f64::from(most.unwrap_or(1));
    let axes = Axes {
        written: (1.0, 1.0),
        labels: (pick(lang, "peck", "次"), "mm"),
        names: (pick(lang, "peck", "次"), pick(lang, "depth", "深度")),
        is_down: true,
        is_count: true,
    };
    let range = Range {
        z: (0.4, most + 0.6),
        r: (0.0, drilled.bottom),
    };
    let range = range.with_room(0.0, 0.1);
    let pane = Pane::filled(area, axes, range, format!("drill{n}"));
    let mut inside = pane.frame(document);
    depth::material(&mut inside, &pane, drilled.material);
    for peck in &drilled.pecks {
        let at = f64::from(peck.number);
        let (left, top) = pane.place((at - HALF, peck.fresh));
        let (right, bottom) = pane.place((at + HALF, peck.depth.1));
        inside.append(
            Rectangle::new()
                .set("class", "blade")
                .set("x", px(left))
                .set("y", px(top))
                .set("width", px(right - left))
                .set("height", px((bottom - top).max(0.0))),
        );
        let words = words(peck, lang);
        let ways = [
            ("line run-out", peck.depth.0, peck.fresh),
            ("line feed", peck.fresh, peck.depth.1),
        ];
        for (class, from, to) in ways.into_iter().filter(|(_, from, to)| to > from) {
            let way = [from, to].map(|depth| pane.place((at, depth)));
            inside.append(told(class, way, &words, peck.line, lang));
        }
    }
    document.append(inside);
    depth::marks(document, &pane, (drilled.material.0, drilled.bottom), lang);
    depths(document, &pane, drilled, lang);
    let keys = [
        ("feed", pick(lang, "drills", "钻削")),
        (
            "run-out",
            pick(lang, "at feed where nothing is left", "空切进给"),
        ),
    ];
    frame::keys(document, area.left, area.top - 8.0, keys);
}

/// What a page tells of a peck before its line.
fn words(peck: &Peck, lang: Lang) -> String {
    let (hole, number) = (peck.hole, peck.number);
    let (to, cuts) = (measured(peck.depth.1), measured(peck.cuts()));
    match lang {
        Lang::En => format!("hole {hole}, peck {number} to {to} mm, {cuts} mm of it new, "),
        Lang::Zh => format!("第 {hole} 孔，第 {number} 次进给至 {to} mm，切入 {cuts} mm，"),
    }
}

/// Number and depth of the pecks beside the view; of holes that are alike the first one's.
fn depths(document: &mut Group, pane: &Pane, drilled: &Drilled, lang: Lang) {
    let first = drilled.pecks.iter().take_while(|peck| peck.hole == 1);
    let labels: Vec<(f64, String)> = first
        .map(|peck| {
            let deep = measured(peck.depth.1);
            (peck.depth.1, format!("{}: {deep}", peck.number))
        })
        .collect();
    let name = pick(lang, "peck: depth mm", "次：深度 mm");
    depth::labels(document, pane, &labels, name);
}

/// Where the holes are, seen along the axis of the part: C0 is above, and C grows clockwise.
fn draw_around(document: &mut Group, area: Area, drilled: &Drilled, n: usize, lang: Lang) {
    let level = drilled.level / 2.0;
    let far = drilled.holes.iter().map(|hole| hole.radius.abs());
    let is_side = drilled.axis == "X";
    let rim = if is_side {
        level.abs()
    } else {
        far.fold(0.0, f64::max)
    };
    let reach = 1.3 * rim.max(0.1);
    let axes = Axes {
        written: (1.0, 1.0),
        labels: ("mm", "mm"),
        names: ("→", "↑"),
        is_down: false,
        is_count: false,
    };
    let range = Range {
        z: (-reach, reach),
        r: (-reach, reach),
    };
    let pane = Pane::true_to_scale(area, axes, range, format!("around{n}"));
    let mut inside = pane.frame(document);
    let at = |angle: f64, radius: f64| {
        let angle = angle.to_radians();
        pane.place((radius * angle.sin(), radius * angle.cos()))
    };
    let circle = |radius: f64| (0..=90).map(move |n| (4.0 * f64::from(n), radius));
    let circles = [
        Some(("mark", rim)),
        drilled
            .material
            .0
            .filter(|_| is_side)
            .map(|face| ("surface", level - face * level.signum())),
    ];
    for (class, radius) in circles.into_iter().flatten() {
        let points = circle(radius).map(|(angle, radius)| at(angle, radius));
        frame::line(&mut inside, class, points);
    }
    let (middle, up, right) = (at(0.0, 0.0), at(0.0, rim), at(90.0, rim));
    let (down, left) = (at(180.0, rim), at(270.0, rim));
    frame::line(&mut inside, "centre", [up, middle, down]);
    frame::line(&mut inside, "centre", [left, middle, right]);
    let line = drilled.pecks.first().map_or(0, |peck| peck.line);
    let mut taken: Vec<(f64, f64)> = Vec::new();
    for (number, hole) in (1..).zip(&drilled.holes) {
        let (from, to) = if is_side {
            (level, level - drilled.bottom * level.signum())
        } else {
            (0.97 * hole.radius, 1.03 * hole.radius)
        };
        let angle = measured(hole.angle);
        let words = match lang {
            Lang::En => format!("hole {number} at C{angle}, "),
            Lang::Zh => format!("第 {number} 孔在 C{angle}，"),
        };
        let way = [from, to].map(|radius| at(hole.angle, radius));
        inside.append(told("line feed", way, &words, line, lang));
        // Outside of the circle, as far as a label is wide and high.
        let (x, y) = at(hole.angle, rim * from.signum());
        let (sin, cos) = hole.angle.to_radians().sin_cos();
        let (x, y) = (
            x + 24.0 * sin * from.signum(),
            y - 14.0 * cos * from.signum(),
        );
        let is_free = |(x2, y2): &(f64, f64)| (x2 - x).abs() > 40.0 || (y2 - y).abs() > 14.0;
        if taken.iter().all(is_free) {
            taken.push((x, y));
            inside.append(text(x, y + 4.5, "below", &format!("C{angle}")));
        }
    }
    document.append(inside);
    let words = pick(
        lang,
        "holes by C, seen along the axis of the part",
        "各孔的 C 角，沿工件轴线看",
    );
    document.append(text(area.left, area.top - 8.0, "key", words));
}
