//! The tool path in the trade's convention: Z to the right, X upwards as a diameter, both to one scale so that a 45°
//! chamfer looks like one.

use std::collections::HashSet;

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{Circle, ClipPath, Group, Path, Rectangle};

use super::frame::{self, LEFT, RIGHT};
use super::scale::Scale;
use super::{Picture, px, text};
use crate::words::pick;

/// What a stroke is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Not cutting.
    Rapid,
    /// Cutting at a feed.
    Feed,
    /// Locked to the spindle.
    Thread,
    /// In a hole, axis and spindle together.
    Tap,
}

impl Kind {
    /// Its name in styles.
    pub fn class(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Feed => "feed",
            Self::Thread => "thread",
            Self::Tap => "tap",
        }
    }
}

/// One move: where it goes through, as (Z, radius) in millimetres, its start first.
#[derive(Clone, Debug)]
pub struct Stroke {
    /// What it is.
    pub kind: Kind,
    /// The line of the program's own file; 0 for a line of another file.
    pub line: u32,
    /// At least two points.
    pub points: Vec<(f64, f64)>,
}

/// A warning of a move. Places are Z and radius in millimetres of the work.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its number.
    pub number: u16,
    /// The line of the program, with the name of the file where that is another.
    pub line: String,
    /// The line in the program's own file; 0 for a line of another file.
    pub row: u32,
    /// What is wrong.
    pub words: String,
    /// The move goes through the material and does not cut.
    pub is_rapid: bool,
    /// From where to where the move goes.
    pub way: [(f64, f64); 2],
    /// Where the warning is.
    pub at: (f64, f64),
}

/// A bar or a tube before the first cut, in millimetres of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// Outer radius.
    pub outside: f64,
    /// Radius of the hole that is there already; 0 where there is none.
    pub bore: f64,
    /// Z of its face.
    pub face: f64,
    /// From the face toward the chuck.
    pub length: f64,
}

/// The tallest the drawing gets; a longer part is scaled to the width.
const TALLEST: f64 = 470.0;
const SHORTEST: f64 = 200.0;

/// How much of the path a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// All of it, the way from the tool change included.
    Whole,
    /// The part: what is cut, and as much of the rapids as falls into that.
    Part,
}

/// Lowest and highest point of strokes, with the origin where there are none.
fn bounds<'a>(strokes: impl Iterator<Item = &'a Stroke>) -> ((f64, f64), (f64, f64)) {
    let all = strokes.flat_map(|stroke| &stroke.points);
    let (mut low, mut high) = ((0.0f64, 0.0f64), (0.0f64, 0.0f64));
    for (n, &(z, x)) in all.enumerate() {
        if n == 0 {
            (low, high) = ((z, x), (z, x));
        }
        low = (low.0.min(z), low.1.min(x));
        high = (high.0.max(z), high.1.max(x));
    }
    (low, high)
}

