//! A tapped hole near by: its strokes over the turns of the spindle, with the chip of each infeed, and its bottom, where
//! the spindle turns back. Holes that are alike lie one upon the other.

use leadscrew_core::alarm::Lang;
use leadscrew_core::moves::Stage;
use svg::Node as _;
use svg::node::element::Group;

use super::pane::{Area, Axes, Pane, Range};
use super::{depth, told};
use crate::number::measured;
use crate::plot::{frame, simplified, text};
use crate::words::pick;

/// A stroke of a tap, from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Number of its hole from 1.
    pub hole: u32,
    /// Number of the infeed in its hole from 1; 0 for another stroke.
    pub infeed: u32,
    /// What it is for.
    pub stage: Stage,
    /// The line of the program as the machine counts it.
    pub line: u32,
    /// Turns of the spindle in this hole before it, in and out.
    pub turned: f64,
    /// Depth below R at its ends, millimetres.
    pub depth: (f64, f64),
    /// From which to which depth it cuts, millimetres; alike where it cuts nothing.
    pub fresh: (f64, f64),
}

impl Stroke {
    /// The millimetres of depth that it cuts.
    pub fn cuts(&self) -> f64 {
        self.fresh.1 - self.fresh.0
    }
}

/// What the spindle and the axis did in the last quarter of a turn before the bottom, and beyond.
#[derive(Clone, Debug, Default)]
pub struct Reversal {
    /// Each time: degrees of the spindle and micrometres of the axis beyond the bottom, in the order of time.
    visits: Vec<Vec<(f64, f64)>>,
    is_there: bool,
    /// The number of points kept.
    points: usize,
}

/// The most points of a reversal.
const POINTS: usize = 20_000;
/// How much of a turn before the bottom is shown.
const QUARTER: f64 = 0.25;

impl Reversal {
    /// The tap is elsewhere.
    fn leave(&mut self) {
        self.is_there = false;
    }

    /// Adds a tick: turns of the spindle, and millimetres of the axis, beyond the bottom; both minus before it.
    fn push(&mut self, turns: f64, mm: f64) {
        if turns < -QUARTER {
            return self.leave();
        }
        if !std::mem::replace(&mut self.is_there, true) {
            self.visits.push(Vec::new());
        }
        let point = (turns * 360.0, mm * 1e3);
        if let Some(visit) = self.visits.last_mut()
            && visit.last() != Some(&point)
            && self.points < POINTS
        {
            visit.push(point);
            self.points += 1;
        }
    }

    /// How far beyond the bottom, degrees and micrometres; `None` where the tap was not there.
    fn overshoot(&self) -> Option<(f64, f64)> {
        let points = self.visits.iter().flatten().copied();
        points.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)))
    }
}

/// Holes that are alike.
#[derive(Clone, Debug)]
pub struct Tap {
    /// Name of the axis that travels.
    pub axis: &'static str,
    /// The spindle stands in position mode, and one master moves both.
    pub is_rigid: bool,
    /// Travel in a turn, millimetres.
    pub lead: f64,
    /// Turns into the hole are plus.
    pub is_right_hand: bool,
    /// From R to the bottom, millimetres.
    pub bottom: f64,
    /// From R to where the material begins and to where it ends, millimetres, where that is known.
    pub material: (Option<f64>, Option<f64>),
    /// In the order of time.
    pub strokes: Vec<Stroke>,
    /// What was done at the bottom.
    pub reversal: Reversal,
    /// Turns since R in the tick before.
    pub at: Option<f64>,
}

impl Tap {
    /// Adds a tick: depth below R in millimetres, and turns of the spindle since R. False where the spindle has not turned.
    pub fn push(&mut self, depth: f64, turned: f64) -> bool {
        let inward = if self.is_right_hand { turned } else { -turned };
        let turns = inward - self.bottom / self.lead;
        self.reversal.push(turns, depth - self.bottom);
        self.at.replace(turned) != Some(turned)
    }

    /// The tap is in no hole of these.
    pub fn leave(&mut self) {
        self.reversal.leave();
        self.at = None;
    }
}

/// Draws both views.
pub(super) fn draw(document: &mut Group, area: Area, tap: &Tap, n: usize, lang: Lang) {
    let (strokes, bottom) = depth::beside(area);
    draw_strokes(document, strokes, tap, n, lang);
    draw_bottom(document, bottom, tap, n, lang);
}

/// Depth over the turns in and out, as a page tells a place.
const fn over_turns(lang: Lang) -> Axes {
    let (right, up) = match lang {
        Lang::En => ("turns", "depth"),
        Lang::Zh => ("转", "深度"),
    };
    Axes {
        written: (1.0, 1.0),
        labels: (right, "mm"),
        names: (right, up),
        is_down: true,
        is_count: false,
    }
}

