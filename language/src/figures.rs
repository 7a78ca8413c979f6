//! Paths for tests: written as a letter, X as a diameter and Z (`R40,2 F40,-1 A46,-4/3cw`), or drawn by chance.

use std::f64::consts::TAU;

use leadscrew_core::alarm::Span;
use leadscrew_core::units::Length;

use crate::plane::{Element, Point, Shape};

/// A point from a diameter and Z, in millimetres.
pub(crate) fn at(diameter: f64, z: f64) -> Point {
    Point::from_nm((diameter * 5e5).round() as i64, (z * 1e6).round() as i64)
}

/// The elements of a text, from `start` on. An arc is the shorter one of its radius.
pub(crate) fn elements(start: Point, text: &str) -> Vec<Element> {
    let mut from = start;
    let read = |text: &str| text.parse::<f64>().expect("a number");
    text.split_whitespace()
        .map(|word| {
            let (letter, rest) = word.split_at(1);
            let (place, radius) = rest.split_once('/').unwrap_or((rest, ""));
            let (x, z) = place.split_once(',').expect("X and Z");
            let end = at(read(x), read(z));
            let shape = match letter {
                "R" => Shape::Rapid,
                "F" => Shape::Line,
                _ => {
                    let is_left = radius.ends_with("ccw");
                    let radius = radius.trim_end_matches(['c', 'w']);
                    arc(from, end, read(radius) * 1e6, !is_left)
                }
            };
            from = end;
            Element {
                end,
                shape,
                span: Span::default(),
            }
        })
        .collect()
}

fn arc(start: Point, end: Point, radius: f64, clockwise: bool) -> Shape {
    let (dx, dz) = way(start, end);
    let half = dx.hypot(dz) / 2.0;
    let height =
        (radius * radius - half * half).max(0.0).sqrt() * if clockwise { 1.0 } else { -1.0 };
    // To the right of the chord where it goes clockwise.
    let (right_x, right_z) = (-dz / (2.0 * half), dx / (2.0 * half));
    Shape::Arc {
        i: nm(dx / 2.0 + height * right_x),
        k: nm(dz / 2.0 + height * right_z),
        clockwise,
    }
}

pub(crate) fn nm(value: f64) -> Length {
    Length::from_nm(value.round() as i64)
}

/// (x, z) in nanometres.
pub(crate) fn way(from: Point, to: Point) -> (f64, f64) {
    ((to.x - from.x).nm() as f64, (to.z - from.z).nm() as f64)
}

/// True where both are the same, but for a nanometre.
pub(crate) fn is_same(a: &Element, b: &Element) -> bool {
    let near = |a: Length, b: Length| (a - b).nm().abs() <= 1;
    let shapes = match (a.shape, b.shape) {
        (
            Shape::Arc { i, k, clockwise },
            Shape::Arc {
                i: other_i,
                k: other_k,
                clockwise: other,
            },
        ) => near(i, other_i) && near(k, other_k) && clockwise == other,
        (a, b) => a == b,
    };
    near(a.end.x, b.end.x) && near(a.end.z, b.end.z) && shapes
}

/// Compares a path with a text.
#[track_caller]
pub(crate) fn assert_path(start: Point, path: &[Element], text: &str) {
    let expected = elements(start, text);
    let agree =
        path.len() == expected.len() && path.iter().zip(&expected).all(|(a, b)| is_same(a, b));
    assert!(agree, "expected {text}\n{expected:#?}\ngot {path:#?}");
}

/// A stroke in floating numbers, in nanometres: (x, z) of start and end, and of a centre with the signed angle
/// (positive:
/// from Z to X). It measures by sampling and by angles, unlike the geometry that is tested.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    pub(crate) start: (f64, f64),
    pub(crate) end: (f64, f64),
    pub(crate) arc: Option<((f64, f64), f64)>,
}

impl Stroke {
    pub(crate) fn new(start: Point, element: &Element) -> Self {
        let place = |point: Point| (point.x.nm() as f64, point.z.nm() as f64);
        let (from, to) = (place(start), place(element.end));
        let arc = match element.shape {
            Shape::Arc { i, k, clockwise } => {
                let centre = (from.0 + i.nm() as f64, from.1 + k.nm() as f64);
                let angle = |p: (f64, f64)| (p.0 - centre.0).atan2(p.1 - centre.1);
                let swept = (angle(to) - angle(from)).rem_euclid(TAU);
                let swept = if from == to { 0.0 } else { swept };
                let swept = if clockwise || from == to {
                    swept - TAU
                } else {
                    swept
                };
                Some((centre, swept))
            }
            _ => None,
        };
        Self {
            start: from,
            end: to,
            arc,
        }
    }

