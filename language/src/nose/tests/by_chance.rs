//! Paths by chance against what compensation is for: the centre of the nose never comes closer to the drawing
//! than its
//! radius, it is at that distance wherever it can be, and an alarm has a reason. All is measured on samples of
//! the path.

use std::f64::consts::{PI, TAU};

use super::{motions, round};
use crate::figures::{Chance, Stroke};
use crate::nose::{Entry, Filter, Input, Nose, Output, Post, Side};
use crate::plane::{Element, Point};

/// Samples of a motion.
const SAMPLES: u32 = 60;
/// A micrometre, nm.
const MICROMETRE: f64 = 1e3;

struct Case {
    path: Vec<Element>,
    side: Side,
    nose: Nose,
    entry: Entry,
}

impl Case {
    /// A start-up line, then `count` elements.
    fn new(chance: &mut Chance, count: usize) -> Self {
        let shortest = if count > 3 { 5e5 } else { 1e5 };
        let mut path = chance.path(count + 1, shortest, 3e7);
        while !matches!(path[0].shape, crate::plane::Shape::Line) {
            path = chance.path(count + 1, shortest, 3e7);
        }
        let nose = Nose {
            tip: chance.below(10) as u8,
            ..round(chance.size(0.05, 1.6))
        };
        Self {
            path,
            side: [Side::Left, Side::Right][chance.below(2) as usize],
            nose,
            entry: [Entry::A, Entry::B][chance.below(2) as usize],
        }
    }

    fn radius(&self) -> f64 {
        self.nose.radius.nm() as f64
    }

    fn strokes(&self) -> Vec<Stroke> {
        strokes(self.path.iter())
    }

    /// The strokes of the centre with the motion to which each belongs, or the number of the motion that is refused.
    fn run(&self) -> Result<Vec<(usize, Stroke)>, usize> {
        let mut filter = Filter::new(Point::default(), self.entry, Post::Rear);
        let mut out = Vec::new();
        for (i, motion) in motions(&self.path, &[self.side], self.nose)
            .into_iter()
            .enumerate()
        {
            filter.push(Input::Motion(motion, i)).map_err(|_| i)?;
            out.extend(std::iter::from_fn(|| filter.pull()));
        }
        filter.finish().map_err(|_| self.path.len())?;
        out.extend(std::iter::from_fn(|| filter.pull()));
        let mut owner = 0;
        let mut owned = Vec::new();
        for next in out {
            match next {
                Output::Motion(element, i) => {
                    owner = i;
                    owned.push((i, element));
                }
                Output::Corner(element) => owned.push((owner, element)),
                Output::Still(i) => owner = i,
                Output::Break(_) => unreachable!(),
            }
        }
        let strokes = strokes(owned.iter().map(|(_, element)| element));
        let centre = strokes.into_iter().map(|stroke| self.at_the_centre(stroke));
        Ok(owned.iter().map(|(i, _)| *i).zip(centre).collect())
    }

    /// From the tip to the centre, by the table of the tip directions as it is drawn.
    fn at_the_centre(&self, mut stroke: Stroke) -> Stroke {
        let z = match self.nose.tip {
            1 | 4 | 5 => -1.0,
            2 | 3 | 7 => 1.0,
            _ => 0.0,
        };
        let x = match self.nose.tip {
            1 | 2 | 6 => -1.0,
            3 | 4 | 8 => 1.0,
            _ => 0.0,
        };
        let shift = |place: (f64, f64)| (place.0 + x * self.radius(), place.1 + z * self.radius());
        stroke.start = shift(stroke.start);
        stroke.end = shift(stroke.end);
        stroke.arc = stroke.arc.map(|(centre, swept)| (shift(centre), swept));
        stroke
    }

    /// The centre where the nose touches a stroke.
    fn contact(&self, stroke: &Stroke, share: f64) -> (f64, f64) {
        let place = stroke.place(share);
        let quarter = if self.side == Side::Left {
            TAU / 4.0
        } else {
            -TAU / 4.0
        };
        let (sin, cos) = (stroke.heading(share) + quarter).sin_cos();
        (place.0 + self.radius() * sin, place.1 + self.radius() * cos)
    }