/// Draws the panel at `top` and returns its lower edge.
pub(super) fn draw(document: &mut Group, top: f64, picture: &Picture) -> f64 {
    let (strokes, view, lang) = (&picture.path[..], picture.view, picture.lang);
    let cuts = |stroke: &&Stroke| stroke.kind != Kind::Rapid;
    let part = view == View::Part && strokes.iter().any(|stroke| cuts(&stroke));
    let (mut low, mut high) = if part {
        bounds(strokes.iter().filter(cuts))
    } else {
        bounds(strokes.iter())
    };
    if let Some(stock) = &picture.stock {
        low = (low.0.min(stock.face - stock.length), low.1.min(stock.bore));
        high = (high.0.max(stock.face), high.1.max(stock.outside));
    }
    // The centre line belongs to the picture unless the part is far away from it.
    if low.1 > 0.0 && low.1 < 3.0 * (high.1 - low.1).max(1.0) {
        low.1 = 0.0;
    }
    if part {
        // Room for the way in and out.
        let room = 0.08 * (high.0 - low.0).max(high.1 - low.1);
        (low.0, high.0, high.1) = (low.0 - room, high.0 + room, high.1 + room);
    }
    let (length, height) = ((high.0 - low.0).max(1.0), (high.1 - low.1).max(1.0));
    let (pad, room) = (26.0, RIGHT - LEFT);
    let mm = ((room - 2.0 * pad) / length).min((TALLEST - 2.0 * pad) / height);
    let panel = (height * mm + 2.0 * pad).clamp(SHORTEST, TALLEST);
    let bottom = top + panel;
    // One scale for both axes, the drawing in the middle of the panel.
    let middle = ((low.0 + high.0) / 2.0, (low.1 + high.1) / 2.0);
    let (half_z, half_x) = (room / 2.0 / mm, panel / 2.0 / mm);
    let z = Scale::new(middle.0 - half_z, middle.0 + half_z, LEFT, RIGHT);
    // Labels are diameters, drawn radii.
    let x = Scale::new(
        2.0 * (middle.1 - half_x),
        2.0 * (middle.1 + half_x),
        bottom,
        top,
    );

    frame::panel(document, top, bottom);
    frame::columns(document, &z, top, bottom, true);
    frame::rows(document, &x, panel / 45.0);
    if middle.1 - half_x <= 0.0 && middle.1 + half_x >= 0.0 {
        frame::line(document, "centre", [(LEFT, x.px(0.0)), (RIGHT, x.px(0.0))]);
    }
    let place = |(at_z, radius): (f64, f64)| (z.px(at_z), x.px(2.0 * radius));
    if let Some(stock) = &picture.stock {
        let (left, upper) = place((stock.face - stock.length, stock.outside));
        let (right, lower) = place((stock.face, stock.bore));
        document.append(
            Rectangle::new()
                .set("class", "stock")
                .set("x", px(left))
                .set("y", px(upper))
                .set("width", px(right - left))
                .set("height", px(lower - upper)),
        );
    }
    if part {
        let mut inside = Group::new().set("clip-path", "url(#inside)");
        strokes_in_layers(&mut inside, strokes, place);
        let edge = frame::edge(top, bottom);
        document.append(ClipPath::new().set("id", "inside").add(edge));
        document.append(inside);
    } else {
        strokes_in_layers(document, strokes, place);
    }

    warnings(document, top, picture, place);
    document.append(text(LEFT - 8.0, top - 8.0, "left name", "X ⌀ mm"));
    document.append(text(RIGHT + 8.0, bottom + 18.0, "right name", "Z mm"));
    let marks = marks(strokes, |point| {
        let (x, y) = place(point);
        ((LEFT..=RIGHT).contains(&x) && (top..=bottom).contains(&y)).then_some((x, y))
    });
    legend(document, top - 8.0, strokes, &marks, lang);
    for (class, at) in marks {
        dot(document, at, class);
    }
    bottom + 18.0
}

/// The most lines that are told of rapids: more would lie upon the path.
const LISTED: usize = 4;

/// Warnings in the order of the program: each of a line once.
fn once(marks: &[Mark]) -> Vec<&Mark> {
    let mut told: Vec<&Mark> = Vec::new();
    for mark in marks {
        let is_same = |known: &&Mark| (known.number, &known.line) == (mark.number, &mark.line);
        if !told.iter().any(is_same) {
            told.push(mark);
        }
    }
    told
}

/// All warnings in words, with their rows; of a kind at most `most`.
pub(super) fn told(marks: &[Mark], most: usize, lang: Lang) -> Vec<(u32, String)> {
    let mut left = once(marks);
    // Those that break a tool first.
    left.sort_by_key(|mark| !mark.is_rapid);
    let mut lines = Vec::new();
    while let Some(first) = left.first() {
        let number = first.number;
        let (kind, others): (Vec<_>, Vec<_>) =
            left.into_iter().partition(|mark| mark.number == number);
        lines.extend(in_words(&kind, most, lang));
        left = others;
    }
    let row = |(mark, words): (&Mark, String)| (mark.row, words);
    lines.into_iter().map(row).collect()
}

