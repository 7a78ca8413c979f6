//! The grooves of a thread, found in a part: one for each angle and turn, with its flanks as lines.

use crate::line::Line;
use crate::work::Work;

/// A groove at an angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Groove {
    /// Which angle.
    pub(crate) angle: usize,
    /// Flank towards −Z.
    pub(crate) minus: Line,
    /// Flank towards +Z.
    pub(crate) plus: Line,
    /// Its lowest height, taken to the face.
    pub(crate) floor: f64,
    /// The highest one between it and the next groove towards +Z, likewise; not a number where there is none.
    pub(crate) crest: f64,
    /// Its number along the thread: it grows by one from groove to groove at an angle.
    pub(crate) number: i64,
}

impl Groove {
    /// The height at which it is this wide.
    pub(crate) fn height_of_width(&self, width: f64) -> f64 {
        (width - (self.plus.at - self.minus.at)) / (self.plus.lean - self.minus.lean)
    }

    /// Middle at a height.
    pub(crate) fn middle(&self, height: f64) -> f64 {
        (self.plus.z(height) + self.minus.z(height)) / 2.0
    }
}

/// All grooves that have their full depth and both flanks.
#[derive(Clone, Debug)]
pub(crate) struct Grooves {
    pub(crate) list: Vec<Groove>,
    /// Number and angle to place in the list.
    places: Vec<u32>,
    pub(crate) first: i64,
    pub(crate) angles: usize,
    /// Middle of the groove of number 0 at angle 0, by the nominal lead.
    pub(crate) reference: f64,
}

/// Pitch, number of starts, and the taper that heights are freed from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    pub(crate) pitch: f64,
    pub(crate) starts: f64,
    /// Change of the height per millimetre of Z.
    pub(crate) taper: f64,
}

const NM: f64 = 1e6;
/// Shallower than this share of the height, a groove belongs to the run-in or the run-out.
const SHALLOW: f64 = 0.01;
const NOWHERE: u32 = u32::MAX;

struct Run {
    angle: usize,
    from: usize,
    to: usize,
    floor: f64,
    crest: f64,
    /// Another one follows at the same angle.
    closed: bool,
}

/// Height of a node, taken to the face.
fn level(work: &Work, course: &Course, node: usize, height: i32) -> f64 {
    f64::from(height) / NM - course.taper * (work.z(node) - work.stock().face.0)
}

/// Every stretch below a height that has a higher one on both sides.
fn runs(work: &Work, course: &Course, below: f64) -> Vec<Run> {
    let mut found: Vec<Run> = Vec::new();
    for angle in 0..work.grid().angles {
        let mut open: Option<Run> = None;
        let mut was_high = false;
        for (node, height) in work.line(angle).iter().enumerate() {
            let v = level(work, course, node, *height);
            if v < below {
                let fresh = was_high.then_some(Run {
                    angle,
                    from: node,
                    to: node,
                    floor: v,
                    crest: f64::NEG_INFINITY,
                    closed: false,
                });
                if let Some(before) = found.last_mut().filter(|run| run.angle == angle) {
                    before.closed = true;
                }
                open = open.or(fresh);
                was_high = false;
                if let Some(run) = &mut open {
                    run.to = node;
                    run.floor = run.floor.min(v);
                }
            } else {
                was_high = true;
                found.extend(open.take());
                if let Some(run) = found.last_mut().filter(|run| run.angle == angle) {
                    run.crest = run.crest.max(v);
                }
            }
        }
    }
    found
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut all: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied()
}