    /// The path between two motions, and along either, turns by half a turn at most: beyond that it goes round
    /// on purpose.
    fn is_near(&self, strokes: &[Stroke], i: usize, j: usize) -> bool {
        let (i, j) = (i.min(j), i.max(j));
        let mut turns = vec![0.0_f64, -strokes[i].swept()];
        let mut turn = 0.0;
        for k in i..j {
            let corner = strokes[k + 1].heading(0.0) - strokes[k].heading(1.0);
            turn += (corner + PI).rem_euclid(TAU) - PI;
            turns.push(turn);
            turn += strokes[k + 1].swept();
            turns.push(turn);
        }
        let [low, high] = [f64::min, f64::max].map(|pick| turns.iter().copied().fold(0.0, pick));
        high - low < PI
    }

    /// What is wrong with the path.
    fn check(&self) -> Result<bool, String> {
        let strokes = self.strokes();
        let reach = self.radius() - MICROMETRE;
        let path = match self.run() {
            Ok(path) => path,
            Err(at) => {
                return if self.has_a_reason(&strokes, at) {
                    Ok(false)
                } else {
                    Err(format!("motion {at} is refused without a reason"))
                };
            }
        };
        for (at, (i, stroke)) in path.iter().enumerate().filter(|(_, (i, _))| *i > 0) {
            // A move round a corner belongs to both motions.
            let is_corner = at > 0 && path[at - 1].0 == *i;
            let next = (i + usize::from(is_corner)).min(strokes.len() - 1);
            for share in shares() {
                let centre = stroke.place(share);
                for j in 1..strokes.len() {
                    let distance = strokes[j].distance(centre);
                    if distance < reach
                        && self.is_near(&strokes, *i, j)
                        && self.is_near(&strokes, next, j)
                        && self.crosses_not(&strokes, *i, j)
                    {
                        return Err(format!("motion {i} is {distance} from {j}"));
                    }
                }
            }
        }
        for (j, stroke) in strokes.iter().enumerate().skip(1) {
            for share in shares() {
                let contact = self.contact(stroke, share);
                // What is next to it counts as if it went on straight: the nose does not roll over the far end
                // of a short one.
                let is_free = strokes.iter().enumerate().skip(1).all(|(k, other)| {
                    let room = if k == j { -1.0 } else { 100.0 };
                    let straight_on = [
                        (k + 1 == j).then(|| other.before()),
                        (k == j + 1).then(|| other.after()),
                    ];
                    std::iter::once(*other)
                        .chain(straight_on.into_iter().flatten())
                        .all(|other| other.distance(contact) > self.radius() + room)
                });
                let away = path
                    .iter()
                    .map(|(_, own)| own.distance(contact))
                    .fold(f64::INFINITY, f64::min);
                if is_free && away > MICROMETRE {
                    return Err(format!("motion {j} is not touched at {share}: {away}"));
                }
            }
        }
        Ok(true)
    }

    /// The drawing itself does not cross there.
    fn crosses_not(&self, strokes: &[Stroke], i: usize, j: usize) -> bool {
        let (a, b) = (&strokes[i], &strokes[j]);
        i == j
            || i.abs_diff(j) == 1
            || shares().all(|share| b.distance(a.place(share)) > a.length() / f64::from(SAMPLES))
    }

    /// Somewhere up to a motion the nose cannot touch the drawing.
    fn has_a_reason(&self, strokes: &[Stroke], at: usize) -> bool {
        let last = at.min(strokes.len() - 1);
        let near = &strokes[..=last];
        // The moves round a corner, that of the start-up too, reach further from it than the nose: round an outside corner
        // the centre may be three radii away.
        let is_beside = (0..near.len()).any(|i| {
            let is_outside = near.get(i + 1).is_some_and(|next| {
                let turn = (next.heading(0.0) - near[i].heading(1.0) + PI).rem_euclid(TAU) - PI;
                (turn < 0.0) == (self.side == Side::Left)
            });
            let reach = if is_outside { 4.0 } else { 1.5 } * self.radius();
            (1..near.len()).any(|j| j != i && j != i + 1 && near[j].distance(near[i].end) < reach)
        });
        // An arc that is narrower than the nose by some nanometres: less than what contacts are compared by.
        let is_narrow = near[1..].iter().any(|stroke| {
            stroke.arc.is_some_and(|(centre, swept)| {
                let from_centre = |at: (f64, f64)| (at.0 - centre.0).hypot(at.1 - centre.1);
                let radius = from_centre(stroke.start).min(from_centre(stroke.end));
                (swept > 0.0) == (self.side == Side::Left) && radius < self.radius()
            })
        });
        is_beside
            || is_narrow
            || (1..near.len()).any(|i| {
                let is_blocked = |share: f64, others: &dyn Fn(usize) -> bool| {
                    let contact = self.contact(&near[i], share);
                    (1..near.len())
                        .any(|j| others(j) && near[j].distance(contact) < self.radius() - 1.0)
                };
                // All of it, or a part because of what is not next to it.
                let all = shares().all(|share| is_blocked(share, &|_| true));
                // A long motion that another one crosses is blocked on little of its way: four looks on each radius.
                let looks = (4.0 * near[i].length() / self.radius()).clamp(0.0, 20_000.0) as u32;
                let part = (0..=looks.max(SAMPLES)).any(|look| {
                    let share = f64::from(look) / f64::from(looks.max(SAMPLES));
                    is_blocked(share, &|j| j.abs_diff(i) != 1)
                });
                all || part || (i < last && !self.meets(&near[i], &near[i + 1]))
            })
    }

