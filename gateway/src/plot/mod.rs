//! The picture of a program: the tool path as the trade draws it, and what the machine did over time. Turns numbers into
//! one SVG document; knows nothing of programs or machines.

mod cut;
mod frame;
mod path;
mod scale;
mod series;
mod thread;
mod time;

pub use cut::{
    Across, Column, Contour, Drilled, Feature, Groove, Hole, Pass, Peck, Phase, Piece, Reversal,
    Shape, Tap, TapStroke, Thread,
};
pub use path::{Kind, Mark, Stock, Stroke, View};
pub use series::{Envelope, Sample};
pub use thread::{Along, Chip, Course, Curve, Line, Sheet, svg};

use leadscrew_core::alarm::Lang;
use svg::node::element::{Group, Rectangle, Style, Text};
use svg::{Document, Node as _};

/// Width of the document in pixels; heights follow from the content.
const WIDTH: f64 = 1280.0;
/// Room for labels left and right of every panel.
const MARGIN: f64 = 76.0;
/// Height of the title block.
const TITLE: f64 = 104.0;

/// Everything that goes into a picture.
#[derive(Debug)]
pub struct Picture {
    /// First line.
    pub title: String,
    /// Second line: the figures.
    pub subtitle: String,
    /// Language of the labels.
    pub lang: Lang,
    /// The tool path in the order of execution.
    pub path: Vec<Stroke>,
    /// How much of the path is shown.
    pub view: View,
    /// What there is before the first cut, where it is known.
    pub stock: Option<Stock>,
    /// Where warnings of moves are.
    pub marks: Vec<Mark>,
    /// The spindle has no ripple.
    pub ideal: bool,
    /// What is cut, near by.
    pub features: Vec<Feature>,
    /// What the machine did over time; `None` where it did nothing.
    pub series: Option<Envelope>,
}

impl Picture {
    /// The SVG document.
    pub fn svg(&self) -> String {
        let mut body = Group::new();
        let mut top = path::draw(&mut body, TITLE, self);
        top = cut::draw(&mut body, top + 20.0, &self.features, self.ideal, self.lang);
        if let Some(series) = &self.series {
            top = time::draw(&mut body, top + 34.0, series, self.lang) + 18.0;
        }
        let title = text(MARGIN, 36.0, "title", &self.title);
        let subtitle = text(MARGIN, 60.0, "subtitle", &self.subtitle);
        document(STYLE, &[title, subtitle], body, top + 36.0)
    }

    /// The warnings of its path in words, each with its line of the program's own file, or 0. Rapids through the material
    /// come first. Of a kind at most this many.
    pub fn told(&self, most: usize) -> Vec<(u32, String)> {
        path::told(&self.marks, most, self.lang)
    }

    /// What is cut, alone, as SVG.
    pub fn cuts(&self) -> Option<String> {
        if self.features.is_empty() {
            return None;
        }
        let mut body = Group::new();
        let bottom = cut::draw(&mut body, 0.0, &self.features, self.ideal, self.lang);
        Some(document(STYLE, &[], body, bottom + 10.0))
    }

    /// What the machine did over time, alone, as SVG.
    pub fn over_time(&self) -> Option<String> {
        let mut body = Group::new();
        let series = self.series.as_ref()?;
        let bottom = time::draw(&mut body, 34.0, series, self.lang);
        Some(document(STYLE, &[], body, bottom + 36.0))
    }
}

const STYLE: &str = include_str!("style.css");

/// A document of this height, in pixels.
fn document(style: &str, head: &[Text], body: Group, height: f64) -> String {
    let paper = Rectangle::new()
        .set("class", "paper")
        .set("width", WIDTH)
        .set("height", height)
        .set("rx", 8);
    let mut document = Document::new()
        .set("viewBox", (0, 0, WIDTH, height))
        .set("width", WIDTH)
        .set("height", height)
        .set("role", "img")
        .add(Style::new(style))
        .add(paper);
    for text in head {
        document.append(text.clone());
    }
    document.append(body);
    format!("{document}\n")
}

