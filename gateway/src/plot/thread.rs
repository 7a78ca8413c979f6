//! The picture of what was measured: the axial section with the profiles that it is compared with, flanks near by, the
//! error over the turns or along the contour, and the chip of each pass. Turns numbers into one SVG document.

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{ClipPath, Group, Rectangle};

use super::frame::{self, LEFT, RIGHT};
use super::scale::Scale;
use super::{Across, MARGIN, TITLE, document, px, simplified, text};
use crate::words::pick;

/// What a curve in the section is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// What was cut.
    Cut,
    /// What was programmed.
    Programmed,
    /// The basic profile.
    Basic,
    /// The limit of most material: the GO gauge.
    Most,
    /// The limit of least material.
    Least,
}

impl Line {
    const fn class(self) -> &'static str {
        match self {
            Self::Cut => "cut",
            Self::Programmed | Self::Basic => "basic",
            Self::Most => "most",
            Self::Least => "least",
        }
    }

    fn name(self, lang: Lang) -> &'static str {
        match self {
            Self::Cut => pick(lang, "cut", "切出"),
            Self::Programmed => pick(lang, "programmed", "编程"),
            Self::Basic => pick(lang, "basic profile", "基本牙型"),
            Self::Most => pick(lang, "most material", "最大实体"),
            Self::Least => pick(lang, "least material", "最小实体"),
        }
    }
}

/// A curve of the section: Z and radius, millimetres.
#[derive(Clone, Debug)]
pub struct Curve {
    /// What it is.
    pub line: Line,
    /// Its points by rising Z.
    pub points: Vec<(f64, f64)>,
}

/// The chip of a pass: its number, mm³ towards −Z and +Z.
#[derive(Clone, Copy, Debug)]
pub struct Chip {
    /// Number of the pass.
    pub pass: u32,
    /// Towards −Z.
    pub minus: f64,
    /// Towards +Z.
    pub plus: f64,
}

/// What an error is told over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Turns of a thread: the distance from its helix.
    Helix,
    /// Millimetres of a contour: the distance square to it.
    Contour,
}

/// An error over turns or millimetres.
#[derive(Clone, Debug)]
pub struct Course {
    /// What it is told over.
    pub along: Along,
    /// Each with its error in micrometres.
    pub points: Vec<(f64, f64)>,
}

/// One thread, groove or contour.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Its name.
    pub name: String,
    /// Its figures.
    pub figures: String,
    /// What is upwards in the section.
    pub across: Across,
    /// The section.
    pub curves: Vec<Curve>,
    /// From and to Z of what is shown near by.
    pub near: (f64, f64),
    /// Its error.
    pub course: Option<Course>,
    /// The passes.
    pub chips: Vec<Chip>,
}

/// The tallest a section gets.
const TALLEST: f64 = 420.0;
const COURSE: f64 = 120.0;
const CHIPS: f64 = 110.0;

/// The SVG document of all that was measured of a program.
#[must_use]
pub fn svg(title: &str, sheets: &[Sheet], lang: Lang) -> String {
    let mut body = Group::new();
    let mut top = TITLE - 20.0;
    for (n, sheet) in sheets.iter().enumerate() {
        top = draw(&mut body, top, n, sheet, lang);
    }
    let style = concat!(include_str!("style.css"), include_str!("thread.css"));
    let head = [text(MARGIN, 36.0, "title", title)];
    document(style, &head, body, top + 10.0)
}

