//! Chains tick by tick: the polygon of their strokes against floats, the limits of the axes, and stops anywhere.

#![allow(
    clippy::float_arithmetic,
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used
)]

extern crate std;

use std::format;
use std::string::String;
use std::vec::Vec;

use super::*;
use crate::motion::thread::{Phase, ThreadRun};
use crate::moves::{Cycle, Stage, Tag};
use crate::params::{Entry, Writing};
use crate::units::{Angle, LeadChange, StartAngle};

/// X (radius) and Z in nanometres.
type Point = (i64, i64);

/// Strokes to points, each with a lead in nanometres; at the end perhaps a run-out.
#[derive(Clone, Debug)]
struct Case {
    from: Point,
    strokes: Vec<(Point, i64)>,
    run_out: Option<Point>,
    rpm: i32,
    params: Vec<(&'static str, String)>,
}

fn position((x, z): Point) -> Position {
    Position {
        x: Length::from_nm(x),
        z: Length::from_nm(z),
        c: Angle::ZERO,
    }
}

impl Case {
    fn params(&self) -> Params {
        let mut params = Params::default();
        for (number, value) in &self.params {
            let entry = Entry::find_text(number).unwrap();
            let raw = entry.parse(value, Writing::UnitOptional).unwrap();
            params.set(entry, raw).unwrap();
        }
        params
    }

    fn chain(&self) -> Result<Chain, Alarm> {
        let mut chain = Chain::new();
        let mut from = self.from;
        let count = self.strokes.len();
        for (index, (to, lead)) in self.strokes.iter().enumerate() {
            let (x, z) = (to.0 - from.0, to.1 - from.1);
            let thread = ThreadMove {
                lead: Lead::new(*lead, 1).unwrap(),
                change: LeadChange::NONE,
                pass_angle: StartAngle::from_mdeg(90_000),
                angle_udeg: 90_000_000,
                long_x: x.abs() > z.abs(),
                part: match index {
                    0 => ChainPart::First,
                    _ if index + 1 == count => ChainPart::Last,
                    _ => ChainPart::Middle,
                },
                last: index + 1 == count && self.run_out.is_none(),
                rpm: Rpm::new(self.rpm),
            };
            let span = Span {
                line: index as u32 + 1,
                ..Span::default()
            };
            let stroke = Move {
                span,
                to: position(*to),
                kind: MoveKind::Thread(thread),
                tag: None,
            };
            chain.push(position(from), &stroke, index as u32 + 1)?;
            if let Some(end) = self.run_out
                && index + 1 == count
            {
                let tag = Tag {
                    cycle: Cycle::G32,
                    pass: 1,
                    start: 1,
                    peck: 0,
                    stage: Stage::RunOut,
                    depth: Length::ZERO,
                };
                let out = Move {
                    to: position(end),
                    kind: MoveKind::Thread(ThreadMove {
                        last: true,
                        ..thread
                    }),
                    tag: Some(tag),
                    ..stroke
                };
                chain.push(position(*to), &out, index as u32 + 1)?;
            }
            from = *to;
        }
        Ok(chain)
    }

    fn plans(&self) -> Result<Vec<ThreadPlan>, Alarm> {
        let (params, mut chain) = (self.params(), self.chain()?);
        assert!(chain.is_whole());
        for index in 0..chain.len() {
            chain.examine(index, &params, None, TurnRate::ZERO)?;
        }
        (0..chain.len())
            .map(|index| chain.plan(index, &params, None, TurnRate::ZERO))
            .collect()
    }

    /// Turns of the strokes.
    fn turns(&self) -> f64 {
        let mut from = self.from;
        let mut all = 0.0;
        for (to, lead) in &self.strokes {
            let long = (to.0 - from.0).abs().max((to.1 - from.1).abs());
            all += long as f64 / *lead as f64;
            from = *to;
        }
        all
    }

