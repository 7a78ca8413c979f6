//! The view of the cut: each thread, groove, turned contour and hole of a program near by, with its passes and its
//! warnings. Turns numbers into a part of the picture; knows nothing of programs or machines.

mod contour;
mod depth;
mod drill;
mod groove;
mod pane;
mod phase;
mod tap;
mod thread;

pub use contour::{Contour, Piece};
pub use drill::{Drilled, Hole, Peck};
pub use groove::{Column, Groove};
pub use pane::Across;
pub use phase::Phase;
pub use tap::{Reversal, Stroke as TapStroke, Tap};
pub use thread::{Pass, Thread};

use std::ops::RangeInclusive;

use leadscrew_core::alarm::Lang;
use svg::Node as _;
use svg::node::element::{Group, Path};

use self::pane::Area;
use self::phase::Of;
use super::frame::{LEFT, RIGHT, width};
use super::{polyline, text};
use crate::place::SourceLine;

/// What is cut at a place.
#[derive(Clone, Debug)]
pub struct Feature {
    /// First line: what it is, its tool and its lines of the program.
    pub name: String,
    /// Further lines: its figures.
    pub figures: Vec<String>,
    /// The moves that a spindle is locked in, by their numbers, in their order.
    pub steps: Vec<RangeInclusive<u64>>,
    /// How far Z was from the helix over the spindle's angle, where it ran.
    pub phase: Option<Phase>,
    /// What the check warns of in its lines.
    pub warnings: Vec<String>,
    /// Its geometry.
    pub shape: Shape,
}

impl Feature {
    /// The move with this number is one of `steps`.
    pub fn is_of(&self, step: u64) -> bool {
        let next = self.steps.partition_point(|steps| *steps.end() < step);
        self.steps
            .get(next)
            .is_some_and(|steps| *steps.start() <= step)
    }
}

/// The geometry of a feature.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A thread.
    Thread(Thread),
    /// A groove: columns, each to its bottom.
    Groove(Groove),
    /// A turned contour.
    Contour(Contour),
    /// Tapped holes that are alike.
    Tap(Tap),
    /// Drilled holes with one R.
    Drilled(Drilled),
}

/// Height of a view.
const VIEW: f64 = 270.0;
/// Distance of the lines above a view.
const LINE: f64 = 18.0;
/// Shares of a whole row, and the least that one is divided into.
const ROW: usize = 4;
const LEAST: usize = 2;

impl Shape {
    /// How much of a row its view takes.
    fn share(&self) -> usize {
        match self {
            Self::Thread(_) | Self::Tap(_) => ROW,
            Self::Drilled(drilled) if drilled.is_around() => ROW,
            Self::Contour(_) | Self::Drilled(_) => 2,
            Self::Groove(_) => 1,
        }
    }
}

/// Draws all features from `top` on and returns the lower edge.
pub(super) fn draw(
    document: &mut Group,
    top: f64,
    features: &[Feature],
    ideal: bool,
    lang: Lang,
) -> f64 {
    let mut bottom = top;
    let mut number = 0;
    for row in rows(features) {
        let all: usize = row.iter().map(|feature| feature.shape.share()).sum();
        let share = (RIGHT - LEFT + 2.0 * GAP) / all.max(LEAST) as f64;
        let mut left = LEFT;
        let places: Vec<(f64, f64)> = row
            .iter()
            .map(|feature| {
                let from = left;
                left += share * feature.shape.share() as f64;
                (from, left - 2.0 * GAP)
            })
            .collect();
        let heads = row.iter().zip(&places);
        let heads = heads.map(|(feature, place)| head(document, *place, bottom, feature));
        let begin = heads.fold(bottom, f64::max) + 28.0;
        for (feature, (left, right)) in row.iter().zip(places) {
            let area = Area {
                left,
                right,
                top: begin,
                bottom: begin + VIEW,
            };
            number += 1;
            match &feature.shape {
                Shape::Thread(thread) => thread::draw(document, area, thread, number, lang),
                Shape::Groove(groove) => groove::draw(document, area, groove, number, lang),
                Shape::Contour(contour) => contour::draw(document, area, contour, number, lang),
                Shape::Tap(tap) => tap::draw(document, area, tap, number, lang),
                Shape::Drilled(drilled) => drill::draw(document, area, drilled, number, lang),
            }
        }
        bottom = begin + VIEW + 18.0;
        if let [
            Feature {
                phase: Some(phase), ..
            },
        ] = row
        {
            let of = match &row[0].shape {
                Shape::Thread(thread) if thread.across == Across::Z => Of::Thread("X"),
                Shape::Tap(tap) => Of::Tap {
                    axis: tap.axis,
                    is_rigid: tap.is_rigid,
                },
                _ => Of::Thread("Z"),
            };
            let top = bottom + 40.0;
            bottom = phase::draw(document, (LEFT, RIGHT), top, phase, of, ideal, lang);
        }
        bottom += 38.0;
    }
    bottom - 30.0
}

