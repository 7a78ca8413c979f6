//! A groove near by: what each column takes with the width of the tool, its pecks, and its bottom.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{Group, Rectangle};

use super::pane::{Area, Pane, Range};
use super::told;
use crate::number::measured;
use crate::plot::{px, text};
use crate::words::pick;

/// A column: the feeds at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its number from 1.
    pub number: u32,
    /// The line of the program as the machine counts it.
    pub line: u32,
    /// Where the first feed begins: Z, radius.
    pub from: (f64, f64),
    /// The ends of its feeds: Z, radius.
    pub pecks: Vec<(f64, f64)>,
}

impl Column {
    /// Its bottom: Z, radius.
    pub fn bottom(&self) -> (f64, f64) {
        self.pecks.last().copied().unwrap_or(self.from)
    }
}

/// A groove along X.
#[derive(Clone, Debug)]
pub struct Groove {
    /// In the order of cutting.
    pub columns: Vec<Column>,
    /// Width of the tool in millimetres from its programmed corner toward +Z, where it is known.
    pub width: Option<f64>,
}

/// Draws the view.
pub(super) fn draw(document: &mut Group, area: Area, groove: &Groove, n: usize, lang: Lang) {
    let wide = groove.width.unwrap_or(0.0);
    let corners = groove.columns.iter().flat_map(|column| {
        let (z, radius) = column.bottom();
        [column.from, (z, radius), (z + wide, radius)]
    });
    let Some(range) = Range::of(corners) else {
        return;
    };
    let pane = Pane::true_to_scale(area, range.with_room(0.15, 0.12), format!("groove{n}"));
    let mut inside = pane.frame(document);
    for column in &groove.columns {
        let ((left, top), (right, bottom)) = (
            pane.place(column.from),
            pane.place((column.bottom().0 + wide, column.bottom().1)),
        );
        if wide > 0.0 {
            inside.append(
                Rectangle::new()
                    .set("class", "blade")
                    .set("x", px(left))
                    .set("y", px(top.min(bottom)))
                    .set("width", px(right - left))
                    .set("height", px((bottom - top).abs())),
            );
        }
        let way = [column.from, column.bottom()].map(|point| pane.place(point));
        let number = match lang {
            Lang::En => format!("column {}, ", column.number),
            Lang::Zh => format!("第 {} 列，", column.number),
        };
        inside.append(told("line feed", way, &number, column.line, lang));
        for (n, peck) in column.pecks.iter().enumerate() {
            let (at, y) = pane.place(*peck);
            let half = ((right - left) / 2.0).clamp(0.0, 4.0);
            let end = if wide > 0.0 {
                at + 2.0 * half
            } else {
                at + 4.0
            };
            let words = match lang {
                Lang::En => format!("{number}feed {} to X{}, ", n + 1, measured(2.0 * peck.1)),
                Lang::Zh => format!(
                    "{number}第 {} 次进给至 X{}，",
                    n + 1,
                    measured(2.0 * peck.1)
                ),
            };
            let end = [(at, y), (end, y)];
            inside.append(told("line peck", end, &words, column.line, lang));
        }
    }
    document.append(inside);
    numbers(document, &pane, groove);
    let words = pick(lang, "columns, to scale", "各列，按比例");
    document.append(text(area.left, area.top - 8.0, "key", words));
}

/// Numbers of the columns below their bottoms, where they have room.
fn numbers(document: &mut Group, pane: &Pane, groove: &Groove) {
    let wide = groove.width.unwrap_or(0.0) / 2.0;
    let mut taken: Vec<f64> = Vec::new();
    let last = groove.columns.len().saturating_sub(1);
    let order = [0, last].into_iter().chain(1..last);
    for column in order.filter_map(|n| groove.columns.get(n)) {
        let (z, radius) = column.bottom();
        let (at, y) = pane.place((z + wide, radius));
        if taken.iter().all(|other| (other - at).abs() >= 22.0) {
            taken.push(at);
            let inside = (y + 15.0).min(pane.area.bottom - 3.0);
            document.append(text(at, inside, "below", &column.number.to_string()));
        }
    }
}
