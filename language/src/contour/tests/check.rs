//! G71 and G72 over random contours, checked by another method: columns of material.
//!
//! Each column holds the height up to which material stands. A move takes away what is above the tool. No move may come
//! below the shifted contour, no rapid may meet material, no cut may be deeper than Δd, and at the end each column is as
//! high as the shifted contour. The check calculates in `f64` and shares no code with the cycles.

use leadscrew_core::alarm::At;
use leadscrew_core::units::{Diameter, Length};

use super::notation::span;
use crate::contour::{Allowance, Along, Axes, Contour, Cut, Roughing};
use crate::plane::{Element, Point, Shape};

/// What rounding to nanometres may change, nm.
const SLACK: f64 = 2.0;

/// How far along the strokes rounding may move a wall, nm.
const ASIDE: f64 = 3.0;

struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From `low` to `high`, both included.
    fn within(&mut self, low: i64, high: i64) -> i64 {
        let many = u64::try_from(high - low).expect("a range") + 1;
        low + (self.bits() % many) as i64
    }

    fn one_in(&mut self, many: i64) -> bool {
        self.within(1, many) == 1
    }
}

/// A piece of a contour from the end of the one before: how far it goes, and for an arc its centre from its beginning.
#[derive(Clone, Copy, Debug)]
struct Piece {
    h: i64,
    l: i64,
    arc: Option<(i64, i64)>,
}

/// A contour and its cycle, as heights `h` over ways `l` from the start of the cycle.
#[derive(Clone, Debug)]
struct Case {
    along: Along,
    up: i64,
    forward: i64,
    two_axes: bool,
    rapid_first: bool,
    rapid_retract: bool,
    pieces: Vec<Piece>,
    depth: i64,
    retract: i64,
    allowance: (i64, i64),
}