    /// Where the polygon is after `turns` from its start, run-out aside; before and behind its ends on their extension.
    fn polygon(&self, turns: f64) -> (f64, f64) {
        let (mut from, mut left) = (self.from, turns);
        for (index, (to, lead)) in self.strokes.iter().enumerate() {
            let (x, z) = ((to.0 - from.0) as f64, (to.1 - from.1) as f64);
            let all = x.abs().max(z.abs()) / *lead as f64;
            if left <= all || index + 1 == self.strokes.len() {
                let share = left / all;
                return (from.0 as f64 + x * share, from.1 as f64 + z * share);
            }
            left -= all;
            from = *to;
        }
        unreachable!()
    }
}

/// Where the axes are in each tick, with the spindle's angle, and whether the plan says that they are on the lead.
struct Track {
    points: Vec<(Turns, Point, Phase)>,
    /// The turn at which the chain begins.
    base: Turns,
    /// Ticks in which another stroke took over.
    crossed: Vec<usize>,
}

/// Runs the plans on a spindle that turns by `rate(tick)`; at `stop` the angle is not followed any more.
fn run(
    plans: &[ThreadPlan],
    rate: impl Fn(usize) -> i64,
    stop: Option<usize>,
    apart: i64,
) -> Track {
    let first = &plans[0];
    let sign = if first.is_reverse() { -1 } else { 1 };
    let mut angle = Turns::ZERO;
    // The axis that is ahead must be in time as well.
    let ahead = Turns::from_raw(apart.max(0) * sign);
    let mut run = ThreadRun::start(first, ahead, TurnRate::from_raw(1000 * sign)).unwrap();
    let base = run.helix(first).base;
    let start = (first.start().x.nm(), first.start().z.nm());
    // Where it stands before the first tick, in which it may leave.
    let mut points = std::vec![(first.turned(angle), start, Phase::Waiting)];
    let (mut crossed, mut index) = (Vec::new(), 0);
    for tick in 0.. {
        angle += Turns::from_raw(rate(tick) * sign);
        if stop == Some(tick) {
            run.stop(&plans[index]);
        }
        // X is `apart` ahead of Z.
        let of_x = angle + Turns::from_raw(apart * sign);
        let (long, short) = if plans[index].long_x() {
            (of_x, angle)
        } else {
            (angle, of_x)
        };
        let point = if apart == 0 {
            run.tick(&plans[index], angle)
        } else {
            run.tick_apart(&plans[index], long, short)
        };
        let at = (point.position.x.nm(), point.position.z.nm());
        points.push((first.turned(angle), at, point.phase));
        let ahead = if apart > 0 { of_x } else { angle };
        if run.is_over(&plans[index], ahead) {
            run.leave(&plans[index]);
            index += 1;
            run.take_over(&plans[index]);
            crossed.push(tick);
        }
        if point.phase == Phase::Done {
            break;
        }
        assert!(tick < 3_000_000, "no end");
    }
    Track {
        points,
        base,
        crossed,
    }
}

/// The largest speed, acceleration and jerk of each axis in shares of its limits.
fn shares(track: &Track, params: &Params) -> [[f64; 3]; 2] {
    let tick = f64::from(params.tick_us()) * 1e-6;
    let mut most = [[0.0_f64; 3]; 2];
    for (axis, figures) in [Axis::X, Axis::Z].into_iter().zip(&mut most) {
        let at = |n: usize| {
            // It stood before, and stands after that.
            let n = n.saturating_sub(4).min(track.points.len() - 1);
            let (x, z) = track.points[n].1;
            (if axis == Axis::X { x } else { z }) as f64
        };
        let limits = [
            params.max_feed(axis).nm_per_min() as f64 / 60.0,
            params.acceleration(axis).nm_per_s2() as f64,
            params.jerk(axis).nm_per_s3() as f64,
        ];
        for n in 3..track.points.len() + 8 {
            let v = at(n) - at(n - 1);
            let a = v - (at(n - 1) - at(n - 2));
            let j = a - (at(n - 1) - 2.0 * at(n - 2) + at(n - 3));
            // A setpoint is rounded to a nanometre.
            let differences = [(v, 1.0), (a, 2.0), (j, 4.0)];
            for (k, (difference, rounding)) in differences.into_iter().enumerate() {
                let size = (difference.abs() - rounding).max(0.0) / tick.powi(k as i32 + 1);
                figures[k] = figures[k].max(size / limits[k]);
            }
        }
    }
    most
}

fn per_tick(rpm: f64, params: &Params) -> i64 {
    (rpm / 60.0 * f64::from(params.tick_us()) * 1e-6 * 2f64.powi(32)) as i64
}

/// A straight thread, a taper, a steep taper with another lead, and a face: outwards.
fn four() -> Case {
    Case {
        from: (10_000_000, 5_000_000),
        strokes: std::vec![
            ((10_000_000, -20_000_000), 2_000_000),
            ((12_000_000, -50_000_000), 2_000_000),
            ((15_000_000, -56_000_000), 3_000_000),
            ((30_000_000, -56_000_000), 3_000_000),
        ],
        run_out: None,
        rpm: 600,
        params: Vec::new(),
    }
}

#[test]
fn between_its_corners_a_chain_is_the_polygon_of_its_strokes() {
    let case = four();
    let (params, plans) = (case.params(), case.plans().unwrap());
    let steady = per_tick(600.0, &params);
    let ripple = |tick: usize| {
        let share = (tick as f64 / 40.0).sin() * 0.08 + 1.0;
        (steady as f64 * share) as i64
    };
    for apart in [0, steady * 3, -steady * 2] {
        let track = run(&plans, ripple, None, apart);
        assert_eq!(track.crossed.len(), 3);
        let mut on_line = 0;
        for (angle, at, phase) in &track.points {
            // Each coordinate belongs to its own angle, if the axes are apart.
            let turned = |extra: i64| {
                let raw = (*angle - track.base).raw() + extra;
                case.polygon(raw as f64 / 2f64.powi(32))
            };
            if apart == 0 && *phase == Phase::Locked {
                let (x, z) = turned(0);
                let off = (at.0 as f64 - x).hypot(at.1 as f64 - z);
                assert!(off < 1.5, "{off} at {at:?}");
                on_line += 1;
            }
        }
        assert!(apart != 0 || on_line > 2000, "{on_line}");
        let last = track.points.last().unwrap().1;
        assert_eq!(last, (30_000_000, -56_000_000));
        for figures in shares(&track, &params) {
            assert!(
                figures.iter().all(|share| *share < 1.0),
                "{apart}: {figures:?}"
            );
        }
    }
}

#[test]
fn a_corner_stays_near_its_point() {
    // The last one goes from Z to X at full lead: each axis changes by 30 mm/s.
    let case = four();
    let (params, plans) = (case.params(), case.plans().unwrap());
    let track = run(&plans, |_| per_tick(600.0, &params), None, 0);
    let near = |corner: Point| {
        let off = |at: Point| ((at.0 - corner.0) as f64).hypot((at.1 - corner.1) as f64);
        track
            .points
            .iter()
            .map(|(_, at, _)| off(*at))
            .fold(f64::MAX, f64::min)
    };
    for ((corner, _), most) in case.strokes.iter().zip([40_000.0, 500_000.0, 1_000_000.0]) {
        let nearest = near(*corner);
        assert!(nearest < most, "{corner:?}: {nearest}");
    }
}

/// What a follower may be beside the spindle is an error along the lead, however steep a run-out is: with the speed of a
/// run-out of 45° it was half of what was promised, and a pass at a steady spindle ended with 4276.
#[test]
fn a_run_out_takes_nothing_of_the_error_along_the_lead() {
    let with = |run_out| Case {
        strokes: std::vec![
            ((15_975_000, -5_000_000), 1_436_000),
            ((15_975_000, -9_000_000), 3_329_000)
        ],
        from: (15_975_000, 9_000_000),
        run_out,
        rpm: 300,
        params: std::vec![("3720", "35".into())],
    };
    let beside = |case: &Case| {
        let params = case.params();
        let mut chain = case.chain().unwrap();
        for index in 0..2 {
            chain.examine(index, &params, None, TurnRate::ZERO).unwrap();
        }
        let error = params.encoder_error().nm() as f64;
        let plan = chain.plan(0, &params, None, TurnRate::ZERO).unwrap();
        plan.follower().beside as f64 / 2_f64.powi(48) * 3_329_000.0 / error
    };
    for run_out in [
        None,
        Some((16_535_000, -9_560_000)),
        Some((18_000_000, -9_560_000)),
    ] {
        let part = beside(&with(run_out));
        assert!(
            (part - 1.0).abs() < 1e-3,
            "{run_out:?}: {part} of what 9035 allows"
        );
    }
}

#[test]
fn what_a_chain_cannot_be_is_refused_at_its_stroke() {
    let mut case = four();
    case.strokes[1] = ((10_500_000, -21_000_000), 2_000_000);
    case.rpm = 2000;
    let alarm = case.plans().unwrap_err();
    assert_eq!(
        (alarm.code, alarm.span.line),
        (Code::StrokeTooShortInChain, 2)
    );
    let mut long = four();
    long.strokes = (1..=65)
        .map(|n| ((10_000_000, -n * 5_000_000), 2_000_000))
        .collect();
    assert_eq!(long.chain().unwrap_err().code, Code::ChainTooLong);
    long.strokes.pop();
    assert_eq!(long.plans().unwrap().len(), 64);
}

struct Draw(u64);

impl Draw {
    fn within(&mut self, low: i64, high: i64) -> i64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (self.0 % (high - low + 1) as u64) as i64
    }

