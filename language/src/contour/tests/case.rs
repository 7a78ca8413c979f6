//! Random contours, as pieces that can be left out one by one.

use core::fmt;

use leadscrew_core::alarm::At;
use leadscrew_core::units::{Diameter, Length};

use super::notation::span;
use crate::contour::{Allowance, Along, Axes, Contour, Roughing};
use crate::plane::{Element, Point, Shape};

/// Numbers from a seed.
pub struct Random(pub u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From `low` to `high`, both included.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        let many = u64::try_from(high - low).expect("a range") + 1;
        low + (self.bits() % many) as i64
    }

    pub fn one_in(&mut self, many: i64) -> bool {
        self.within(1, many) == 1
    }
}

/// A micrometre, nm.
pub const MICROMETRE: i64 = 1_000;

/// A piece of a contour from the end of the one before: how far it goes, and for an arc its centre from its beginning.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    pub h: i64,
    pub l: i64,
    pub arc: Option<(i64, i64)>,
}

/// A contour and its cycle, as heights `h` over ways `l` from the start of the cycle.
#[derive(Clone, Debug)]
pub struct Case {
    pub along: Along,
    pub up: i64,
    pub forward: i64,
    pub two_axes: bool,
    pub rapid_first: bool,
    pub rapid_retract: bool,
    pub pieces: Vec<Piece>,
    pub depth: i64,
    pub retract: i64,
    pub allowance: (i64, i64),
    /// What the strokes leave besides, away from the contour: as heights, and along the strokes.
    pub left: (i64, i64),
}

impl Case {
    pub fn random(random: &mut Random) -> Self {
        let sign = |random: &mut Random| if random.one_in(2) { 1 } else { -1 };
        let scale = [10_000, 1_000_000, 10_000_000][random.within(0, 2) as usize];
        let mut case = Self {
            along: if random.one_in(2) { Along::Z } else { Along::X },
            up: sign(random),
            forward: sign(random),
            two_axes: !random.one_in(3),
            rapid_first: random.one_in(2),
            rapid_retract: random.one_in(2),
            pieces: Vec::new(),
            depth: random.within(scale / 8, 3 * scale),
            retract: random.within(0, scale / 2) * random.within(0, 1),
            allowance: (
                2 * random.within(-scale / 20, scale / 20),
                random.within(-scale / 10, scale / 10),
            ),
            left: (0, 0),
        };
        if random.one_in(3) {
            case.allowance = (0, 0);
        }
        let first = Piece {
            h: -random.within(scale / 10, 5 * scale),
            l: if case.two_axes && random.one_in(3) {
                random.within(0, scale)
            } else {
                0
            },
            arc: None,
        };
        case.pieces.push(first);
        let mut h = first.h;
        for _ in 0..random.within(0, 12) {
            let piece = case.piece(random, scale, h);
            h += piece.h;
            case.pieces.push(piece);
        }
        // The last piece ends forward of the start, for the strokes go toward the end.
        case.pieces.push(Piece {
            h: 0,
            l: random.within(1, scale),
            arc: None,
        });
        if random.one_in(2) {
            let most = if case.two_axes { 0 } else { scale / 10 };
            case.left = (random.within(0, scale / 10), random.within(0, most));
        }
        case
    }

    fn piece(&self, random: &mut Random, scale: i64, height: i64) -> Piece {
        let flat = Piece {
            h: 0,
            l: random.within(0, scale),
            arc: None,
        };
        let mut piece = match random.within(0, 9) {
            0 => flat,
            1..=4 => Piece {
                h: random.within(if self.two_axes { -scale } else { 0 }, scale),
                l: if random.one_in(4) {
                    0
                } else {
                    random.within(0, scale)
                },
                arc: None,
            },
            5 => Piece {
                // Onto a level.
                h: (height + random.within(0, scale)).div_euclid(self.depth) * self.depth - height,
                ..flat
            },
            _ => self.arc(random, scale),
        };
        let top = piece.arc.map_or(piece.h, |(h, l)| {
            let radius = (h as f64).hypot(l as f64) as i64 + 1;
            if h < 0 { h + radius } else { piece.h }
        });
        if height + top.max(piece.h) >= 0 || (!self.two_axes && piece.h < 0) {
            piece = flat;
        }
        piece
    }