impl Case {
    fn random(random: &mut Random) -> Self {
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

    /// A place on the machine.
    fn point(&self, h: i64, l: i64) -> Point {
        match self.along {
            Along::Z => Point::from_nm(h * self.up, l * self.forward),
            Along::X => Point::from_nm(l * self.forward, h * self.up),
        }
    }

    fn place(&self, point: Point) -> (f64, f64) {
        let (x, z) = (point.x.nm(), point.z.nm());
        let (h, l) = match self.along {
            Along::Z => (x, z),
            Along::X => (z, x),
        };
        ((h * self.up) as f64, (l * self.forward) as f64)
    }

    /// True where an arc that goes forward over its circle is clockwise: with X up and Z to the right, the tool is then
    /// above the centre and goes right, or left of it and goes up.
    fn over_is_clockwise(&self) -> bool {
        match self.along {
            Along::Z => self.up == self.forward,
            Along::X => self.up != self.forward,
        }
    }

    fn contour(&self) -> Contour {
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

    fn words(&self) -> Roughing {
        Roughing {
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

/// A move or a piece of a contour between two places.
#[derive(Clone, Copy, Debug)]
struct Way {
    from: (f64, f64),
    to: (f64, f64),
    /// The centre, and +1 for the upper half of the circle.
    arc: Option<((f64, f64), f64)>,
    rapid: bool,
}

impl Way {
    fn of(case: &Case, from: Point, element: &Element) -> Self {
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
    fn height(&self, l: f64) -> Option<f64> {
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
fn near(path: &[Way], l: f64) -> (f64, f64) {
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

struct Columns {
    /// Each with its place, the height of its material, and the contour near it.
    all: Vec<(f64, f64, (f64, f64))>,
}

impl Columns {
    fn new(part: &[Way], moves: &[Way], start: (f64, f64), random: &mut Random) -> Self {
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

    fn go(&mut self, way: &Way, depth: f64) -> Result<(), String> {
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

fn check(case: &Case) -> Result<(), String> {
    let contour = case.contour();
    let words = case.words();
    let cycle = contour.rough(case.along, &words);
    let cycle = cycle.map_err(|alarm| format!("refused: {alarm:?}"))?;
    let cuts: Vec<Cut> = cycle.take(20_000).collect();
    let moved = |point| words.allowance.shift(point);
    let start = moved(contour.start());
    let mut from = start;
    let part: Vec<Way> = contour
        .elements()
        .iter()
        .map(|element| {
            let end = moved(element.end);
            let way = Way::of(case, from, &Element { end, ..*element });
            from = end;
            way
        })
        .collect();
    let mut from = contour.start();
    let mut moves = Vec::new();
    for cut in &cuts {
        let way = Way::of(case, from, &cut.element);
        if let Some((centre, _)) = way.arc {
            let [a, b] = [way.from, way.to].map(|end| (end.0 - centre.0).hypot(end.1 - centre.1));
            if (a - b).abs() > SLACK || way.to.1 <= way.from.1 {
                return Err(format!("a bad arc: {way:?}"));
            }
        }
        moves.push(way);
        from = cut.element.end;
    }
    if from != contour.start() {
        return Err("does not come home".into());
    }
    let (top, begin) = case.place(start);
    let mut random = Random(1);
    let mut columns = Columns::new(&part, &moves, (top, begin), &mut random);
    // The way from A to A' is the caller's: the allowance may lead anywhere.
    let first = usize::from(start != contour.start());
    // Where the allowance moves the first block over A, A itself is in material, and so is the last move.
    let home = case.place(contour.start());
    let inside = home.0 < near(&part, home.1).1 && begin < home.1;
    for (cut, way) in cuts.iter().zip(&moves).skip(first) {
        let upright = way.from.1.to_bits() == way.to.1.to_bits();
        if inside && upright && way.to == home {
            continue;
        }
        columns
            .go(way, case.depth as f64)
            .map_err(|what| format!("{what}: {way:?}"))?;
        let level = way.from.0.to_bits() == way.to.0.to_bits();
        if cut.of.is_none() && !way.rapid && level {
            let down = (top - way.to.0) as i64;
            if down % case.depth != 0 || down == 0 {
                return Err(format!("not on a level: {way:?}"));
            }
        }
    }
    for (l, top, (low, high)) in &columns.all {
        if !(low - SLACK..=high + SLACK).contains(top) {
            return Err(format!("leaves {top} on {low}..{high} at {l}"));
        }
    }
    last_pass(&contour, &cuts, moved)
}

/// The last cuts are the elements of the contour, moved exactly by the allowance.
fn last_pass(
    contour: &Contour,
    cuts: &[Cut],
    moved: impl Fn(Point) -> Point,
) -> Result<(), String> {
    let mut last = cuts.iter().rev().skip_while(|cut| cut.of.is_none());
    let elements = contour.elements();
    for (index, element) in elements.iter().enumerate().skip(1).rev() {
        if elements[index - 1].end == element.end {
            continue;
        }
        let wanted = Cut {
            element: Element {
                end: moved(element.end),
                ..*element
            },
            of: Some(index),
        };
        let cut = last.next();
        if cut != Some(&wanted) {
            return Err(format!(
                "the last pass has {cut:?} where {wanted:?} belongs"
            ));
        }
    }
    Ok(())
}

/// The smallest case that still fails, and why.
fn shrink(mut case: Case, mut why: String) -> (Case, String) {
    loop {
        let mut smaller: Vec<Case> = (1..case.pieces.len())
            .map(|index| {
                let mut less = case.clone();
                less.pieces.remove(index);
                less
            })
            .collect();
        for change in [
            |case: &mut Case| case.allowance = (0, 0),
            |case: &mut Case| case.retract = 0,
            |case: &mut Case| case.up = 1,
            |case: &mut Case| case.along = Along::Z,
            |case: &mut Case| case.pieces[0].l = 0,
        ] {
            let mut less = case.clone();
            change(&mut less);
            if format!("{less:?}") != format!("{case:?}") {
                smaller.push(less);
            }
        }
        let found = smaller.into_iter().find_map(|less| match check(&less) {
            Err(why) if !why.starts_with("refused") => Some((less, why)),
            _ => None,
        });
        match found {
            Some(found) => (case, why) = found,
            None => return (case, why),
        }
    }
}

fn check_all(seed: u64, many: usize) {
    let mut random = Random(seed);
    for number in 0..many {
        let case = Case::random(&mut random);
        if let Err(why) = check(&case) {
            let (case, why) = shrink(case, why);
            panic!("case {number}: {why}\n{case:#?}");
        }
    }
}

#[test]
fn random_contours_are_cut_down_to_their_allowance() {
    let many = leadscrew_seed::amount(1_000, 40_000);
    leadscrew_seed::volume(71, |seed| check_all(seed, many));
}
