//! G71 and G72 over random contours, checked by another method: columns of material.
//!
//! Each column holds the height up to which material stands. A move takes away what is above the tool. No move may come
//! below the shifted contour, no rapid may meet material, no cut may be deeper than Δd, and at the end each column is as
//! high as the shifted contour. The check calculates in `f64` and shares no code with the cycles.

use super::case::{Case, Random};
use crate::contour::{Allowance, Along, Contour, Cut};
use crate::plane::{Element, Point, Shape};

/// What rounding to nanometres may change, nm.
const SLACK: f64 = 2.0;

/// How far along the strokes rounding may move a wall, nm.
const ASIDE: f64 = 3.0;

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

/// The contour with an allowance.
fn shifted(case: &Case, contour: &Contour, allowance: &Allowance) -> Vec<Way> {
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

/// How many of the moves come before the last pass and the way home.
fn strokes(cuts: &[Cut]) -> usize {
    let home = cuts.iter().rev().take_while(|cut| cut.of.is_none()).count();
    let pass = cuts[..cuts.len() - home].iter().rev();
    cuts.len() - home - pass.take_while(|cut| cut.of.is_some()).count()
}

fn check(case: &Case) -> Result<(), String> {
    let contour = case.contour();
    let words = case.words();
    let cycle = contour.rough(case.along, &words);
    let cycle = cycle.map_err(|alarm| format!("refused: {alarm:?}"))?;
    let cuts: Vec<Cut> = cycle.take(20_000).collect();
    let moved = |point| words.allowance.shift(point);
    let left = words.allowance.and(words.left);
    let start = left.shift(contour.start());
    let part = shifted(case, &contour, &words.allowance);
    let mut from = contour.start();
    let mut moves = Vec::new();
    for cut in &cuts {
        let way = Way::of(case, from, &cut.element);
        if let Some((centre, _)) = way.arc {
            let [a, b] = [way.from, way.to].map(|end| (end.0 - centre.0).hypot(end.1 - centre.1));
            // A steep end may advance by less than its places are rounded to.
            let radius = (a + b) / 2.0;
            let along = |end: (f64, f64)| (radius * radius - (end.0 - centre.0).powi(2)).sqrt();
            let stands = way.to.1.to_bits() == way.from.1.to_bits()
                && (along(way.to) - along(way.from)).abs() < 1.0;
            if (a - b).abs() > SLACK || (way.to.1 <= way.from.1 && !stands) {
                return Err(format!("a bad arc: {way:?}"));
            }
        }
        moves.push(way);
        from = cut.element.end;
    }
    if from != contour.start() {
        return Err("does not come home".into());
    }
    let top = case.place(start).0;
    // The last pass comes down there, at rapid in type I: no material is in front of it.
    let front = case.place(moved(contour.start())).1;
    let depth = case.depth as f64;
    // The way from A to A' is the caller's: the allowance may lead anywhere.
    let first = usize::from(start != contour.start());
    // Where the allowance moves the first block over A, A itself is in material, and so is the last move.
    let home = case.place(contour.start());
    let inside = home.0 < near(&part, home.1).1 && front < home.1;
    // The strokes stay away from the contour by what they leave, and the last pass takes that at once.
    let deepest = if words.left == Allowance::NONE {
        depth
    } else {
        let part = shifted(case, &contour, &left);
        let mut columns = Columns::new(&part, &moves, (top, front), &mut Random(1));
        for way in &moves[first..strokes(&cuts)] {
            columns
                .go(way, depth)
                .map_err(|what| format!("a stroke {what}: {way:?}"))?;
        }
        f64::INFINITY
    };
    let mut columns = Columns::new(&part, &moves, (top, front), &mut Random(1));
    for (cut, way) in cuts.iter().zip(&moves).skip(first) {
        let upright = way.from.1.to_bits() == way.to.1.to_bits();
        if inside && upright && way.to == home {
            continue;
        }
        columns
            .go(way, deepest)
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
            |case: &mut Case| case.left = (0, 0),
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