    /// A contour that a program can write: its places and its centres are whole micrometres, and no piece is without
    /// length. The allowances leave something.
    pub fn written(random: &mut Random) -> Self {
        let mut case = Self {
            two_axes: random.one_in(2),
            depth: random.within(100, 4_000) * MICROMETRE,
            retract: random.within(0, 600) * MICROMETRE,
            left: (0, 0),
            ..Self::random(random)
        };
        let slanted = case.two_axes && random.one_in(3);
        case.pieces = vec![Piece {
            h: -random.within(2_000, 15_000) * MICROMETRE,
            l: random.within(1, 2_000) * i64::from(slanted) * MICROMETRE,
            arc: None,
        }];
        let mut h = case.pieces[0].h;
        for _ in 0..random.within(0, 8) {
            let piece = case.written_piece(random, h);
            h += piece.h;
            case.pieces.push(piece);
        }
        case.pieces.push(case.written_line(random, 1));
        // A wall of a pocket would be cut by what is left along the strokes.
        let along = if case.two_axes { 0 } else { 300 };
        let across = random.within(0, 300) * case.up * MICROMETRE;
        let along = random.within(0, along) * -case.forward * MICROMETRE;
        case.allowance = match case.along {
            Along::Z => (2 * across, along),
            Along::X => (2 * along, across),
        };
        case
    }

    fn written_line(&self, random: &mut Random, kind: i64) -> Piece {
        let lowest = if self.two_axes { -3_000 } else { 1 };
        let h = random.within(lowest, 3_000);
        let (h, l) = match kind {
            0 if h != 0 => (h, 0),
            0 | 1 => (0, random.within(1, 3_000)),
            _ => (h, random.within(1, 3_000)),
        };
        Piece {
            h: h * MICROMETRE,
            l: l * MICROMETRE,
            arc: None,
        }
    }

    fn written_piece(&self, random: &mut Random, height: i64) -> Piece {
        let kind = random.within(0, 6);
        let (mut piece, mut top) = (self.written_line(random, kind), 0);
        if kind > 3 {
            (piece, top) = self.written_arc(random);
        }
        if height + top.max(piece.h) >= 0 {
            return self.written_line(random, 1);
        }
        piece
    }

    /// An arc between places that lie on its circle exactly, and how far it rises on its way.
    fn written_arc(&self, random: &mut Random) -> (Piece, i64) {
        // On a circle of 65: along, across.
        const PLACES: [(i64, i64); 10] = [
            (0, 65),
            (16, 63),
            (25, 60),
            (33, 56),
            (39, 52),
            (52, 39),
            (56, 33),
            (60, 25),
            (63, 16),
            (65, 0),
        ];
        let place = |index: i64| {
            let (l, h) = PLACES[index.unsigned_abs() as usize];
            (l * index.signum(), h)
        };
        let over = random.one_in(2);
        // The lower half does not begin at its end: there it is level with its centre, and reads as the upper one.
        let (low, high) = match (over, self.two_axes) {
            (true, true) => (-9, 9),
            (true, false) => (-9, 0),
            (false, true) => (-8, 9),
            (false, false) => (0, 9),
        };
        let from = random.within(low, high - 1);
        let to = random.within(from + 1, high);
        let ((l0, h0), (l1, h1)) = (place(from), place(to));
        let size = random.within(1, 60) * MICROMETRE;
        let side = if over { 1 } else { -1 };
        let top = if over && from < 0 && to > 0 {
            65 - h0
        } else {
            0
        };
        let piece = Piece {
            h: side * (h1 - h0) * size,
            l: (l1 - l0) * size,
            arc: Some((-side * h0 * size, -l0 * size)),
        };
        (piece, top * size)
    }

    /// An arc that goes forward only, and up only where the contour has to.
    fn arc(&self, random: &mut Random, scale: i64) -> Piece {
        let over = random.one_in(2);
        let side = if over { -1.0 } else { 1.0 };
        let h = random.within(1, scale);
        let mut l = random.within(-scale, scale);
        if !self.two_axes {
            l = if over { l.abs() } else { -l.abs() };
        }
        let radius = (h as f64).hypot(l as f64);
        let far = if over && !self.two_axes {
            l
        } else {
            l + radius.floor() as i64
        };
        let end = random.within(0, far.max(0));
        let away = (end - l) as f64;
        let rise = radius.mul_add(radius, -(away * away)).max(0.0).sqrt();
        let to = side * (h as f64 - rise);
        if end == 0 || radius < 100.0 {
            return Piece {
                h: 0,
                l: end,
                arc: None,
            };
        }
        Piece {
            h: to.round() as i64,
            l: end,
            arc: Some((side as i64 * h, l)),
        }
    }