/// A text for each of some warnings of one kind. Of more than `most` the last text tells how many are left, and where; it
/// stands with the first of them.
fn in_words<'a>(marks: &[&'a Mark], most: usize, lang: Lang) -> Vec<(&'a Mark, String)> {
    let shown = if marks.len() > most {
        most - 1
    } else {
        marks.len()
    };
    let (shown, left) = marks.split_at(shown);
    let mut lines = Vec::new();
    for mark in shown {
        let Mark { line, words, .. } = mark;
        let text = match lang {
            Lang::En => format!("⚠ line {line}: {words}"),
            Lang::Zh => format!("⚠ 第 {line} 行：{words}"),
        };
        lines.push((*mark, text));
    }
    if let [first, .., last] = left {
        let (more, from, to) = (left.len(), &first.line, &last.line);
        let text = match lang {
            Lang::En => format!("⚠ and on {more} further lines, {from} to {to}"),
            Lang::Zh => format!("⚠ 另有 {more} 行，第 {from} 至 {to} 行"),
        };
        lines.push((*first, text));
    }
    lines
}

/// Rapids through the material, and the places of all warnings.
fn warnings(
    document: &mut Group,
    top: f64,
    picture: &Picture,
    place: impl Fn((f64, f64)) -> (f64, f64),
) {
    let mut numbers: Vec<(f64, f64)> = Vec::new();
    let told = once(&picture.marks);
    for mark in &picture.marks {
        if mark.is_rapid {
            frame::line(document, "missing", mark.way.map(&place));
        }
        let (x, y) = place(mark.at);
        document.append(spot((x, y)));
        if told.iter().any(|first| std::ptr::eq(*first, mark)) {
            // One upon the other they cannot be read.
            let at = (x + 7.0, y - 5.0);
            let is_near =
                |other: &(f64, f64)| (other.0 - at.0).abs() < 32.0 && (other.1 - at.1).abs() < 14.0;
            if !numbers.iter().any(is_near) {
                numbers.push(at);
                document.append(text(at.0, at.1, "warn", &mark.line));
            }
        }
    }
    let rapids: Vec<_> = told.into_iter().filter(|mark| mark.is_rapid).collect();
    let lines = in_words(&rapids, LISTED, picture.lang);
    for (n, (_, words)) in lines.iter().enumerate() {
        let y = top + 18.0 * (n as f64 + 1.0);
        document.append(text(LEFT + 10.0, y, "warn", words));
    }
}

/// The place of a warning.
fn spot((x, y): (f64, f64)) -> Circle {
    Circle::new()
        .set("class", "spot")
        .set("cx", px(x))
        .set("cy", px(y))
        .set("r", 5)
}

/// Rapids below, cuts above; neighbours of one kind share a path, and what has been drawn is not drawn again.
fn strokes_in_layers(
    document: &mut Group,
    strokes: &[Stroke],
    place: impl Fn((f64, f64)) -> (f64, f64),
) {
    for kind in [Kind::Rapid, Kind::Feed, Kind::Thread, Kind::Tap] {
        let mut drawn: HashSet<[[i64; 2]; 2]> = HashSet::new();
        let mut run: Vec<(f64, f64)> = Vec::new();
        let mut data = String::new();
        let mut finish = |run: &mut Vec<(f64, f64)>| {
            if run.len() > 1 {
                data.push_str(&super::polyline(run.drain(..)));
            }
            run.clear();
        };
        for stroke in strokes.iter().filter(|stroke| stroke.kind == kind) {
            for pair in stroke.points.windows(2) {
                let (from, to) = (place(pair[0]), place(pair[1]));
                let tenths =
                    |(x, y): (f64, f64)| [(x * 10.0).round() as i64, (y * 10.0).round() as i64];
                // There and back is one line: dashes over dashes would fill their gaps.
                let mut segment = [tenths(from), tenths(to)];
                segment.sort_unstable();
                if segment[0] == segment[1] || !drawn.insert(segment) {
                    continue;
                }
                if run.last() != Some(&from) {
                    finish(&mut run);
                    run.push(from);
                }
                run.push(to);
            }
        }
        finish(&mut run);
        if !data.is_empty() {
            document.append(
                Path::new()
                    .set("class", format!("line {}", kind.class()))
                    .set("d", data),
            );
        }
    }
}