/// One of them; returns the lower edge.
fn draw(body: &mut Group, top: f64, n: usize, sheet: &Sheet, lang: Lang) -> f64 {
    body.append(text(MARGIN, top, "sheet", &sheet.name));
    body.append(text(MARGIN, top + 22.0, "subtitle", &sheet.figures));
    let mut bottom = top + 30.0;
    let cut = || sheet.curves.iter().filter(|curve| curve.line == Line::Cut);
    let ends = cut()
        .flat_map(|curve| [curve.points.first(), curve.points.last()])
        .flatten();
    let (from, to) = range(ends.map(|point| point.0));
    let mut room = 30.0;
    if to > from && (from, to) != sheet.near {
        let whole: Vec<&Curve> = cut().collect();
        bottom = section(
            body,
            bottom + 30.0,
            (from, to),
            (sheet.across, &whole),
            &format!("w{n}"),
            lang,
        );
        room = 52.0;
    }
    if sheet.near.1 > sheet.near.0 {
        let all: Vec<&Curve> = sheet.curves.iter().collect();
        bottom = section(
            body,
            bottom + room,
            sheet.near,
            (sheet.across, &all),
            &format!("n{n}"),
            lang,
        );
    }
    if let Some(errors) = sheet
        .course
        .as_ref()
        .filter(|course| course.points.len() > 1)
    {
        bottom = course(body, bottom + 52.0, errors, lang);
    }
    if !sheet.chips.is_empty() {
        bottom = chips(body, bottom + 52.0, &sheet.chips, lang);
    }
    bottom + 64.0
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    })
}

/// A section between two places along it, both axes to one scale.
fn section(
    body: &mut Group,
    top: f64,
    (from, to): (f64, f64),
    (across, curves): (Across, &[&Curve]),
    id: &str,
    lang: Lang,
) -> f64 {
    let inside = |point: &&(f64, f64)| point.0 >= from && point.0 <= to;
    let seen = curves
        .iter()
        .flat_map(|curve| curve.points.iter().filter(inside));
    let (low, high) = range(seen.map(|point| point.1));
    let room = 0.08 * (high - low).max(0.01);
    let (low, high) = (low - room, high + room);
    let width = RIGHT - LEFT;
    let height = ((high - low) / (to - from) * width).clamp(40.0, TALLEST);
    // Where the height is cut down, there is room at either side.
    let shown = width * height / ((high - low) / (to - from) * width).max(height);
    let bottom = top + height;
    let (along, up) = across.written();
    let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0 * width / shown);
    let ends = [middle - half, middle + half].map(|end| along * end);
    let z = Scale::new(ends[0], ends[1], LEFT, RIGHT);
    let x = Scale::new(up * low, up * high, bottom, top);
    frame::panel(body, top, bottom);
    frame::columns(body, &z, top, bottom, true);
    frame::rows(body, &x, (height / 40.0).max(2.0));
    body.append(ClipPath::new().set("id", id).add(frame::edge(top, bottom)));
    let mut drawn = Group::new().set("clip-path", format!("url(#{id})"));
    for curve in curves {
        let pixels: Vec<(f64, f64)> = curve
            .points
            .iter()
            .filter(|point| {
                point.0 >= from - 0.1 * (to - from) && point.0 <= to + 0.1 * (to - from)
            })
            .map(|(at, radius)| (z.px(along * at), x.px(up * radius)))
            .collect();
        let class = format!("line {}", curve.line.class());
        frame::line(&mut drawn, &class, simplified(&pixels, 0.1));
    }
    body.append(drawn);
    let (right_name, up_name) = match across {
        Across::X => ("Z", "Ø"),
        Across::Z => ("Ø", "Z"),
    };
    body.append(text(LEFT - 8.0, top - 8.0, "left name", up_name));
    body.append(text(RIGHT + 14.0, bottom + 18.0, "right name", right_name));
    let mut at = LEFT + 4.0;
    for (n, curve) in curves.iter().enumerate() {
        // A contour has many of one kind.
        if curves[..n].iter().any(|other| other.line == curve.line) {
            continue;
        }
        let name = curve.line.name(lang);
        at = frame::key(body, at, top - 8.0, curve.line.class(), name);
    }
    bottom
}

