//! Lead, its error, drunkenness, and where the starts lie.

use crate::groove::{Course, Grooves};
use crate::units::{Mm, Turns};

/// The lead of a thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lead {
    /// Travel per turn, by regression over all turns and angles.
    pub lead: Mm,
    /// That minus the nominal one.
    pub error: Mm,
    /// Largest minus smallest distance from the nominal helix that any angle has over all turns.
    pub cumulative: Mm,
    /// Turns from the first full groove, and the distance from the nominal helix; of the first start.
    pub course: Vec<(Turns, Mm)>,
}

/// How far the helix sways within a turn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drunkenness {
    /// Highest minus lowest in the worst turn, of its harmonics 1 to 8.
    pub worst: Mm,
    /// Amplitudes of the harmonics 1 to 8 that all turns have in common.
    pub repeated: [Mm; HARMONICS],
}

const HARMONICS: usize = 8;

/// A groove as a point of its helix.
#[derive(Clone, Copy, Debug)]
struct Point {
    angle: usize,
    start: usize,
    /// Whole turns.
    turn: i64,
    /// Distance along the thread from the reference.
    way: f64,
}

/// The middles of all grooves at a height, as points of their helix.
#[derive(Clone, Debug)]
pub(crate) struct Helix {
    points: Vec<Point>,
    angles: usize,
    starts: usize,
    pitch: f64,
    lead: f64,
}

impl Helix {
    /// `height`: of the pitch line at the face.
    pub(crate) fn of(grooves: &Grooves, course: &Course, way: f64, height: f64, face: f64) -> Self {
        let starts = course.starts as usize;
        let points = grooves.list.iter().map(|groove| {
            let z = groove.middle(height);
            let z = groove.middle(height + course.taper * (z - face));
            Point {
                angle: groove.angle,
                start: groove.number.rem_euclid(starts as i64) as usize,
                turn: groove.number.div_euclid(starts as i64),
                way: way * (z - grooves.reference),
            }
        });
        let mut helix = Self {
            points: points.collect(),
            angles: grooves.angles,
            starts,
            pitch: course.pitch,
            lead: course.pitch * course.starts,
        };
        helix.lead = helix.regression();
        helix
    }

    fn turns(&self, point: &Point) -> f64 {
        point.turn as f64 + point.angle as f64 / self.angles as f64
    }

    fn series(&self, point: &Point) -> usize {
        point.start * self.angles + point.angle
    }

    /// One lead for all, an intercept for each angle and start: what repeats each turn does not count in it.
    fn regression(&self) -> f64 {
        let mut sums = vec![(0.0, 0.0, 0.0); self.angles * self.starts];
        for point in &self.points {
            let sum = &mut sums[self.series(point)];
            sum.0 += 1.0;
            sum.1 += point.turn as f64;
            sum.2 += point.way;
        }
        let (mut above, mut below) = (0.0, 0.0);
        for point in &self.points {
            let (n, turns, ways) = sums[self.series(point)];
            let t = point.turn as f64 - turns / n;
            above += t * (point.way - ways / n);
            below += t * t;
        }
        if below > 0.0 {
            above / below
        } else {
            self.lead
        }
    }

    /// The lead against a nominal one.
    pub(crate) fn lead(&self, nominal: f64) -> Lead {
        let off = |point: &Point| {
            point.way - nominal * self.turns(point) - self.pitch * point.start as f64
        };
        let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); self.angles * self.starts];
        for point in &self.points {
            let range = &mut ranges[self.series(point)];
            *range = (range.0.min(off(point)), range.1.max(off(point)));
        }
        let widest = ranges.iter().map(|(low, high)| high - low);
        let first = self.points.iter().filter(|point| point.start == 0);
        let mut course: Vec<_> = first
            .map(|point| (Turns(self.turns(point)), Mm(off(point))))
            .collect();
        course.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let (turns, base) = course.first().copied().unwrap_or_default();
        for (turn, error) in &mut course {
            (*turn, *error) = (*turn - turns, *error - base);
        }
        Lead {
            lead: Mm(self.lead),
            error: Mm(self.lead - nominal),
            cumulative: Mm(widest.fold(0.0, f64::max)),
            course,
        }
    }

    /// What is left of each point when its start's helix with the measured lead is taken away.
    fn rest(&self, point: &Point) -> f64 {
        point.way - self.lead * self.turns(point)
    }

    /// Where each start lies from where it should, the first one being the reference.
    pub(crate) fn starts(&self) -> Vec<Mm> {
        let mut sums = vec![(0.0, 0.0); self.starts];
        for point in &self.points {
            let sum = &mut sums[point.start];
            *sum = (sum.0 + 1.0, sum.1 + self.rest(point));
        }
        let mean = |(n, sum): (f64, f64)| if n > 0.0 { sum / n } else { f64::NAN };
        let first = sums.first().copied().map_or(0.0, mean);
        let each = sums.iter().enumerate();
        each.map(|(start, sum)| Mm(mean(*sum) - first - start as f64 * self.pitch))
            .collect()
    }

    /// The sway within a turn.
    pub(crate) fn drunkenness(&self) -> Drunkenness {
        let mut sums = vec![(0.0, 0.0); self.angles];
        let mut by_turn = std::collections::BTreeMap::<(usize, i64), Vec<f64>>::new();
        for point in &self.points {
            let rest = self.rest(point) - self.pitch * point.start as f64;
            let sum = &mut sums[point.angle];
            *sum = (sum.0 + 1.0, sum.1 + rest);
            let turn = by_turn.entry((point.start, point.turn)).or_default();
            if turn.is_empty() {
                turn.resize(self.angles, f64::NAN);
            }
            turn[point.angle] = rest;
        }
        let whole = |turn: &&Vec<f64>| turn.iter().all(|v| v.is_finite());
        let worst = by_turn
            .values()
            .filter(whole)
            .map(|turn| sway(&harmonics(turn), self.angles))
            .fold(0.0, f64::max);
        let common: Vec<f64> = sums.iter().map(|(n, sum)| sum / n).collect();
        let mut repeated = [Mm(0.0); HARMONICS];
        if common.iter().all(|v| v.is_finite()) {
            for (kept, (a, b)) in repeated.iter_mut().zip(harmonics(&common)) {
                *kept = Mm(a.hypot(b));
            }
        }
        Drunkenness {
            worst: Mm(worst),
            repeated,
        }
    }
}

fn harmonics(turn: &[f64]) -> [(f64, f64); HARMONICS] {
    let step = std::f64::consts::TAU / turn.len() as f64;
    let share = 2.0 / turn.len() as f64;
    let mut found = [(0.0, 0.0); HARMONICS];
    for (order, (a, b)) in (1..).zip(&mut found) {
        for (n, value) in turn.iter().enumerate() {
            let (sin, cos) = (step * f64::from(order) * n as f64).sin_cos();
            *a += share * value * cos;
            *b += share * value * sin;
        }
    }
    found
}

/// Highest minus lowest of a sum of harmonics.
fn sway(harmonics: &[(f64, f64); HARMONICS], angles: usize) -> f64 {
    let step = std::f64::consts::TAU / angles as f64;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for n in 0..angles {
        let value: f64 = (1..)
            .zip(harmonics)
            .map(|(order, (a, b))| {
                let (sin, cos) = (step * f64::from(order) * n as f64).sin_cos();
                a * cos + b * sin
            })
            .sum();
        (low, high) = (low.min(value), high.max(value));
    }
    high - low
}