/// Depth over the turns of the spindle, in and out.
fn draw_strokes(document: &mut Group, area: Area, tap: &Tap, n: usize, lang: Lang) {
    let ends = tap.strokes.iter().flat_map(|stroke| {
        let turns = (stroke.depth.1 - stroke.depth.0).abs() / tap.lead;
        [
            (stroke.turned, stroke.depth.0),
            (stroke.turned + turns, stroke.depth.1),
        ]
    });
    let Some(range) = Range::of(ends.chain([(0.0, 0.0), (0.0, tap.bottom)])) else {
        return;
    };
    let range = range.with_room(0.02, 0.1);
    let pane = Pane::filled(area, over_turns(lang), range, format!("tap{n}"));
    let mut inside = pane.frame(document);
    depth::material(&mut inside, &pane, tap.material);
    for stroke in &tap.strokes {
        for (class, points) in parts(stroke, tap.lead) {
            let pixels = points.map(|point| pane.place(point));
            let words = words(stroke, tap.lead, lang);
            inside.append(told(class, pixels, &words, stroke.line, lang));
        }
    }
    document.append(inside);
    depth::marks(document, &pane, (tap.material.0, tap.bottom), lang);
    depths(document, &pane, tap, lang);
    let at = frame::keys(
        document,
        area.left,
        area.top - 8.0,
        [
            ("tap", pick(lang, "cuts", "切削")),
            (
                "run-out",
                pick(lang, "in its own thread, or outside", "在已攻螺纹内或孔外"),
            ),
        ],
    );
    let words = pick(
        lang,
        "depth over the turns, in and out",
        "深度随主轴转数（进与出）",
    );
    document.append(text(at, area.top - 8.0, "key", words));
}

/// What a stroke goes through: what it cuts, and the rest.
fn parts(stroke: &Stroke, lead: f64) -> Vec<(&'static str, [(f64, f64); 2])> {
    let (from, to) = stroke.depth;
    let at = |depth: f64| (stroke.turned + (depth - from).abs() / lead, depth);
    if stroke.cuts() <= 0.0 {
        return vec![("line run-out", [at(from), at(to)])];
    }
    let (begin, end) = stroke.fresh;
    let parts = [
        ("line run-out", from, begin),
        ("line tap", begin, end),
        ("line run-out", end, to),
    ];
    let parts = parts.into_iter().filter(|(_, from, to)| to > from);
    parts
        .map(|(class, from, to)| (class, [at(from), at(to)]))
        .collect()
}

/// What a page tells of a stroke before its line.
fn words(stroke: &Stroke, lead: f64, lang: Lang) -> String {
    let (hole, infeed) = (stroke.hole, stroke.infeed);
    let (to, chip) = (measured(stroke.depth.1), measured(stroke.cuts() / lead));
    match (stroke.stage, lang) {
        (Stage::Tap, Lang::En) => {
            format!("hole {hole}, infeed {infeed} to {to} mm, chip of {chip} turns, ")
        }
        (Stage::Tap, Lang::Zh) => {
            format!("第 {hole} 孔，第 {infeed} 次进给至 {to} mm，切屑 {chip} 转，")
        }
        (Stage::Reenter, Lang::En) => format!("hole {hole}, into the hole again to {to} mm, "),
        (Stage::Reenter, Lang::Zh) => format!("第 {hole} 孔，再次进入至 {to} mm，"),
        (_, Lang::En) => format!("hole {hole}, back to {to} mm, "),
        (_, Lang::Zh) => format!("第 {hole} 孔，退至 {to} mm，"),
    }
}

/// Number and depth of the infeeds beside the view; of holes that are alike the first one's.
fn depths(document: &mut Group, pane: &Pane, tap: &Tap, lang: Lang) {
    let first = tap.strokes.iter().take_while(|stroke| stroke.hole == 1);
    let infeeds = first.filter(|stroke| stroke.stage == Stage::Tap);
    let labels: Vec<(f64, String)> = infeeds
        .map(|stroke| {
            let (number, deep) = (stroke.infeed, measured(stroke.depth.1));
            let chip = measured(stroke.cuts() / tap.lead);
            (stroke.depth.1, format!("{number}: {deep} / {chip}"))
        })
        .collect();
    let name = pick(lang, "depth mm / chip turns", "深度 mm / 切屑转数");
    depth::labels(document, pane, &labels, name);
}