    fn chance(&mut self, percent: i64) -> bool {
        self.within(1, 100) <= percent
    }

    fn case(&mut self) -> Case {
        let count = self.within(2, 9);
        let mut at = (
            self.within(2_000_000, 60_000_000),
            self.within(-50_000_000, 50_000_000),
        );
        let from = at;
        let mut lead = self.within(50, 6000) * 1000;
        let towards = if self.chance(80) { -1 } else { 1 };
        let mut strokes = Vec::new();
        for _ in 0..count {
            let size = [2_000_000, 20_000_000, 100_000_000][self.within(0, 2) as usize];
            let (long, mut short) = (self.within(size / 4, size), 0);
            if self.chance(60) {
                let steep = [20, 4, 1][self.within(0, 2) as usize];
                short = self.within(-long / steep, long / steep);
            }
            let long = if self.chance(4) { -long } else { long };
            at = if self.chance(80) {
                (at.0 + short, at.1 + long * towards)
            } else {
                (at.0 + long, at.1 + short)
            };
            if self.chance(25) {
                lead = self.within(50, 6000) * 1000;
            }
            strokes.push((at, lead));
        }
        let run_out = self.chance(40).then(|| {
            let (before, (end, _)) = (
                strokes.iter().rev().nth(1).map_or(from, |one| one.0),
                *strokes.last().unwrap(),
            );
            let (x, z) = (end.0 - before.0, end.1 - before.1);
            let k = self.within(200_000, 3_000_000);
            let j = self.within(200_000, 3_000_000) * if self.chance(50) { 1 } else { -1 };
            // On along the line, and J beside it.
            if x.abs() > z.abs() {
                (end.0 + k * x.signum(), end.1 + z * k / x.abs() + j)
            } else {
                (end.0 + x * k / z.abs() + j, end.1 + k * z.signum())
            }
        });
        let figures = |draw: &mut Self, low: i64, high: i64| {
            format!("{}", draw.within(low, high) as f64 / 10.0)
        };
        let params = std::vec![
            ("1620.X", figures(self, 3, 40)),
            ("1620.Z", figures(self, 3, 40)),
            ("1622.X", figures(self, 50, 2000)),
            ("1622.Z", figures(self, 50, 2000)),
        ];
        let rpm = self.within(20, 2500) as i32 * if self.chance(20) { -1 } else { 1 };
        Case {
            from,
            strokes,
            run_out,
            rpm,
            params,
        }
    }
}

