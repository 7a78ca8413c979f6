//! G73 over random contours. Each copy is the contour, moved by what the definition of the cycle says as a fraction; and
//! columns of material tell what each copy leaves, and that none comes below the last.

use core::cell::Cell;

use leadscrew_core::alarm::At;
use leadscrew_core::units::{Diameter, Length};

use super::case::{Case, Random, check_all};
use super::columns::{Columns, SLACK, Way, near, shifted};
use super::notation::span;
use crate::contour::{Allowance, Along, Axes, Contour, Cut, Repeats};
use crate::plane::{Element, Point, Shape};

/// A contour and its copies.
#[derive(Clone, Debug)]
pub struct Copies {
    pub case: Case,
    /// i and k: up, and back against the way of the contour.
    pub relief: (i64, i64),
    pub passes: i64,
}

impl Copies {
    fn random(random: &mut Random) -> Self {
        let case = Case::random(random);
        Self::of(case, 20_000_000, 1, random)
    }

    /// Copies that a program can write, and that lead away from the part.
    pub fn written(random: &mut Random) -> Self {
        let case = Case::written(random);
        let mut copies = Self::of(case, 10_000, 1_000, random);
        copies.relief.0 = copies.relief.0.abs();
        copies.relief.1 = copies.relief.1.abs();
        if copies.case.two_axes {
            copies.relief.1 = 0;
        }
        copies
    }

    fn of(case: Case, most: i64, unit: i64, random: &mut Random) -> Self {
        let lowest = if random.one_in(4) { -most } else { 0 };
        let mut length = || random.within(lowest, most) * random.within(0, 3).signum() * unit;
        let relief = (length(), length());
        let passes = match random.within(0, 99) {
            0 => random.within(9, 200),
            _ => random.within(1, 8),
        };
        let back = if case.two_axes && !random.one_in(4) {
            0
        } else {
            relief.1
        };
        Self {
            case,
            relief: (relief.0, back),
            passes,
        }
    }

    /// The words of the cycle.
    pub fn words(&self) -> Repeats {
        let (up, back) = (
            self.case.up * self.relief.0,
            -self.case.forward * self.relief.1,
        );
        let (x, z) = match self.case.along {
            Along::Z => (up, back),
            Along::X => (back, up),
        };
        Repeats {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
            passes: At::new(self.passes, span(101)),
            allowance: self.case.words().allowance,
            span: span(100),
        }
    }

    /// True where no copy comes nearer to the part than the one after it: with a pocket, only those that lie straight
    /// above it.
    fn leads_away(&self) -> bool {
        let (up, back) = self.relief;
        up >= 0 && back >= 0 && (back == 0 || !self.case.two_axes)
    }

    fn smaller(&self) -> Vec<Self> {
        let cases = self.case.smaller().into_iter();
        let mut smaller: Vec<Self> = cases
            .map(|case| Self {
                case,
                ..self.clone()
            })
            .collect();
        if self.passes > 1 {
            smaller.push(Self {
                passes: self.passes - 1,
                ..self.clone()
            });
        }
        for relief in [(0, self.relief.1), (self.relief.0, 0)] {
            if relief != self.relief {
                smaller.push(Self {
                    relief,
                    ..self.clone()
                });
            }
        }
        smaller
    }
}

/// Twice `whole · left / steps`, plus what is allowed for twice, is twice `shift`, but for half a nanometre.
fn is_share(shift: Length, whole: Length, left: i64, steps: i64, allowance: i64) -> bool {
    let [shift, whole, allowance] = [shift.nm(), whole.nm(), allowance].map(i128::from);
    let (left, steps) = (i128::from(left), i128::from(steps.max(1)));
    (2 * steps * shift - 2 * whole * left - allowance * steps).abs() <= steps
}

/// A move of a copy, and where it begins.
type From = (Point, Element);