/// The axis over the angle of the spindle at the bottom.
fn draw_bottom(document: &mut Group, area: Area, tap: &Tap, n: usize, lang: Lang) {
    let points = tap.reversal.visits.iter().flatten().copied();
    let Some((range, (degrees, micrometres))) = Range::of(points).zip(tap.reversal.overshoot())
    else {
        let words = pick(
            lang,
            "no stroke came to the bottom in this run",
            "本次运行中没有到达孔底",
        );
        document.append(text(area.left, area.top - 8.0, "key", words));
        return;
    };
    let axes = Axes {
        written: (1.0, 1.0),
        labels: ("°", "µm"),
        names: ("°", "µm"),
        is_down: true,
        is_count: false,
    };
    let (z, r) = (range.z, range.r);
    // The bottom is always in it, and what is beyond has room.
    let range = Range {
        z: (z.0.min(-1.0), z.1.max(0.0)),
        r: (r.0.min(-1.0), r.1.max(0.0)),
    };
    let pane = Pane::filled(area, axes, range.with_room(0.05, 0.12), format!("turn{n}"));
    let mut inside = pane.frame(document);
    let (x, y) = pane.place((0.0, 0.0));
    frame::line(&mut inside, "mark", [(x, area.top), (x, area.bottom)]);
    frame::line(&mut inside, "mark", [(area.left, y), (area.right, y)]);
    for visit in &tap.reversal.visits {
        let deepest = visit.iter().enumerate();
        let deepest = deepest.max_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let turn = deepest.map_or(0, |(at, _)| at);
        for (class, part) in [("depth", &visit[..=turn]), ("turned", &visit[turn..])] {
            let pixels: Vec<_> = part.iter().map(|point| pane.place(*point)).collect();
            let class = format!("line {class}");
            frame::line(&mut inside, &class, simplified(&pixels, 0.1));
        }
    }
    document.append(inside);
    let (micrometres, degrees) = (hundredths(micrometres), hundredths(degrees));
    let words = match lang {
        Lang::En => format!("overshoot {micrometres} µm, {degrees}°"),
        Lang::Zh => format!("过冲 {micrometres} µm、{degrees}°"),
    };
    document.append(text(area.left + 10.0, area.bottom - 10.0, "name", &words));
    let at = frame::keys(
        document,
        area.left,
        area.top - 8.0,
        [
            ("depth", pick(lang, "in", "进")),
            ("turned", pick(lang, "out", "出")),
        ],
    );
    let words = pick(
        lang,
        "at the bottom, over the spindle angle",
        "孔底处（沿主轴角度）",
    );
    document.append(text(at, area.top - 8.0, "key", words));
}

/// What is beyond the bottom, to a hundredth; nothing where the tap did not go there.
fn hundredths(value: f64) -> String {
    crate::number::text::<2>((value.max(0.0) * 100.0).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A right-hand and a left-hand tap of 10 turns that go on by a tenth of a turn.
    #[test]
    fn what_goes_beyond_the_bottom_is_the_overshoot() {
        for hand in [1.0, -1.0] {
            let mut tap = Tap {
                axis: "Z",
                is_rigid: false,
                lead: 1.5,
                is_right_hand: hand > 0.0,
                bottom: 15.0,
                material: (None, None),
                strokes: Vec::new(),
                reversal: Reversal::default(),
                at: None,
            };
            for turned in [9.0, 9.5, 9.8, 10.0, 10.1, 10.1, 9.9, 9.6, 9.0, 9.8, 9.7] {
                tap.push(1.5 * turned, hand * turned);
            }
            let visits = &tap.reversal.visits;
            assert_eq!(visits.iter().map(Vec::len).collect::<Vec<_>>(), [4, 1]);
            let (degrees, micrometres) = tap.reversal.overshoot().unwrap();
            assert!((degrees - 36.0).abs() < 1e-6 && (micrometres - 150.0).abs() < 1e-6);
        }
        assert_eq!(Reversal::default().overshoot(), None);
    }

    #[test]
    fn an_infeed_cuts_what_was_not_cut_before() {
        let stroke = Stroke {
            hole: 1,
            infeed: 2,
            stage: Stage::Tap,
            line: 5,
            turned: 2.5,
            depth: (3.0, 9.0),
            fresh: (4.0, 8.0),
        };
        assert_eq!(
            parts(&stroke, 2.0),
            [
                ("line run-out", [(2.5, 3.0), (3.0, 4.0)]),
                ("line tap", [(3.0, 4.0), (5.0, 8.0)]),
                ("line run-out", [(5.0, 8.0), (5.5, 9.0)])
            ]
        );
        let out = Stroke {
            depth: (8.0, 0.0),
            fresh: (8.0, 8.0),
            ..stroke
        };
        assert_eq!(
            parts(&out, 2.0),
            [("line run-out", [(2.5, 8.0), (6.5, 0.0)])]
        );
    }
}