#[test]
fn by_chance_no_chain_and_no_stop_exceeds_a_limit() {
    leadscrew_seed::volume(0x51c0_77ab, |seed| {
        let mut draw = Draw(seed | 1);
        let (mut cut, mut refused, mut crossed, mut worst) = (0, 0, 0, [0.0_f64; 2]);
        for _ in 0..leadscrew_seed::amount(500, 5000) {
            let case = draw.case();
            let Ok(plans) = case.plans() else {
                refused += 1;
                continue;
            };
            let params = case.params();
            // Up to the speed for which it is planned. A run-out may have no margin above S.
            let most = match case.run_out {
                Some(_) => per_tick(f64::from(case.rpm.abs()), &params) as f64,
                None => plans[0].speed_limit().raw() as f64 * f64::from(params.tick_us()) * 1e-6,
            };
            let share = draw.within(50, 100) as f64 / 100.0;
            // A fine thread on a slow spindle would take hours.
            if case.turns() * 2f64.powi(32) / (most * share) > 100_000.0 {
                continue;
            }
            let rate = |_| (most * share) as i64;
            let whole = run(&plans, rate, None, 0);
            let end = case.run_out.unwrap_or(case.strokes.last().unwrap().0);
            let last = plans.last().unwrap();
            if last.run_out_lag() == Length::ZERO {
                assert_eq!(whole.points.last().unwrap().1, end, "{case:?}");
            }
            for (angle, at, phase) in &whole.points {
                let turns = (*angle - whole.base).raw() as f64 / 2f64.powi(32);
                let (x, z) = case.polygon(turns);
                let beside = (at.0 as f64 - x).abs() + (at.1 as f64 - z).abs();
                let in_run_out = case.run_out.is_some() && at_last(&case, turns);
                assert!(
                    *phase != Phase::Locked || in_run_out || beside < 2.5,
                    "{beside} nm beside: {case:?}"
                );
            }
            let mut look = |track: &Track, what: &str, most: f64| {
                for figures in shares(track, &params) {
                    worst[0] = worst[0].max(figures[1]);
                    worst[1] = worst[1].max(figures[2]);
                    assert!(
                        figures[1] < 1.002 && figures[2] < most,
                        "{what}: {figures:?} {case:?} at {share}"
                    );
                }
            };
            look(&whole, "whole", 1.01);
            let last = whole.points.len() as i64 - 1;
            // A stop is planned for the steepest part of the chain, which may be a run-out at its end.
            let stop = ((1_u64 << 31) / u64::from(plans[0].link.stop)) as usize;
            let mut ticks: Vec<usize> = (0..3).map(|_| draw.within(0, last) as usize).collect();
            // In the tick of a take-over, and in the first of the next plan.
            ticks.extend(whole.crossed.iter().flat_map(|tick| [*tick, tick + 1]));
            for tick in ticks {
                let track = run(&plans, rate, Some(tick), 0);
                let most = whole.points.len().max(tick + stop) + 4000;
                assert!(track.points.len() <= most, "{case:?}");
                look(
                    &track,
                    &format!("stop in tick {tick} of {}", whole.points.len()),
                    2.0,
                );
            }
            cut += 1;
            crossed += whole.crossed.len();
        }
        assert!(
            cut > 20 && refused > 5 && crossed > 50,
            "{cut} {refused} {crossed} {worst:?}"
        );
        std::println!(
            "{cut} chains, {refused} refused, {crossed} corners; at most {worst:?} of acceleration and jerk"
        );
    });
}

/// True in the last stroke.
fn at_last(case: &Case, turns: f64) -> bool {
    let mut from = case.from;
    let mut all = 0.0;
    for (to, lead) in &case.strokes[..case.strokes.len() - 1] {
        let (x, z) = ((to.0 - from.0) as f64, (to.1 - from.1) as f64);
        all += x.abs().max(z.abs()) / *lead as f64;
        from = *to;
    }
    turns >= all
}
