//! Material as columns: each holds the height up to which it stands, and a move takes away what is above the tool.
//!
//! The judge of random contours. It calculates in `f64` and shares no code with the cycles.

use super::case::{Case, Random};
use crate::contour::{Allowance, Contour};
use crate::plane::{Element, Point, Shape};

/// What rounding to nanometres may change, nm.
pub const SLACK: f64 = 2.0;

/// How far along the strokes rounding may move a wall, nm.
pub const ASIDE: f64 = 3.0;

/// A move or a piece of a contour between two places.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    pub from: (f64, f64),
    pub to: (f64, f64),
    /// The centre, and +1 for the upper half of the circle.
    pub arc: Option<((f64, f64), f64)>,
    pub rapid: bool,
}

impl Way {
    pub fn of(case: &Case, from: Point, element: &Element) -> Self {
        let arc = match element.shape {
            Shape::Arc { i, k, clockwise } => {
                let centre = case.place(Point {
                    x: from.x + i,
                    z: from.z + k,
                });
                let over = case.over_is_clockwise() == clockwise;
                Some((centre, if over { 1.0 } else { -1.0 }))
            }
            _ => None,
        };
        Self {
            from: case.place(from),
            to: case.place(element.end),
            arc,
            rapid: element.shape == Shape::Rapid,
        }
    }

    /// The height at a place strictly between the ends.
    pub fn height(&self, l: f64) -> Option<f64> {
        self.grown(l, 0.0)
    }

    /// The same with a radius that is larger by `more`.
    fn grown(&self, l: f64, more: f64) -> Option<f64> {
        let ((h0, l0), (h1, l1)) = (self.from, self.to);
        if !(l0.min(l1) < l && l < l0.max(l1)) {
            return None;
        }
        Some(match self.arc {
            Some(((ch, cl), side)) => {
                let (a, b) = (h0 - ch, l0 - cl);
                let radius = a.hypot(b) + more;
                let square = (radius - (l - cl)) * (radius + (l - cl));
                ch + side * square.max(0.0).sqrt()
            }
            None => h0 + (h1 - h0) * (l - l0) / (l1 - l0),
        })
    }
}

/// The lowest and the highest place of a path near `l`. An arc that begins at a rounded place has a radius that is up to
/// 1 nm off.
pub fn near(path: &[Way], l: f64) -> (f64, f64) {
    let sides = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| l + part * ASIDE);
    let on = path.iter().flat_map(|way| {
        let ends = [way.from, way.to];
        let ends = ends.into_iter().filter(|end| (end.1 - l).abs() <= ASIDE);
        let ends = ends.map(|end| end.0).collect::<Vec<_>>();
        sides
            .iter()
            .flat_map(|side| [-1.0, 0.0, 1.0].map(|more| way.grown(*side, more)))
            .flatten()
            .chain(ends)
            .collect::<Vec<_>>()
    });
    on.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
        (low.min(h), high.max(h))
    })
}

pub struct Columns {
    /// Each with its place, the height of its material, and the contour near it.
    pub all: Vec<(f64, f64, (f64, f64))>,
}

impl Columns {
    pub fn new(part: &[Way], moves: &[Way], start: (f64, f64), random: &mut Random) -> Self {
        let end = part.last().expect("a piece").to.1;
        let mut places: Vec<f64> = part
            .iter()
            .chain(moves)
            .flat_map(|way| [-5.3, -0.7, 0.7, 5.3].map(|aside| way.to.1 + aside))
            .collect();
        for _ in 0..100 {
            let share = random.within(1, 999_999) as f64 / 1e6;
            places.push(start.1 + (end - start.1) * share);
        }
        places.retain(|l| *l > start.1 && *l < end);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let column = |l| {
            let near = near(part, l);
            (l, start.0.max(near.1), near)
        };
        Self {
            all: places.into_iter().map(column).collect(),
        }
    }

    pub fn go(&mut self, way: &Way, depth: f64) -> Result<(), String> {
        let (low, high) = (way.from.1.min(way.to.1), way.from.1.max(way.to.1));
        let below = self.all.partition_point(|column| column.0 <= low);
        for column in &mut self.all[below..] {
            if column.0 >= high {
                break;
            }
            let Some(h) = way.height(column.0) else {
                continue;
            };
            if h < column.2.0 - SLACK {
                return Err(format!(
                    "cuts into the contour by {} at {}",
                    column.2.0 - h,
                    column.0
                ));
            }
            let spread = column.2.1 - column.2.0;
            if way.rapid && h < column.1 - SLACK - spread {
                return Err(format!("rapid through {} at {}", column.1 - h, column.0));
            }
            if column.1 - h > depth + SLACK + spread {
                return Err(format!("cuts {} deep at {}", column.1 - h, column.0));
            }
            column.1 = column.1.min(h);
        }
        if low.to_bits() == high.to_bits() && way.rapid {
            self.upright(way, low, below)?;
        }
        Ok(())
    }

    /// A rapid that is upright needs room on one of its sides, or is at an end of the material.
    fn upright(&self, way: &Way, l: f64, below: usize) -> Result<(), String> {
        let h = way.from.0.min(way.to.0) + SLACK;
        let free = |column: Option<&(f64, f64, (f64, f64))>| {
            column
                .is_none_or(|(at, top, near)| (at - l).abs() <= 6.0 && *top <= h + near.1 - near.0)
        };
        let before = below.checked_sub(1).and_then(|it| self.all.get(it));
        if free(before) || free(self.all.get(below)) {
            return Ok(());
        }
        Err(format!("an upright rapid in material at {l}"))
    }
}

/// The contour with an allowance.
pub fn shifted(case: &Case, contour: &Contour, allowance: &Allowance) -> Vec<Way> {
    let mut from = allowance.shift(contour.start());
    let elements = contour.elements().iter();
    let ways = elements.map(|element| {
        let end = allowance.shift(element.end);
        let way = Way::of(case, from, &Element { end, ..*element });
        from = end;
        way
    });
    ways.collect()
}