    /// The place after a share of the way.
    pub(crate) fn place(&self, share: f64) -> (f64, f64) {
        match self.arc {
            None => (
                self.start.0 + (self.end.0 - self.start.0) * share,
                self.start.1 + (self.end.1 - self.start.1) * share,
            ),
            Some((centre, swept)) => {
                let arm = (self.start.0 - centre.0, self.start.1 - centre.1);
                let (sin, cos) = (swept * share).sin_cos();
                (
                    centre.0 + arm.0 * cos + arm.1 * sin,
                    centre.1 + arm.1 * cos - arm.0 * sin,
                )
            }
        }
    }

    /// The direction after a share of the way, as an angle from Z to X.
    pub(crate) fn heading(&self, share: f64) -> f64 {
        match self.arc {
            None => (self.end.0 - self.start.0).atan2(self.end.1 - self.start.1),
            Some((centre, swept)) => {
                let place = self.place(share);
                (place.0 - centre.0).atan2(place.1 - centre.1) + TAU / 4.0 * swept.signum()
            }
        }
    }

    /// A long straight line that leads into its start.
    pub(crate) fn before(&self) -> Self {
        let (sin, cos) = self.heading(0.0).sin_cos();
        let start = (self.start.0 - 1e8 * sin, self.start.1 - 1e8 * cos);
        Self {
            start,
            end: self.start,
            arc: None,
        }
    }

    /// A long straight line that leads on from its end.
    pub(crate) fn after(&self) -> Self {
        let (sin, cos) = self.heading(1.0).sin_cos();
        let end = (self.end.0 + 1e8 * sin, self.end.1 + 1e8 * cos);
        Self {
            start: self.end,
            end,
            arc: None,
        }
    }

    pub(crate) fn swept(&self) -> f64 {
        self.arc.map_or(0.0, |(_, swept)| swept)
    }

    pub(crate) fn length(&self) -> f64 {
        match self.arc {
            None => (self.end.0 - self.start.0).hypot(self.end.1 - self.start.1),
            Some((centre, swept)) => {
                swept.abs() * (self.start.0 - centre.0).hypot(self.start.1 - centre.1)
            }
        }
    }

    /// The distance of a place.
    pub(crate) fn distance(&self, to: (f64, f64)) -> f64 {
        let between = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).hypot(a.1 - b.1);
        let ends = between(self.start, to).min(between(self.end, to));
        match self.arc {
            None => {
                let way = (self.end.0 - self.start.0, self.end.1 - self.start.1);
                let square = way.0 * way.0 + way.1 * way.1;
                let share =
                    ((to.0 - self.start.0) * way.0 + (to.1 - self.start.1) * way.1) / square;
                if (0.0..=1.0).contains(&share) {
                    between(self.place(share), to)
                } else {
                    ends
                }
            }
            Some((centre, swept)) => {
                let angle = |p: (f64, f64)| (p.0 - centre.0).atan2(p.1 - centre.1);
                let turned = ((angle(to) - angle(self.start)) * swept.signum()).rem_euclid(TAU);
                if turned <= swept.abs() {
                    (between(centre, to) - between(centre, self.start))
                        .abs()
                        .min(ends)
                } else {
                    ends
                }
            }
        }
    }
}

/// Numbers by chance (xorshift).
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Between two numbers.
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Below a number.
    pub(crate) fn below(&mut self, count: u64) -> u64 {
        (self.next() >> 8) % count
    }

    /// Between two positive numbers, small ones as often as large ones.
    pub(crate) fn size(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    /// A path of `count` elements from the origin: lines and arcs, corners of any angle, sizes in nanometres.
    /// Every fourth
    /// corner is tangent.
    pub(crate) fn path(&mut self, count: usize, shortest: f64, longest: f64) -> Vec<Element> {
        let mut from = Point::default();
        let mut heading = self.within(0.0, TAU);
        let mut path = Vec::new();
        for _ in 0..count {
            heading += match self.below(4) {
                0 => 0.0,
                1 => TAU / 4.0 * (self.below(3) as f64 - 1.0),
                _ => self.within(-3.1, 3.1),
            };
            let length = self.size(shortest, longest);
            let element = if self.below(2) == 0 {
                let end = step(from, heading, length);
                Element {
                    end,
                    shape: Shape::Line,
                    span: Span::default(),
                }
            } else {
                let clockwise = self.below(2) == 0;
                let hand = if clockwise { -1.0 } else { 1.0 };
                let swept = self.within(0.1, 4.5);
                let radius = length / swept;
                let centre = step(from, heading + hand * TAU / 4.0, radius);
                let end = step(centre, heading - hand * TAU / 4.0 + hand * swept, radius);
                let (i, k) = (centre.x - from.x, centre.z - from.z);
                Element {
                    end,
                    shape: Shape::Arc { i, k, clockwise },
                    span: Span::default(),
                }
            };
            heading = Stroke::new(from, &element).heading(1.0);
            from = element.end;
            path.push(element);
        }
        path
    }
}

fn step(from: Point, heading: f64, length: f64) -> Point {
    Point {
        x: from.x + nm(length * heading.sin()),
        z: from.z + nm(length * heading.cos()),
    }
}