/// An error over the turns, or along the contour.
fn course(body: &mut Group, top: f64, course: &Course, lang: Lang) -> f64 {
    let points = &course.points;
    let (name, unit) = match course.along {
        Along::Helix => (
            pick(
                lang,
                "distance from the nominal helix",
                "与理论螺旋线的偏差",
            ),
            pick(lang, "turn", "圈"),
        ),
        Along::Contour => (
            pick(
                lang,
                "distance from the programmed contour, along it; +: material left",
                "沿轮廓与编程轮廓的法向偏差；+：余料",
            ),
            "mm",
        ),
    };
    let bottom = top + COURSE;
    let (first, last) = range(points.iter().map(|point| point.0));
    let (low, high) = range(points.iter().map(|point| point.1));
    // A perfect lead is a line, not a picture of the last digits.
    let (low, high) = (low.min(-0.5), high.max(0.5));
    let turns = Scale::new(first, last, LEFT, RIGHT);
    let off = Scale::new(low, high, bottom - 8.0, top + 8.0);
    frame::panel(body, top, bottom);
    frame::columns(body, &turns, top, bottom, true);
    frame::rows(body, &off, 5.0);
    let pixels: Vec<(f64, f64)> = points
        .iter()
        .map(|p| (turns.px(p.0), off.px(p.1)))
        .collect();
    frame::line(body, "line off", simplified(&pixels, 0.1));
    body.append(text(LEFT - 8.0, top - 8.0, "left name", "µm"));
    body.append(text(RIGHT + 14.0, bottom + 18.0, "right name", unit));
    frame::key(body, LEFT + 4.0, top - 8.0, "off", name);
    bottom
}

/// A pair of bars for each pass.
fn chips(body: &mut Group, top: f64, chips: &[Chip], lang: Lang) -> f64 {
    let bottom = top + CHIPS;
    let most = chips
        .iter()
        .map(|chip| chip.minus.max(chip.plus))
        .fold(0.0, f64::max);
    let volume = Scale::new(0.0, most.max(0.1), bottom, top + 8.0);
    frame::panel(body, top, bottom);
    frame::rows(body, &volume, 4.0);
    let step = (RIGHT - LEFT) / chips.len() as f64;
    let wide = (step * 0.36).min(40.0);
    for (n, chip) in chips.iter().enumerate() {
        let middle = LEFT + step * (n as f64 + 0.5);
        for (class, value, left) in [
            ("minus", chip.minus, middle - wide),
            ("plus", chip.plus, middle),
        ] {
            let high = volume.px(value);
            body.append(
                Rectangle::new()
                    .set("class", class)
                    .set("x", px(left))
                    .set("y", px(high))
                    .set("width", px(wide))
                    .set("height", px(bottom - high)),
            );
        }
        // Numbers stand apart.
        if n % (1 + chips.len() / 40) == 0 {
            body.append(text(middle, bottom + 18.0, "below", &chip.pass.to_string()));
        }
    }
    body.append(text(LEFT - 8.0, top - 8.0, "left name", "mm³"));
    body.append(text(
        RIGHT + 14.0,
        bottom + 18.0,
        "right name",
        pick(lang, "pass", "走刀"),
    ));
    frame::keys(
        body,
        LEFT + 4.0,
        top - 8.0,
        [
            ("minus", pick(lang, "chip towards -Z", "-Z 侧切屑")),
            ("plus", pick(lang, "chip towards +Z", "+Z 侧切屑")),
        ],
    );
    bottom
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_of_nothing_is_a_picture() {
        let sheet = Sheet {
            name: "<M1>".into(),
            figures: String::new(),
            across: Across::X,
            curves: Vec::new(),
            near: (0.0, 0.0),
            course: None,
            chips: Vec::new(),
        };
        let drawn = svg("a & b", &[sheet], Lang::En);
        assert!(
            drawn.starts_with("<svg ") && drawn.contains("&lt;M1&gt;"),
            "{drawn}"
        );
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
    }
}