/// The class of a dot, and where it is.
type Dot = (&'static str, (f64, f64));

fn legend(document: &mut Group, y: f64, strokes: &[Stroke], marks: &[Dot], lang: Lang) {
    let entries = [
        (Kind::Rapid, pick(lang, "rapid", "快速移动")),
        (Kind::Feed, pick(lang, "feed", "切削进给")),
        (
            Kind::Thread,
            pick(lang, "thread, locked to the spindle", "螺纹，与主轴锁定"),
        ),
        (
            Kind::Tap,
            pick(lang, "tap, axis and spindle together", "攻丝，轴与主轴联动"),
        ),
    ];
    let present: Vec<_> = entries
        .into_iter()
        .filter(|(kind, _)| strokes.iter().any(|stroke| stroke.kind == *kind))
        .collect();
    let lines: f64 = present
        .iter()
        .map(|(_, name)| 57.0 + frame::width(name))
        .sum();
    let marks: Vec<_> = [
        ("start", pick(lang, "start", "起点")),
        ("end", pick(lang, "end", "终点")),
    ]
    .into_iter()
    .filter(|(class, _)| marks.iter().any(|(shown, _)| shown == class))
    .collect();
    let dots: f64 = marks
        .iter()
        .map(|(_, name)| 38.0 + frame::width(name))
        .sum();
    let mut x = RIGHT - lines - dots + 24.0;
    for (kind, name) in present {
        x = frame::key(document, x, y, kind.class(), name);
    }
    for (class, name) in marks {
        dot(document, (x + 5.0, y - 4.5), class);
        document.append(text(x + 14.0, y, "key", name));
        x += 38.0 + frame::width(name);
    }
}

/// Start and end, where `place` shows them.
fn marks(strokes: &[Stroke], place: impl Fn((f64, f64)) -> Option<(f64, f64)>) -> Vec<Dot> {
    let first = strokes.first().and_then(|stroke| stroke.points.first());
    let last = strokes.last().and_then(|stroke| stroke.points.last());
    [("start", first), ("end", last)]
        .into_iter()
        .filter_map(|(class, point)| Some((class, place(*point?)?)))
        .collect()
}

fn dot(document: &mut Group, (x, y): (f64, f64), class: &str) {
    let radius = if class == "start" { 6.0 } else { 4.0 };
    document.append(
        Circle::new()
            .set("class", class)
            .set("cx", px(x))
            .set("cy", px(y))
            .set("r", px(radius)),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_told_kind_by_kind_rapids_first_and_each_line_once() {
        let mark = |number: u16, row: u32, is_rapid: bool| Mark {
            number,
            line: row.to_string(),
            row,
            words: format!("of {number}"),
            is_rapid,
            way: [(0.0, 0.0), (1.0, 1.0)],
            at: (0.5, 0.5),
        };
        let mut marks = vec![mark(1, 3, false), mark(2, 4, true), mark(2, 4, true)];
        marks.extend((10..21).map(|row| mark(1, row, false)));
        let told = told(&marks, 10, Lang::En);
        assert_eq!(told.len(), 1 + 10);
        assert_eq!(told[0], (4, "⚠ line 4: of 2".into()));
        assert_eq!(told[1], (3, "⚠ line 3: of 1".into()));
        let last = "⚠ and on 3 further lines, 18 to 20".into();
        assert_eq!(told.last(), Some(&(18, last)));
        let zh = super::told(&marks[..1], 10, Lang::Zh);
        assert_eq!(zh, [(3, "⚠ 第 3 行：of 1".into())]);
    }
}
