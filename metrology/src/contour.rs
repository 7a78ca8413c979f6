//! A turned contour: how far the tool was from the programmed one, square to it, and the size of each of its elements.
//!
//! A contour and its parallel at the nose's radius have the same distances, so the path of the tool stands for the surface.

use crate::measure::Spread;
use crate::units::{Degrees, Mm, Side};

/// A place: along the axis, radius.
pub type Place = (Mm, Mm);

/// An element as it is programmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Where it begins.
    pub from: Place,
    /// Where it ends.
    pub to: Place,
    /// Of an arc: its centre, and whether it goes clockwise with Z to the right and X upwards.
    pub arc: Option<(Place, bool)>,
}

/// What an inspector says of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Size {
    /// Its diameters.
    Cylinder(Spread),
    /// Its places along Z.
    Face(Spread),
    /// Its angle to the axis.
    Cone(Degrees),
    /// Its radius, of the circle with the least squared distances.
    Arc(Mm),
}

/// An element that was cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Turned {
    /// How far from the programmed element, mean, least, most: plus is material left, minus is missing.
    pub off: Spread,
    /// Where it is least and where it is most: as programmed.
    pub worst: [Place; 2],
    /// Its size; `None` where it is too short to say.
    pub size: Option<Size>,
    /// The share of its length, and how far it is off there: the worst of each piece of it.
    pub course: Vec<(f64, Mm)>,
    /// Its length as programmed.
    pub length: Mm,
}

/// A contour that is being cut.
#[derive(Clone, Debug)]
pub struct Contour {
    parts: Vec<Part>,
}

#[derive(Clone, Debug)]
struct Part {
    element: Element,
    /// +1 where the side to the left of the way is free of material.
    free: f64,
    /// The contour goes on before it and after it.
    joined: [bool; 2],
    sums: Sums,
}

/// The share at either end of an element that does not count for its size: corners are rounded.
const EDGE: f64 = 0.1;
/// A length below this is none, millimetres.
const NONE: f64 = 1e-6;
/// The number of elements that a drive may be behind.
const BEHIND: usize = 8;

impl Contour {
    /// Elements in the order of cutting, none of which has been cut.
    #[must_use]
    pub fn new(elements: &[Element], side: Side) -> Self {
        let mut parts: Vec<Part> = Vec::new();
        let mut begin = 0;
        for (n, element) in elements.iter().enumerate() {
            let follows = n > 0 && apart(elements[n - 1].to, element.from) < NONE;
            if !follows {
                begin = n;
            }
            parts.push(Part {
                element: *element,
                free: 0.0,
                joined: [follows, false],
                sums: Sums::new(),
            });
            if follows {
                parts[n - 1].joined[1] = true;
            }
            let free = free(&elements[begin..=n], side);
            parts[begin..=n]
                .iter_mut()
                .for_each(|part| part.free = free);
        }
        Self { parts }
    }

    /// Where the tool was while this element was its target. A drive may be behind it, in an element before.
    pub fn push(&mut self, target: usize, place: Place) {
        let reach = target.saturating_sub(BEHIND)..(target + 1).min(self.parts.len());
        let feet = reach.map(|n| (n, self.parts[n].foot(place)));
        let nearest = feet.min_by(|a, b| a.1.far.abs().total_cmp(&b.1.far.abs()));
        if let Some((n, foot)) = nearest {
            let part = &mut self.parts[n];
            let [before, after] = part.joined;
            // Beside an open end it is still on its way to the contour, or has left it.
            if (foot.share >= 0.0 || before) && (foot.share <= 1.0 || after) {
                part.sums
                    .push(&part.element, part.free * foot.far, foot, place);
            }
        }
    }

    /// What was cut of each element; `None` of those that the tool was never at.
    #[must_use]
    pub fn finish(&self) -> Vec<Option<Turned>> {
        self.parts.iter().map(Part::turned).collect()
    }
}

/// +1 where the left side of a run of joined elements is free of material.
fn free(run: &[Element], side: Side) -> f64 {
    let (mut z, mut r) = (0.0, 0.0);
    for element in run {
        // The left normal of (dz, dr) is (−dr, dz).
        z -= (element.to.1 - element.from.1).0;
        r += side.height((element.to.0 - element.from.0).0);
    }
    // Faces alone are cut from +Z.
    let free = if r.abs() > NONE { r } else { z };
    if free < 0.0 { -1.0 } else { 1.0 }
}