    /// The nose touches one motion up to a place, and the next one from that place on; it is clear of the
    /// other there.
    fn meets(&self, a: &Stroke, b: &Stroke) -> bool {
        // Finer toward the corner: a small nose meets there or nowhere.
        const FINE: u32 = 2_000;
        let fine = || (0..=FINE).map(|step| (f64::from(step) / f64::from(FINE)).powi(2));
        let clear =
            |place: &(f64, f64), other: &Stroke| other.distance(*place) >= self.radius() - 1.0;
        let mut back = fine()
            .map(|share| (share, self.contact(a, 1.0 - share)))
            .skip_while(|(_, place)| !clear(place, b));
        let mut on = fine()
            .map(|share| (share, self.contact(b, share)))
            .skip_while(|(_, place)| !clear(place, a));
        let (Some((before, last)), Some((after, first))) = (back.next(), on.next()) else {
            return false;
        };
        let step = |share: f64, stroke: &Stroke| {
            let share = (2.0 * share.sqrt() + 1.0 / f64::from(FINE)) / f64::from(FINE);
            (stroke.length() + 9.0 * self.radius()) * share
        };
        let step = step(before, a) + step(after, b);
        (last.0 - first.0).hypot(last.1 - first.1) < 4.0 * step
            && back.all(|(_, place)| clear(&place, b))
            && on.all(|(_, place)| clear(&place, a))
    }
}

fn shares() -> impl Iterator<Item = f64> {
    (0..=SAMPLES).map(|step| f64::from(step) / f64::from(SAMPLES))
}

fn strokes<'a>(path: impl Iterator<Item = &'a Element>) -> Vec<Stroke> {
    let mut from = Point::default();
    path.map(|element| {
        let stroke = Stroke::new(from, element);
        from = element.end;
        stroke
    })
    .collect()
}

/// Runs cases and gives how many were cut and how many refused. A case that fails is first made as short as it fails.
fn cases(seed: u64, count: u32, lengths: std::ops::RangeInclusive<u64>) -> [u32; 2] {
    let mut chance = Chance::new(seed);
    let mut done = [0; 2];
    for number in 0..count {
        let length = lengths.start() + chance.below(lengths.end() - lengths.start() + 1);
        let mut case = Case::new(&mut chance, length as usize);
        match case.check() {
            Ok(is_cut) => done[usize::from(!is_cut)] += 1,
            Err(mut why) => {
                while case.path.len() > 2 {
                    let last = case.path.pop().expect("three or more");
                    match case.check() {
                        Err(shorter) => why = shorter,
                        Ok(_) => {
                            case.path.push(last);
                            break;
                        }
                    }
                }
                let Case {
                    path,
                    side,
                    nose,
                    entry,
                } = &case;
                panic!("seed {seed}, case {number}: {why}\n{side:?} {nose:?} {entry:?}\n{path:?}");
            }
        }
    }
    done
}

#[test]
fn pairs() {
    leadscrew_seed::volume(0x0041, |seed| {
        let [cut, refused] = cases(seed, leadscrew_seed::amount(3_000, 40_000), 2..=2);
        assert!(cut > 1_000 && refused > 100, "{cut} cut, {refused} refused");
    });
}

#[test]
fn chains() {
    leadscrew_seed::volume(0x0033, |seed| {
        let [cut, refused] = cases(seed, leadscrew_seed::amount(2_000, 40_000), 3..=12);
        assert!(cut > 300 && refused > 300, "{cut} cut, {refused} refused");
    });
}
