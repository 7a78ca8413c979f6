//! A groove near by: what each column takes with the width of the tool, its pecks, and its bottom.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{Group, Rectangle};

use super::pane::{Across, Area, Pane, Range};
use super::told;
use crate::plot::{px, text};
use crate::words::pick;

/// A column: the feeds at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its number from 1.
    pub number: u32,
    /// The line of the program as the machine counts it.
    pub line: u32,
    /// Where the first feed begins: to the right, upwards.
    pub from: (f64, f64),
    /// The ends of its feeds.
    pub pecks: Vec<(f64, f64)>,
}

impl Column {
    /// Its bottom.
    pub fn bottom(&self) -> (f64, f64) {
        self.pecks.last().copied().unwrap_or(self.from)
    }
}

/// A groove: of G75 into the outside, of G74 into the face.
#[derive(Clone, Debug)]
pub struct Groove {
    /// Where it goes into, which is upwards in its view.
    pub across: Across,
    /// In the order of cutting.
    pub columns: Vec<Column>,
    /// Width of the tool in millimetres from its programmed corner to the right, where it is known.
    pub width: Option<f64>,
}

impl Groove {
    /// A hole on the axis.
    pub fn is_drilled(&self) -> bool {
        let mut columns = self.columns.iter();
        self.across == Across::Z && columns.all(|column| column.bottom().0 == 0.0)
    }

    /// From the programmed point to the left and to the right edge of the tool.
    fn edges(&self) -> (f64, f64) {
        let wide = self.width.unwrap_or(0.0);
        if self.is_drilled() {
            (wide / 2.0, wide / 2.0)
        } else {
            (0.0, wide)
        }
    }
}

/// Draws the view.
pub(super) fn draw(document: &mut Group, area: Area, groove: &Groove, n: usize, lang: Lang) {
    let (less, more) = groove.edges();
    let wide = less + more;
    let corners = groove.columns.iter().flat_map(|column| {
        let (along, up) = column.bottom();
        [column.from, (along - less, up), (along + more, up)]
    });
    let Some(range) = Range::of(corners) else {
        return;
    };
    let range = range.with_room(0.15, 0.12);
    let pane = Pane::true_to_scale(area, groove.across, range, format!("groove{n}"));
    let mut inside = pane.frame(document);
    for column in &groove.columns {
        let ((left, top), (right, bottom)) = (
            pane.place((column.from.0 - less, column.from.1)),
            pane.place((column.bottom().0 + more, column.bottom().1)),
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
            let to = groove.across.up(peck.1);
            let words = match lang {
                Lang::En => format!("{number}feed {} to {to}, ", n + 1),
                Lang::Zh => format!("{number}第 {} 次进给至 {to}，", n + 1),
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
    let (less, more) = groove.edges();
    let middle = (more - less) / 2.0;
    let mut taken: Vec<f64> = Vec::new();
    let last = groove.columns.len().saturating_sub(1);
    let order = [0, last].into_iter().chain(1..last);
    for column in order.filter_map(|n| groove.columns.get(n)) {
        let (along, up) = column.bottom();
        let (at, y) = pane.place((along + middle, up));
        if taken.iter().all(|other| (other - at).abs() >= 22.0) {
            taken.push(at);
            let inside = (y + 15.0).min(pane.area.bottom - 3.0);
            document.append(text(at, inside, "below", &column.number.to_string()));
        }
    }
}