/// A text of a class; its anchor is the class's.
fn text(x: f64, y: f64, class: &str, content: &str) -> Text {
    Text::new(content)
        .set("x", px(x))
        .set("y", px(y))
        .set("class", class)
}

/// A coordinate to a tenth of a pixel: finer is invisible and only makes files long.
fn px(value: f64) -> String {
    let tenths = (value * 10.0).round() as i64;
    crate::number::text::<1>(tenths)
}

/// Leaves out points that nobody would miss: within `tolerance` of the line that is drawn instead (Douglas and Peucker).
fn simplified(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let mut keep = vec![false; points.len()];
    let mut open = vec![(0, points.len().saturating_sub(1))];
    while let Some((first, last)) = open.pop() {
        let (Some(&a), Some(&b)) = (points.get(first), points.get(last)) else {
            continue;
        };
        keep[first] = true;
        keep[last] = true;
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let length = dx.hypot(dy);
        let distance = |p: (f64, f64)| {
            let (px, py) = (p.0 - a.0, p.1 - a.1);
            if length < 1e-12 {
                px.hypot(py)
            } else {
                (px * dy - py * dx).abs() / length
            }
        };
        let worst = (first + 1..last).map(|n| (n, distance(points[n])));
        if let Some((n, distance)) = worst.max_by(|a, b| a.1.total_cmp(&b.1))
            && distance > tolerance
        {
            open.push((first, n));
            open.push((n, last));
        }
    }
    let kept = points.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(point, _)| *point).collect()
}

/// The `d` of a polyline.
fn polyline(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut data = String::new();
    for (x, y) in points {
        data.push(if data.is_empty() { 'M' } else { 'L' });
        data.push_str(&px(x));
        data.push(' ');
        data.push_str(&px(y));
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simplifying_keeps_corners_and_spikes() {
        let line: Vec<_> = (0..1000)
            .map(|n| (f64::from(n), if n == 500 { 9.0 } else { 1.0 }))
            .collect();
        assert_eq!(
            simplified(&line, 0.2),
            [
                (0.0, 1.0),
                (499.0, 1.0),
                (500.0, 9.0),
                (501.0, 1.0),
                (999.0, 1.0)
            ]
        );
        assert_eq!(simplified(&[], 0.2), []);
        assert_eq!(simplified(&[(1.0, 2.0)], 0.2), [(1.0, 2.0)]);
    }

    #[test]
    fn a_picture_of_the_part_leaves_out_the_way_to_the_tool_change() {
        let stroke = |kind, points: &[(f64, f64)]| Stroke {
            kind,
            line: 1,
            points: points.to_vec(),
        };
        let path = vec![
            stroke(Kind::Rapid, &[(500.0, 300.0), (2.0, 20.0)]),
            stroke(Kind::Feed, &[(2.0, 20.0), (-40.0, 20.0)]),
        ];
        let drawn = |view| {
            Picture {
                title: String::new(),
                subtitle: String::new(),
                lang: Lang::En,
                path: path.clone(),
                view,
                features: Vec::new(),
                ideal: true,
                stock: None,
                marks: Vec::new(),
                series: None,
            }
            .svg()
        };
        let (whole, part) = (drawn(View::Whole), drawn(View::Part));
        assert!(whole.contains("class=\"start\"") && whole.contains("\n500\n"));
        assert!(!part.contains("class=\"start\"") && !part.contains("\nstart\n"));
        assert!(
            part.contains("class=\"end\"") && part.contains("\n-40\n") && !part.contains("\n100\n")
        );
        assert!(part.contains("clip-path") && !whole.contains("clip-path"));
    }

    #[test]
    fn a_picture_of_nothing_is_a_picture() {
        let picture = Picture {
            title: "<empty> & \"quoted\"".into(),
            subtitle: String::new(),
            lang: Lang::En,
            path: Vec::new(),
            view: View::Part,
            features: Vec::new(),
            ideal: true,
            stock: None,
            marks: Vec::new(),
            series: Some(Envelope::new(0.001)),
        };
        let svg = picture.svg();
        assert!(
            svg.starts_with("<svg ") && svg.contains("&lt;empty&gt; &amp; "),
            "{svg}"
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