/// Half of the room between two views, for the labels of the right one.
const GAP: f64 = 40.0;

/// What stands beside each other, in the order of cutting.
fn rows(features: &[Feature]) -> Vec<&[Feature]> {
    let mut rows = Vec::new();
    let (mut from, mut taken) = (0, 0);
    for (n, feature) in features.iter().enumerate() {
        let share = feature.shape.share();
        if taken + share > ROW {
            rows.push(&features[from..n]);
            (from, taken) = (n, 0);
        }
        taken += share;
    }
    if from < features.len() {
        rows.push(&features[from..]);
    }
    rows
}

/// The lines above a view; returns the lower edge.
fn head(document: &mut Group, (left, right): (f64, f64), top: f64, feature: &Feature) -> f64 {
    let mut at = top;
    let figures = feature.figures.iter().map(|line| ("key", line.clone()));
    let warnings = feature
        .warnings
        .iter()
        .map(|line| ("warn", format!("⚠ {line}")));
    let name = [("name", feature.name.clone())];
    for (class, content) in name.into_iter().chain(figures).chain(warnings) {
        for line in wrapped(&content, right - left) {
            at += LINE;
            document.append(text(left, at, class, &line));
        }
    }
    at
}

/// A text in lines of at most this many pixels; words stay whole.
fn wrapped(content: &str, most: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in content.split_inclusive([' ', '，', '；', '：']) {
        if let Some(line) = lines.last_mut() {
            if line.is_empty() || width(line) + width(word) <= most {
                line.push_str(word);
            } else {
                lines.push(word.to_owned());
            }
        }
    }
    lines
}

/// A line that a page tells under the pointer: these words, and the line of the program.
fn told(
    class: &str,
    points: impl IntoIterator<Item = (f64, f64)>,
    words: &str,
    line: u32,
    lang: Lang,
) -> Path {
    let place = SourceLine(line);
    // A row of the program beside the path, where it is one.
    let row = if place.file().is_none() { line } else { 0 };
    let words = match lang {
        Lang::En => format!("{words}line {place}"),
        Lang::Zh => format!("{words}第 {place} 行"),
    };
    Path::new()
        .set("class", class)
        .set("d", polyline(points))
        .set("data-line", row)
        .set("data-told", words)
}

/// Which of some heights get a label where labels need `apart` pixels: the last, the first, and what has room between.
fn labelled(heights: &[f64], apart: f64) -> Vec<usize> {
    let Some(last) = heights.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut kept = vec![last];
    let fits = |kept: &[usize], n: usize| {
        kept.iter()
            .all(|k| (heights[*k] - heights[n]).abs() >= apart)
    };
    for n in std::iter::once(0).chain((1..last).rev()) {
        if n != last && fits(&kept, n) {
            kept.push(n);
        }
    }
    kept.sort_unstable();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_last_are_labelled_and_labels_stand_apart() {
        // Sixty passes of a thread, each of equal area: the last ones are next to each other.
        let heights: Vec<f64> = (1..=60)
            .map(|n| 200.0 * (f64::from(n) / 60.0).sqrt())
            .collect();
        let kept = labelled(&heights, 14.0);
        assert_eq!((kept.first(), kept.last()), (Some(&0), Some(&59)));
        assert!(kept.len() > 8, "{kept:?}");
        assert!(
            kept.windows(2)
                .all(|pair| heights[pair[1]] - heights[pair[0]] >= 14.0)
        );
        assert_eq!(labelled(&[1.0, 1.0], 14.0), [1]);
        assert!(labelled(&[], 14.0).is_empty());
    }

    #[test]
    fn lines_are_wrapped_between_words() {
        let lines = wrapped("one two three four", 60.0);
        assert_eq!(lines, ["one two ", "three ", "four"]);
    }
}
