//! The picture of a program: the tool path as the trade draws it, and what the machine did over time. Turns numbers into
//! one SVG document; knows nothing of programs or machines.

mod frame;
mod path;
mod scale;
mod series;
mod time;

pub use path::{Kind, Stroke};
pub use series::{Envelope, Sample};

use svg::node::element::{Group, Rectangle, Style, Text};
use svg::{Document, Node as _};

/// Width of the document in pixels; heights follow from the content.
const WIDTH: f64 = 1280.0;
/// Room for labels left and right of every panel.
const MARGIN: f64 = 76.0;
/// Height of the title block.
const TITLE: f64 = 84.0;

/// Everything that goes into a picture.
#[derive(Debug)]
pub struct Picture {
    /// First line.
    pub title: String,
    /// Second line: the figures.
    pub subtitle: String,
    /// The tool path in the order of execution.
    pub path: Vec<Stroke>,
    /// What the machine did over time.
    pub series: Envelope,
}

impl Picture {
    /// The SVG document.
    pub fn svg(&self) -> String {
        let mut document = Document::new();
        let mut top = TITLE;
        let mut body = Group::new();
        top = path::draw(&mut body, top, &self.path) + 34.0;
        top = time::speeds(&mut body, top, &self.series) + 22.0;
        top = time::synchronism(&mut body, top, &self.series);
        let height = top + 54.0;

        document.assign("viewBox", (0, 0, WIDTH, height));
        document.assign("width", WIDTH);
        document.assign("height", height);
        document.assign("role", "img");
        document.append(Style::new(include_str!("style.css")));
        document.append(
            Rectangle::new()
                .set("class", "paper")
                .set("width", WIDTH)
                .set("height", height)
                .set("rx", 8),
        );
        document.append(text(MARGIN, 36.0, "title", &self.title));
        document.append(text(MARGIN, 60.0, "subtitle", &self.subtitle));
        document.append(body);
        format!("{document}\n")
    }
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