    /// Cases that lack something of this one.
    pub fn smaller(&self) -> Vec<Self> {
        let mut smaller: Vec<Self> = (1..self.pieces.len())
            .map(|index| {
                let mut less = self.clone();
                less.pieces.remove(index);
                less
            })
            .collect();
        for change in [
            |case: &mut Self| case.allowance = (0, 0),
            |case: &mut Self| case.left = (0, 0),
            |case: &mut Self| case.retract = 0,
            |case: &mut Self| case.up = 1,
            |case: &mut Self| case.along = Along::Z,
            |case: &mut Self| case.pieces[0].l = 0,
        ] {
            let mut less = self.clone();
            change(&mut less);
            if format!("{less:?}") != format!("{self:?}") {
                smaller.push(less);
            }
        }
        smaller
    }

    /// A place on the machine.
    pub fn point(&self, h: i64, l: i64) -> Point {
        match self.along {
            Along::Z => Point::from_nm(h * self.up, l * self.forward),
            Along::X => Point::from_nm(l * self.forward, h * self.up),
        }
    }

    pub fn place(&self, point: Point) -> (f64, f64) {
        let (x, z) = (point.x.nm(), point.z.nm());
        let (h, l) = match self.along {
            Along::Z => (x, z),
            Along::X => (z, x),
        };
        ((h * self.up) as f64, (l * self.forward) as f64)
    }

    /// True where an arc that goes forward over its circle is clockwise: with X up and Z to the right, the tool is then
    /// above the centre and goes right, or left of it and goes up.
    pub fn over_is_clockwise(&self) -> bool {
        match self.along {
            Along::Z => self.up == self.forward,
            Along::X => self.up != self.forward,
        }
    }

    pub fn contour(&self) -> Contour {
        let (mut h, mut l) = (0, 0);
        let elements = self.pieces.iter().enumerate().map(|(index, piece)| {
            (h, l) = (h + piece.h, l + piece.l);
            let shape = match piece.arc {
                Some((up, along)) => {
                    let centre = self.point(up, along);
                    Shape::Arc {
                        i: centre.x,
                        k: centre.z,
                        clockwise: self.over_is_clockwise() == (up <= 0),
                    }
                }
                None if index == 0 && self.rapid_first => Shape::Rapid,
                None => Shape::Line,
            };
            Element {
                end: self.point(h, l),
                shape,
                span: span(index + 1),
            }
        });
        let elements = elements.collect();
        let axes = Axes {
            x: self.two_axes || self.along == Along::Z,
            z: self.two_axes || self.along == Along::X,
        };
        Contour::new(Point::default(), axes, elements).expect("a contour")
    }

    /// I and K. Those along the strokes are zero where a contour may have pockets.
    pub fn left(&self) -> Allowance {
        let (across, along) = (self.up * self.left.0, -self.forward * self.left.1);
        let (x, z) = match self.along {
            Along::Z => (across, along),
            Along::X => (along, across),
        };
        Allowance {
            x: Diameter::from_nm(2 * x),
            z: Length::from_nm(z),
        }
    }

    pub fn words(&self) -> Roughing {
        Roughing {
            left: self.left(),
            depth: At::new(Length::from_nm(self.depth), span(101)),
            retract: At::new(Length::from_nm(self.retract), span(102)),
            retract_feeds: !self.rapid_retract,
            allowance: Allowance {
                x: Diameter::from_nm(self.allowance.0),
                z: Length::from_nm(self.allowance.1),
            },
            semi_finish: true,
            tolerance: Length::ZERO,
            span: span(100),
        }
    }
}

/// Draws so many cases and checks each; the smallest that fails is told.
pub fn check_all<C: fmt::Debug>(
    seed: u64,
    many: usize,
    draw: impl Fn(&mut Random) -> C,
    smaller: impl Fn(&C) -> Vec<C>,
    check: impl Fn(&C) -> Result<(), String>,
) {
    let mut random = Random(seed);
    for number in 0..many {
        let case = draw(&mut random);
        if let Err(why) = check(&case) {
            let (case, why) = smallest(case, why, smaller, check);
            panic!("case {number}: {why}\n{case:#?}");
        }
    }
}

/// The smallest case that still fails, and why: `smaller` gives those that lack something of a case. A case that is
/// refused is another matter.
fn smallest<C>(
    mut case: C,
    mut why: String,
    smaller: impl Fn(&C) -> Vec<C>,
    check: impl Fn(&C) -> Result<(), String>,
) -> (C, String) {
    loop {
        let found = smaller(&case)
            .into_iter()
            .find_map(|less| match check(&less) {
                Err(why) if !why.starts_with("refused") => Some((less, why)),
                _ => None,
            });
        match found {
            Some(found) => (case, why) = found,
            None => return (case, why),
        }
    }
}