/// The moves of each copy, once they are what the definition says: from A moved by the shift of the copy along all of the
/// contour, moved alike; at the end to A.
fn copies_of(contour: &Contour, words: &Repeats, cuts: &[Cut]) -> Result<Vec<Vec<From>>, String> {
    let (passes, start) = (words.passes.value, contour.start());
    let steps = passes - 1;
    let mut cuts = cuts.iter().peekable();
    let mut at = start;
    let mut copies = Vec::new();
    for copy in 1..=passes {
        let shift_at = |place: Point| Point {
            x: place.x - start.x,
            z: place.z - start.z,
        };
        let (left, given) = (passes - copy, words.allowance);
        let is_right = |shift: Point| {
            is_share(shift.x, words.x, left, steps, given.x.nm())
                && is_share(shift.z, words.z, left, steps, 2 * given.z.nm())
        };
        // Where the way to the copy's start has no length, the tool is there.
        let leads = |cut: &&Cut| cut.of.is_none() && !is_right(shift_at(at));
        let begin = cuts.next_if(leads).map_or(at, |cut| cut.element.end);
        let shift = shift_at(begin);
        if !is_right(shift) {
            return Err(format!("copy {copy} is moved by {shift:?}"));
        }
        at = begin;
        let mut moves = Vec::new();
        for (index, element) in contour.elements().iter().enumerate() {
            let end = Point {
                x: element.end.x + shift.x,
                z: element.end.z + shift.z,
            };
            let wanted = Cut {
                element: Element { end, ..*element },
                of: Some(index),
            };
            if end == at && !matches!(element.shape, Shape::Arc { .. }) {
                continue;
            }
            if cuts.next() != Some(&wanted) {
                return Err(format!("copy {copy} goes not on with {wanted:?}"));
            }
            moves.push((at, wanted.element));
            at = end;
        }
        copies.push(moves);
    }
    let home = Cut {
        element: Element {
            end: start,
            shape: Shape::Rapid,
            span: words.span,
        },
        of: None,
    };
    match (at == start, cuts.next(), cuts.next()) {
        (true, None, _) => Ok(copies),
        (_, Some(last), None) if *last == home => Ok(copies),
        (_, last, more) => Err(format!("ends with {last:?} and {more:?}")),
    }
}

/// Between copies the tool goes at rapid.
fn ways_between_are_rapid(cuts: &[Cut]) -> Result<(), String> {
    let mut between = cuts.iter().filter(|cut| cut.of.is_none());
    match between.find(|cut| cut.element.shape != Shape::Rapid || cut.element.span != span(100)) {
        Some(cut) => Err(format!("{cut:?} is no way between two copies")),
        None => Ok(()),
    }
}

/// The moves of the copies.
pub fn repeat(copies: &Copies, contour: &Contour) -> Result<Vec<Cut>, String> {
    let cycle = contour.pattern(&copies.words());
    let cycle = cycle.map_err(|alarm| format!("refused: {alarm:?}"))?;
    Ok(cycle.collect())
}

fn check(copies: &Copies) -> Result<(), String> {
    let contour = copies.case.contour();
    let cuts = repeat(copies, &contour)?;
    judge(copies, &contour, &cuts, &[]).map(drop)
}

/// The columns that the copies leave, some of them at the ends of the `next` cuts.
pub fn judge(
    copies: &Copies,
    contour: &Contour,
    cuts: &[Cut],
    next: &[Way],
) -> Result<Columns, String> {
    let (case, words) = (&copies.case, copies.words());
    ways_between_are_rapid(cuts)?;
    let ways: Vec<Vec<Way>> = copies_of(contour, &words, cuts)?
        .iter()
        .map(|moves| {
            let ways = moves.iter().map(|(from, element)| Way {
                // Its first block may be a rapid, whatever stands there.
                rapid: false,
                ..Way::of(case, *from, element)
            });
            ways.collect()
        })
        .collect();
    let part = shifted(case, contour, &words.allowance);
    let front = part[0].from.1;
    let all: Vec<Way> = ways.iter().take(8).flatten().chain(next).copied().collect();
    let mut columns = Columns::new(&part, &all, (f64::INFINITY, front), &mut Random(1));
    if !copies.leads_away() {
        return Ok(columns);
    }
    let steps = (copies.passes - 1).max(1) as f64;
    let end = part[part.len() - 1].to.1;
    for (copy, ways) in ways.iter().enumerate() {
        for way in ways {
            columns
                .go(way, f64::INFINITY)
                .map_err(|what| format!("copy {copy} {what}: {way:?}"))?;
        }
        let left = (copies.passes - 1) as f64 - copy as f64;
        let up = copies.relief.0 as f64 * left / steps;
        let back = copies.relief.1 as f64 * left / steps;
        // Of many copies, the first and the last ones.
        if copy > 3 && left > 3.0 {
            continue;
        }
        for (l, top, _) in &columns.all {
            // The end of a copy is a rounded place.
            if l + back >= end - SLACK {
                break;
            }
            let (low, high) = near(&part, l + back);
            if !(low + up - SLACK..=high + up + SLACK).contains(top) {
                return Err(format!(
                    "copy {copy} leaves {top} at {l}, and not {low}..{high} and {up}"
                ));
            }
        }
    }
    Ok(columns)
}