fn apart(a: Place, b: Place) -> f64 {
    (a.0 - b.0).0.hypot((a.1 - b.1).0)
}

/// Where a place is beside an element.
#[derive(Clone, Copy, Debug)]
struct Foot {
    /// Distance, plus to the left of the way.
    far: f64,
    /// The share of the element's length; below 0 and above 1 it is beside an end.
    share: f64,
    at: Place,
}

impl Part {
    fn foot(&self, place: Place) -> Foot {
        let Element { from, to, arc } = self.element;
        let (share, left) = match arc {
            None => {
                let (dz, dr) = ((to.0 - from.0).0, (to.1 - from.1).0);
                let long = dz.hypot(dr).max(NONE);
                let (z, r) = ((place.0 - from.0).0, (place.1 - from.1).0);
                ((z * dz + r * dr) / (long * long), (r * dz - z * dr) / long)
            }
            Some((centre, clockwise)) => {
                let angle = |at: Place| (at.1 - centre.1).0.atan2((at.0 - centre.0).0);
                let turn = if clockwise { -1.0 } else { 1.0 };
                let around = |at: Place| {
                    let turned = turn * (angle(at) - angle(from));
                    turned.rem_euclid(std::f64::consts::TAU)
                };
                let mut whole = around(to);
                if whole < 1e-9 {
                    whole = std::f64::consts::TAU;
                }
                let mut way = around(place);
                // What is beyond the end by more than half of the rest is before the begin.
                if way > whole + (std::f64::consts::TAU - whole) / 2.0 {
                    way -= std::f64::consts::TAU;
                }
                let radius = apart(from, centre);
                // Going anticlockwise the centre is to the left.
                (way / whole, turn * (radius - apart(place, centre)))
            }
        };
        let end = if share < 0.0 { from } else { to };
        if (0.0..=1.0).contains(&share) {
            let at = self.along(share);
            return Foot {
                far: left,
                share,
                at,
            };
        }
        let far = apart(place, end).copysign(left);
        Foot {
            far,
            share,
            at: end,
        }
    }

    /// Its length.
    fn length(&self) -> f64 {
        const STEPS: u32 = 90;
        let Element { from, to, arc } = self.element;
        if arc.is_none() {
            return apart(from, to);
        }
        let at = |n: u32| self.along(f64::from(n) / f64::from(STEPS));
        (0..STEPS).map(|n| apart(at(n), at(n + 1))).sum()
    }

    /// The programmed place at a share of the element.
    fn along(&self, share: f64) -> Place {
        let Element { from, to, arc } = self.element;
        let Some((centre, clockwise)) = arc else {
            let mix = |a: Mm, b: Mm| a + (b - a) * share;
            return (mix(from.0, to.0), mix(from.1, to.1));
        };
        let angle = |at: Place| (at.1 - centre.1).0.atan2((at.0 - centre.0).0);
        let turn = if clockwise { -1.0 } else { 1.0 };
        let mut whole = (turn * (angle(to) - angle(from))).rem_euclid(std::f64::consts::TAU);
        if whole < 1e-9 {
            whole = std::f64::consts::TAU;
        }
        let (radius, at) = (apart(from, centre), angle(from) + turn * share * whole);
        (
            centre.0 + Mm(radius * at.cos()),
            centre.1 + Mm(radius * at.sin()),
        )
    }

    fn turned(&self) -> Option<Turned> {
        let sums = &self.sums;
        (sums.off.n > 0.0).then(|| Turned {
            off: sums.off.spread(),
            worst: sums.worst,
            size: self.size(),
            course: sums.course(),
            length: Mm(self.length()),
        })
    }

    fn size(&self) -> Option<Size> {
        let Element { from, to, arc } = self.element;
        let sums = &self.sums;
        if sums.value.n < 3.0 {
            return None;
        }
        let (dz, dr) = ((to.0 - from.0).0, (to.1 - from.1).0);
        Some(match arc {
            Some(_) => Size::Arc(Mm(sums.circle.radius()?)),
            None if dr.abs() < NONE => Size::Cylinder(sums.value.spread()),
            None if dz.abs() < NONE => Size::Face(sums.value.spread()),
            None => {
                // The line leans by the slope of its distances, to the left of its way.
                let lean = self.free * sums.slope.slope()?;
                let angle = (dr + lean * dz).atan2(dz - lean * dr).to_degrees().abs();
                Size::Cone(Degrees(angle.min(180.0 - angle)))
            }
        })
    }
}