impl Grooves {
    /// Looks for the grooves; `None` where there is no thread.
    pub(crate) fn find(work: &Work, course: &Course) -> Option<Self> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (node, height) in work.line(0).iter().enumerate() {
            let v = level(work, course, node, *height);
            (low, high) = (low.min(v), high.max(v));
        }
        if high - low < 1e-3 {
            return None;
        }
        let first = runs(work, course, (low + high) / 2.0);
        let floor = median(first.iter().map(|run| run.floor))?;
        let crest = median(first.iter().map(|run| run.crest))?;
        let found = runs(work, course, (floor + crest) / 2.0);
        let is_shallow = |run: &&Run| run.floor > floor + SHALLOW * (crest - floor);
        // The tool has begun to leave, or has not arrived, before that shows: half a turn on either side is left out.
        let away = course.pitch * course.starts / 2.0;
        let middle = |run: &Run| (work.z(run.from) + work.z(run.to)) / 2.0;
        let mut shallow: Vec<f64> = found.iter().filter(is_shallow).map(middle).collect();
        shallow.sort_by(f64::total_cmp);
        let is_near = |run: &Run| {
            let z = middle(run);
            let next = shallow.partition_point(|other| *other < z - away);
            shallow.get(next).is_some_and(|other| *other <= z + away)
        };
        // Beside a ring, or what else was cut off the helix, a groove has no flank of its own for a pitch.
        let (low, high) = work.helix();
        let is_thread = |run: &Run| {
            let z = middle(run);
            z > low + course.pitch && z < high - course.pitch
        };
        let list: Vec<Groove> = found
            .iter()
            .filter(|run| !is_near(run) && is_thread(run))
            .filter_map(|run| flanks(work, course, run, floor, crest))
            .collect();
        Self::number(list, work, course, (floor + crest) / 2.0)
    }

    fn number(mut list: Vec<Groove>, work: &Work, course: &Course, middle: f64) -> Option<Self> {
        let angles = work.grid().angles;
        let way = work.course();
        let face = work.stock().face.0;
        let place = |groove: &Groove| {
            // The flanks are lines over the true height, and the middle height is one at the face.
            let z = groove.middle(middle);
            groove.middle(middle + course.taper * (z - face))
        };
        let turned = |groove: &Groove| groove.angle as f64 / angles as f64 * course.starts;
        let at_zero = |groove: &Groove| place(groove) - way * course.pitch * turned(groove);
        let nearest = list.iter().max_by(|a, b| place(a).total_cmp(&place(b)))?;
        let reference = at_zero(nearest);
        for groove in &mut list {
            groove.number = (way * (at_zero(groove) - reference) / course.pitch).round() as i64;
        }
        let first = list.iter().map(|groove| groove.number).min()?;
        let last = list.iter().map(|groove| groove.number).max()?;
        let mut places = vec![NOWHERE; (last - first + 1) as usize * angles];
        for (n, groove) in list.iter().enumerate() {
            places[(groove.number - first) as usize * angles + groove.angle] = n as u32;
        }
        Some(Self {
            list,
            places,
            first,
            angles,
            reference,
        })
    }

    /// The groove of a number at an angle.
    pub(crate) fn get(&self, number: i64, angle: usize) -> Option<&Groove> {
        let row = usize::try_from(number - self.first).ok()?;
        let place = *self.places.get(row * self.angles + angle)?;
        self.list.get(place as usize)
    }

    /// The groove half a turn behind this one, on the other side of the part.
    pub(crate) fn opposite(&self, groove: &Groove, starts: i64) -> Option<&Groove> {
        let half = self.angles / 2;
        if groove.angle >= half {
            self.get(groove.number + starts, groove.angle - half)
        } else {
            self.get(groove.number, groove.angle + half)
        }
    }
}

/// The flanks of a run between a fifth and four fifths of the height; `None` where one of them is not whole.
fn flanks(work: &Work, course: &Course, run: &Run, floor: f64, crest: f64) -> Option<Groove> {
    let line = work.line(run.angle);
    let (low, high) = (floor + 0.2 * (crest - floor), floor + 0.8 * (crest - floor));
    let at = |node: usize| level(work, course, node, line[node]);
    let top = |mut nodes: Box<dyn Iterator<Item = usize>>| nodes.find(|n| at(*n) >= high);
    let bottom = |mut nodes: Box<dyn Iterator<Item = usize>>| nodes.find(|n| at(*n) <= low);
    let reach = (course.pitch / work.grid().step.0) as usize;
    let minus_top = top(Box::new((run.from.saturating_sub(reach)..run.from).rev()))?;
    let minus_bottom = bottom(Box::new(run.from..=run.to))?;
    let plus_top = top(Box::new(run.to + 1..(run.to + reach).min(line.len())))?;
    let plus_bottom = bottom(Box::new((run.from..=run.to).rev()))?;
    let fit = |from: usize, to: usize| {
        Line::through((from..=to).map(|node| (f64::from(line[node]) / NM, work.z(node))))
    };
    Some(Groove {
        angle: run.angle,
        minus: fit(minus_top + 1, minus_bottom - 1)?,
        plus: fit(plus_bottom + 1, plus_top - 1)?,
        floor: run.floor,
        crest: if run.closed { run.crest } else { f64::NAN },
        number: 0,
    })
}