#[test]
fn random_contours_are_repeated_down_to_their_allowance() {
    leadscrew_seed::volume(73, |seed| {
        let many = leadscrew_seed::amount(1_000, 3_000);
        let away = Cell::new(0);
        let draw = |random: &mut Random| {
            let copies = Copies::random(random);
            away.set(away.get() + usize::from(copies.leads_away()));
            copies
        };
        check_all(seed, many, draw, Copies::smaller, check);
        assert!(away.get() > many / 2, "{}", away.get());
    });
}

/// A path that turns as it likes, for G73 has no order of its elements.
fn any_path(random: &mut Random) -> Contour {
    let most = 50_000_000;
    let place = |random: &mut Random| {
        Point::from_nm(random.within(-most, most), random.within(-most, most))
    };
    let start = place(random);
    let mut at = start;
    let mut elements = Vec::new();
    for index in 0..random.within(1, 12) {
        let kind = if index == 0 { 0 } else { random.within(0, 9) };
        let mut end = match random.within(0, 9) {
            0 => at,
            1 => start,
            2 => Point {
                x: at.x,
                ..place(random)
            },
            _ => place(random),
        };
        let shape = match kind {
            0 if random.one_in(2) => Shape::Rapid,
            0..=5 => Shape::Line,
            // A half circle, or a whole one.
            _ => {
                let half = |one: Length, other: Length| (one.nm() - other.nm()) / 2;
                let (mut i, mut k) = (half(end.x, at.x), half(end.z, at.z));
                if (i, k) == (0, 0) {
                    (i, k) = (random.within(1, most), random.within(-most, most));
                } else {
                    end = Point {
                        x: at.x + Length::from_nm(2 * i),
                        z: at.z + Length::from_nm(2 * k),
                    };
                }
                Shape::Arc {
                    i: Length::from_nm(i),
                    k: Length::from_nm(k),
                    clockwise: random.one_in(2),
                }
            }
        };
        elements.push(Element {
            end,
            shape,
            span: span(elements.len() + 1),
        });
        at = end;
    }
    let axes = Axes { x: true, z: true };
    Contour::new(start, axes, elements).expect("a contour")
}

#[test]
fn a_path_that_turns_as_it_likes_is_repeated_as_it_is() {
    leadscrew_seed::volume(7_300, |seed| {
        let many = leadscrew_seed::amount(1_000, 3_000);
        let mut random = Random(seed);
        for number in 0..many {
            let contour = any_path(&mut random);
            let mut length = || random.within(-20_000_000, 20_000_000) * random.within(0, 1);
            let words = Repeats {
                x: Length::from_nm(length()),
                z: Length::from_nm(length()),
                allowance: Allowance {
                    x: Diameter::from_nm(2 * length()),
                    z: Length::from_nm(length()),
                },
                passes: At::new(random.within(1, 30), span(101)),
                span: span(100),
            };
            let cuts: Vec<Cut> = contour.pattern(&words).expect("a cycle").collect();
            let checked = copies_of(&contour, &words, &cuts);
            let checked = checked.and_then(|_| ways_between_are_rapid(&cuts));
            if let Err(why) = checked {
                panic!("case {number}: {why}\n{words:#?}\n{contour:#?}");
            }
        }
    });
}