/// Least, most and mean.
#[derive(Clone, Copy, Debug)]
struct Many {
    n: f64,
    sum: f64,
    low: f64,
    high: f64,
}

impl Many {
    const NONE: Self = Self {
        n: 0.0,
        sum: 0.0,
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    fn push(&mut self, value: f64) {
        self.n += 1.0;
        self.sum += value;
        (self.low, self.high) = (self.low.min(value), self.high.max(value));
    }

    fn spread(&self) -> Spread {
        Spread {
            mean: self.sum / self.n,
            low: self.low,
            high: self.high,
        }
    }
}

/// What is known of an element's places.
#[derive(Clone, Copy, Debug)]
struct Sums {
    off: Many,
    worst: [Place; 2],
    /// Diameters, or Z of a face.
    value: Many,
    slope: Slope,
    circle: Circle,
    pieces: [f64; PIECES],
}

/// Pieces of an element in its course.
const PIECES: usize = 64;

impl Sums {
    fn new() -> Self {
        Self {
            off: Many::NONE,
            worst: [(Mm(0.0), Mm(0.0)); 2],
            value: Many::NONE,
            slope: Slope::default(),
            circle: Circle::default(),
            pieces: [f64::NAN; PIECES],
        }
    }

    fn course(&self) -> Vec<(f64, Mm)> {
        let known = self
            .pieces
            .iter()
            .enumerate()
            .filter(|(_, off)| !off.is_nan());
        let share = |n: usize| (n as f64 + 0.5) / PIECES as f64;
        known.map(|(n, off)| (share(n), Mm(*off))).collect()
    }

    fn push(&mut self, element: &Element, off: f64, foot: Foot, place: Place) {
        if off < self.off.low {
            self.worst[0] = foot.at;
        }
        if off > self.off.high {
            self.worst[1] = foot.at;
        }
        self.off.push(off);
        let piece = (foot.share.clamp(0.0, 1.0) * PIECES as f64) as usize;
        let piece = &mut self.pieces[piece.min(PIECES - 1)];
        if piece.is_nan() || off.abs() > piece.abs() {
            *piece = off;
        }
        if !(EDGE..=1.0 - EDGE).contains(&foot.share) {
            return;
        }
        let is_face = (element.to.0 - element.from.0).0.abs() < NONE;
        let value = if is_face { place.0.0 } else { 2.0 * place.1.0 };
        self.value.push(value);
        match element.arc {
            None => {
                let long = apart(element.from, element.to);
                self.slope.push((foot.share - 0.5) * long, off);
            }
            Some((centre, _)) => {
                self.circle
                    .push((place.0 - centre.0).0, (place.1 - centre.1).0);
            }
        }
    }
}

/// Regression of distances along a line.
#[derive(Clone, Copy, Debug, Default)]
struct Slope {
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
}

impl Slope {
    fn push(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
    }

    fn slope(&self) -> Option<f64> {
        let below = self.n * self.xx - self.x * self.x;
        (below > 0.0).then(|| (self.n * self.xy - self.x * self.y) / below)
    }
}

/// The circle with the least squared distances (of squares), about a centre that is nearly its own.
#[derive(Clone, Copy, Debug, Default)]
struct Circle {
    /// Sums of x, y, xx, xy, yy, n, and of x, y and 1 times the square of the distance.
    sums: [f64; 9],
}

impl Circle {
    fn push(&mut self, x: f64, y: f64) {
        let q = x * x + y * y;
        let terms = [x, y, x * x, x * y, y * y, 1.0, x * q, y * q, q];
        for (sum, term) in self.sums.iter_mut().zip(terms) {
            *sum += term;
        }
    }

    fn radius(&self) -> Option<f64> {
        let [x, y, xx, xy, yy, n, xq, yq, q] = self.sums;
        // About the means the constant is free of the rest.
        let (mx, my, mq) = (x / n, y / n, q / n);
        let (xx, xy, yy) = (xx / n - mx * mx, xy / n - mx * my, yy / n - my * my);
        let (xq, yq) = (xq / n - mx * mq, yq / n - my * mq);
        let below = xx * yy - xy * xy;
        if below <= 0.0 {
            return None;
        }
        let (a, b) = ((xq * yy - yq * xy) / below, (yq * xx - xq * xy) / below);
        let constant = mq - a * mx - b * my;
        Some((constant + (a * a + b * b) / 4.0).max(0.0).sqrt())
    }
}
