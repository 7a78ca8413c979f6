//! Zones: no path whose tip touches one is let in, and none is refused that stays a micrometre away from all of them.
//!
//! What is tested is exact arithmetic on whole paths. What judges it knows nothing of that: it looks for the least distance
//! between points of the path and the rectangle, and divides the path until no closer point can be between two others.

use leadscrew_core::alarm::Span;
use leadscrew_core::call::{CallKind, FeedRate, Position};
use leadscrew_core::cycle::{self, Context, Forbidden, Moves};
use leadscrew_core::moves::{Cycle, Move, MoveKind, Stage};
use leadscrew_core::params::Params;
use leadscrew_core::program::{self, Events, Options};
use leadscrew_core::units::{Angle, Feed, Length};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

/// Nothing of this size is looked for, in nm.
const FINE: f64 = 0.5;
/// What has to be let in is so far away, in nm.
const CLEAR: f64 = 1_000.0;

type Point = (f64, f64);

/// X from, to; Z from, to; in nm.
#[derive(Clone, Copy, Debug)]
struct Rectangle([f64; 4]);

/// The rectangles of a parameter set.
fn rectangles(params: &Params) -> Vec<Rectangle> {
    let nm = |length: Length| length.nm() as f64;
    let face = nm(params.chuck_face());
    let around = |diameter: Length, from: f64, to: f64| {
        let radius = nm(diameter) / 2.0;
        (radius > 0.0 && from < to).then_some(Rectangle([-radius, radius, from, to]))
    };
    [
        around(
            params.chuck_diameter(),
            face - nm(params.chuck_length()),
            face,
        ),
        around(
            params.jaws_diameter(),
            face,
            face + nm(params.jaws_length()),
        ),
        around(
            params.tailstock_diameter(),
            nm(params.tailstock_front()),
            1e15,
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

impl Rectangle {
    /// How far the nearest point of a straight way along X is, from `x` to `level`; 0 where it touches.
    fn distance(self, (x, z): Point, level: f64) -> f64 {
        let Self([x_low, x_high, z_low, z_high]) = self;
        let (low, high) = (x.min(level), x.max(level));
        let aside_x = (x_low - high).max(low - x_high).max(0.0);
        let aside_z = (z_low - z).max(z - z_high).max(0.0);
        aside_x.hypot(aside_z)
    }
}

/// A path as points of its way, each with the level down to which all is meant.
struct Path<'a> {
    length: f64,
    /// At a part of the way.
    at: &'a dyn Fn(f64) -> Point,
    level: Option<f64>,
}

impl Path<'_> {
    fn to(&self, rectangle: Rectangle, part: f64) -> f64 {
        let point = (self.at)(part);
        rectangle.distance(point, self.level.unwrap_or(point.0))
    }

    /// Along a straight way the distance falls, and then rises.
    fn straight(&self, rectangle: Rectangle) -> f64 {
        let (mut from, mut to) = (0.0, 1.0);
        for _ in 0..100 {
            let third = (to - from) / 3.0;
            let [a, b] = [from + third, to - third];
            if self.to(rectangle, a) <= self.to(rectangle, b) {
                to = b;
            } else {
                from = a;
            }
        }
        let ends = self.to(rectangle, 0.0).min(self.to(rectangle, 1.0));
        self.to(rectangle, f64::midpoint(from, to)).min(ends)
    }

    /// Along any other it changes by the way at most.
    fn bent(&self, rectangle: Rectangle) -> f64 {
        let mut least = self.to(rectangle, 0.0).min(self.to(rectangle, 1.0));
        let mut pieces = vec![(0.0, 1.0)];
        while let Some((from, to)) = pieces.pop() {
            let middle = f64::midpoint(from, to);
            let here = self.to(rectangle, middle);
            least = least.min(here);
            let reach = (to - from) / 2.0 * self.length;
            if here - reach < least - FINE && reach > FINE && least > 0.0 {
                pieces.extend([(from, middle), (middle, to)]);
            }
        }
        least
    }
}

/// The distance of a move's tip from a rectangle.
fn of_move(from: Position, next: &Move, home: Position, tip: [Length; 2], zone: Rectangle) -> f64 {
    let point = |at: Position| ((at.x - tip[0]).nm() as f64, (at.z - tip[1]).nm() as f64);
    let (a, b) = (point(from), point(next.to));
    match next.kind {
        MoveKind::Arc {
            i, k, clockwise, ..
        } => {
            let centre = (a.0 + i.nm() as f64, a.1 + k.nm() as f64);
            let ray = |p: Point| (p.0 - centre.0, p.1 - centre.1);
            let angle = |p: Point| ray(p).0.atan2(ray(p).1);
            let radius = |p: Point| ray(p).0.hypot(ray(p).1);
            let mut turn = (angle(b) - angle(a)).rem_euclid(std::f64::consts::TAU);
            if clockwise {
                turn -= std::f64::consts::TAU;
            }
            if a == b {
                turn = std::f64::consts::TAU;
            }
            let at = |part: f64| {
                let r = radius(a) + (radius(b) - radius(a)) * part;
                let (sin, cos) = (angle(a) + turn * part).sin_cos();
                (centre.0 + r * sin, centre.1 + r * cos)
            };
            let length = turn.abs() * radius(a).max(radius(b)) + (radius(a) - radius(b)).abs();
            Path {
                length,
                at: &at,
                level: None,
            }
            .bent(zone)
        }
        _ => {
            let at = |part: f64| (a.0 + (b.0 - a.0) * part, a.1 + (b.1 - a.1) * part);
            let drawn_back = matches!(next.kind, MoveKind::Thread(_));
            Path {
                length: (b.0 - a.0).hypot(b.1 - a.1),
                at: &at,
                level: drawn_back.then(|| point(home).0),
            }
            .straight(zone)
        }
    }
}

/// Zones of all sizes; each is off at times.
fn zones(random: &mut Random) -> Params {
    let mut size = |most: i64| match random.chance(20) {
        true => 0,
        false => random.within(1, most * 10_000) * 100,
    };
    let (length, jaws, chuck, around, tailstock) =
        (size(80), size(60), size(240), size(180), size(120));
    let face = random.within(-500_000, 500_000) * 100;
    with(&[
        ("9033", 0),
        ("9091", face),
        ("9092", length),
        ("9093", chuck),
        ("9094", jaws),
        ("9095", around),
        ("9096", face + random.within(1, 200_000_000) / 100 * 100),
        ("9097", tailstock),
    ])
}

/// A coordinate anywhere, or within two micrometres of an edge.
fn near(random: &mut Random, edges: &[f64]) -> Length {
    let finite = edges.iter().filter(|edge| edge.abs() < 1e12);
    let edges: Vec<i64> = finite.map(|edge| *edge as i64).collect();
    Length::from_nm(match edges.is_empty() || random.chance(50) {
        true => random.within(-150_000_000, 150_000_000),
        false => random.of(&edges) + random.within(-2_000, 2_000),
    })
}

struct Case {
    params: Params,
    rectangles: Vec<Rectangle>,
    tip: [Length; 2],
}

impl Case {
    fn new(random: &mut Random) -> Self {
        let params = zones(random);
        let mut length = || Length::from_nm(random.within(-200_000, 200_000) * 500);
        Self {
            rectangles: rectangles(&params),
            tip: [length(), length()],
            params,
        }
    }

    fn place(&self, random: &mut Random) -> Position {
        let [mut across, mut along] = [Vec::new(), Vec::new()];
        for Rectangle([x_low, x_high, z_low, z_high]) in &self.rectangles {
            across.extend([*x_low, *x_high]);
            along.extend([*z_low, *z_high]);
        }
        Position {
            x: near(random, &across) + self.tip[0],
            z: near(random, &along) + self.tip[1],
            c: Angle::ZERO,
        }
    }

    /// True where the moves are let in. The judge agrees, or does not care.
    fn judge(&self, from: Position, moves: &Moves, what: &str) -> bool {
        let forbidden = Forbidden::of(&self.params, 1, Some(self.tip));
        let admitted = cycle::clear_of_zones(moves, from, &forbidden).is_ok();
        let mut least = f64::MAX;
        let mut at = from;
        for next in *moves {
            let stands = (next.to.x, next.to.z) == (at.x, at.z);
            if !stands || matches!(next.kind, MoveKind::Arc { .. }) {
                for zone in &self.rectangles {
                    least = least.min(of_move(at, &next, from, self.tip, *zone));
                }
            }
            at = next.to;
        }
        assert!(
            !admitted || least > 0.0,
            "{what}: it touches: {least} nm {moves:?} {from:?} {:?}",
            self.rectangles
        );
        assert!(
            admitted || least < CLEAR,
            "{what}: refused, {least} nm away: {moves:?} {from:?} {:?} {:?}",
            self.rectangles,
            self.tip
        );
        admitted
    }
}

fn one(to: Position, kind: MoveKind) -> Moves {
    Moves::One(Some(Move {
        span: Span::default(),
        to,
        kind,
        tag: None,
    }))
}

const FEED: FeedRate = FeedRate::PerMinute(Feed::from_nm_per_min(100_000_000));

/// A share of what was tried that has to be let in, and one that has to be refused: else nothing was tested. The cases are
/// drawn anew for each commit, and the share among some dozens of them may be far from that among thousands.
fn both_ways(admitted: u64, of: u64) {
    let refused = of - admitted;
    assert!(
        admitted * 40 > of && refused * 40 > of,
        "{admitted} of {of}"
    );
}

#[test]
fn straight_paths() {
    leadscrew_seed::volume(41, |seed| {
        let mut random = Random(seed);
        let count = leadscrew_seed::amount(50_000, 60_000);
        let mut admitted = 0;
        for _ in 0..count {
            let case = Case::new(&mut random);
            let (from, mut to) = (case.place(&mut random), case.place(&mut random));
            match random.within(0, 3) {
                0 => to.x = from.x,
                1 => to.z = from.z,
                _ => {}
            }
            let kind = random.of(&[MoveKind::Rapid, MoveKind::Feed(FEED)]);
            admitted += u64::from(case.judge(from, &one(to, kind), "line"));
        }
        both_ways(admitted, count);
    });
}

#[test]
fn arcs() {
    leadscrew_seed::volume(43, |seed| {
        let mut random = Random(seed);
        let count = leadscrew_seed::amount(8_000, 30_000);
        let mut admitted = 0;
        for _ in 0..count {
            let case = Case::new(&mut random);
            let from = case.place(&mut random);
            let radius = 10_f64.powf(random.within(3_000, 8_000) as f64 / 1_000.0);
            // At the quarters, too.
            let mut angle = || match random.chance(30) {
                true => random.within(0, 3) as f64 * std::f64::consts::FRAC_PI_2,
                false => {
                    random.within(0, 1 << 40) as f64 / (1_i64 << 40) as f64 * std::f64::consts::TAU
                }
            };
            let (begin, end) = (angle(), angle());
            let ray = |angle: f64| {
                let (sin, cos) = angle.sin_cos();
                [sin, cos].map(|part| Length::from_nm((radius * part).round() as i64))
            };
            let ([i, k], [x, z]) = (ray(begin), ray(end));
            let to = Position {
                x: from.x - i + x,
                z: from.z - k + z,
                ..from
            };
            let kind = MoveKind::Arc {
                i: -i,
                k: -k,
                clockwise: random.chance(50),
                feed: FEED,
            };
            admitted += u64::from(case.judge(from, &one(to, kind), "arc"));
        }
        both_ways(admitted, count);
    });
}

/// The moves of a line of text behind `G0` to where it begins.
fn moves(text: &str, params: &Params) -> Option<(Position, Moves)> {
    let mut at = Position::ZERO;
    let mut last = None;
    for event in Events::new(text.as_bytes(), params, Options::default()) {
        let program::Event::Call(call) = event.ok()? else {
            continue;
        };
        let made = cycle::expand(&call, &Context::standing(at)).ok()?;
        if !matches!(call.kind, CallKind::End(_) | CallKind::Over) {
            last = Some((at, made));
        }
        at = made.last().map_or(at, |next| next.to);
    }
    last
}

/// In micrometres.
fn mm(length: i64) -> String {
    format!(
        "{}{}.{:03}",
        if length < 0 { "-" } else { "" },
        length.abs() / 1000,
        length.abs() % 1000
    )
}

/// Threads with what a hold draws back to, grooves without making their moves, taps: the judge takes every move.
#[test]
fn cycles() {
    leadscrew_seed::volume(47, |seed| {
        let mut random = Random(seed);
        let count = leadscrew_seed::amount(150, 200);
        let (mut tried, mut admitted) = (0, 0);
        for _ in 0..count {
            let case = Case::new(&mut random);
            let (x, z) = (
                random.within(2_000, 200_000),
                random.within(-60_000, 100_000),
            );
            let (down, along) = (
                random.within(500, 60_000).min(x - 1_000),
                random.within(-60_000, 60_000),
            );
            let start = format!("G98\nM3 S300\nG0 X{} Z{}\n", mm(x), mm(z));
            let (bottom, end) = (mm(x - down), mm(z + along));
            let text = match random.within(0, 4) {
                0 => format!(
                    "G76 P010000 Q500 R0.1\nG76 X{bottom} Z{end} P{} Q400 F1",
                    (down / 3).max(500)
                ),
                1 => format!(
                    "G75 R0.3\nG75 X{bottom} Z{end} P{} Q{} R{} F100",
                    random.within(500, 9_000),
                    random.within(200, 40_000),
                    mm(random.within(0, 3_000))
                ),
                2 => format!(
                    "G74 R0.3\nG74 X{bottom} Z{end} P{} Q{} R{} F100",
                    random.within(200, 40_000),
                    random.within(500, 9_000),
                    mm(random.within(0, 3_000))
                ),
                3 => format!("G92 X{bottom} Z{end} F1.5"),
                _ => format!("G32 X{bottom} Z{end} F1.5"),
            };
            let Some((from, moves)) = moves(&format!("{start}{text}\nM30\n"), &case.params) else {
                continue;
            };
            // Strokes and run-outs count as more than their line: other tests.
            let bends = |next: &Move| {
                next.tag.is_some_and(|tag| {
                    matches!(tag.stage, Stage::RunIn | Stage::RunOut) || tag.cycle == Cycle::G32
                })
            };
            if moves.into_iter().any(|next| bends(&next)) {
                continue;
            }
            tried += 1;
            admitted += u64::from(case.judge(from, &moves, &text));
        }
        assert!(tried > count / 3, "{tried}");
        both_ways(admitted, tried);
    });
}

/// Its last quarter is followed by none: the arc that goes on behind it would meet the jaws.
#[test]
fn an_arc_that_begins_where_two_quarters_meet() {
    let params = with(&[("9033", 0), ("9094", 10_000_000), ("9095", 20_000_000)]);
    let at = |x: i64, z: i64| Position {
        x: Length::from_nm(x * 1_000_000),
        z: Length::from_nm(z * 1_000_000),
        c: Angle::ZERO,
    };
    // Around X 12 Z 5 with a radius of 4: towards the axis of the spindle it meets the jaws, whose radius is 10.
    let go = |from: Position, to: Position, clockwise| {
        let kind = MoveKind::Arc {
            i: Length::from_nm(12_000_000) - from.x,
            k: Length::from_nm(5_000_000) - from.z,
            clockwise,
            feed: FEED,
        };
        let forbidden = Forbidden::of(&params, 1, Some([Length::ZERO; 2]));
        cycle::clear_of_zones(&one(to, kind), from, &forbidden).is_ok()
    };
    let (right, out, left) = (at(12, 9), at(16, 5), at(12, 1));
    assert!(go(right, out, false) && go(right, left, false) && go(left, out, true));
    assert!(!go(right, out, true) && !go(right, left, true) && !go(out, right, false));
    assert!(!go(right, right, false) && !go(right, right, true));
}
