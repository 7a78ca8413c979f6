//! Strokes whose lead changes, tick by tick: the helix against its definition in floats, and the limits of the axes.

#![allow(
    clippy::float_arithmetic,
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing
)]

extern crate std;

use std::vec::Vec;

use super::*;
use crate::alarm::{Alarm, Code, Span};
use crate::call::{ChainPart, Position};
use crate::moves::{Move, MoveKind, ThreadMove};
use crate::params::Params;
use crate::units::{Angle, Axis, Lead, LeadChange, Length, Rpm, StartAngle, TurnRate, Turns};

fn point(x: f64, z: f64) -> Position {
    let nm = |mm: f64| Length::from_nm((mm * 1e6).round() as i64);
    Position {
        x: nm(x),
        z: nm(z),
        c: Angle::ZERO,
    }
}

/// A stroke from X10 (radius) Z0, lengths in millimetres.
struct Stroke {
    lead: f64,
    change: f64,
    to: (f64, f64),
    rpm: i32,
}

impl Stroke {
    fn long_x(&self) -> bool {
        (self.to.0 - 10.0).abs() > self.to.1.abs()
    }

    fn plan(&self, params: &Params) -> Result<ThreadPlan, Alarm> {
        let start = point(10.0, 0.0);
        let stroke = Move {
            span: Span::default(),
            to: point(self.to.0, self.to.1),
            kind: MoveKind::Thread(ThreadMove {
                lead: Lead::new((self.lead * 1e6).round() as i64, 1).unwrap(),
                change: LeadChange::from_pm((self.change * 1e9).round() as i64),
                pass_angle: StartAngle::from_mdeg(90_000),
                angle_udeg: 90_000_000,
                long_x: self.long_x(),
                part: ChainPart::Whole,
                last: true,
                rpm: Rpm::new(self.rpm),
            }),
            tag: None,
        };
        ThreadPlan::new(start, &[stroke], params, TurnRate::ZERO)
    }
}

/// The setpoints of a stroke on a spindle that turns by `rate(tick)` (2⁻³² turns), each with the spindle's angle.
fn setpoints(plan: &ThreadPlan, rate: impl Fn(i64) -> i64) -> Vec<(Turns, ThreadPoint)> {
    let mut angle = Turns::ZERO;
    let speed = TurnRate::from_raw(if plan.is_reverse() { -1000 } else { 1000 });
    let mut run = ThreadRun::start(plan, angle, speed).unwrap();
    let mut points = Vec::new();
    for tick in 0.. {
        let step = if plan.is_reverse() {
            -rate(tick)
        } else {
            rate(tick)
        };
        angle += Turns::from_raw(step);
        let point = run.tick(plan, angle);
        points.push((angle, point));
        if point.phase == Phase::Done {
            break;
        }
    }
    points
}

/// 2⁻³² turns a tick of a millisecond.
fn per_tick(rpm: f64) -> i64 {
    (rpm / 60_000.0 * 2f64.powi(32)) as i64
}

const STROKES: [Stroke; 6] = [
    Stroke {
        lead: 2.0,
        change: 0.1,
        to: (10.0, -22.0),
        rpm: 300,
    },
    Stroke {
        lead: 6.0,
        change: -0.2,
        to: (10.0, 60.0),
        rpm: -200,
    },
    // A taper, and a face.
    Stroke {
        lead: 3.0,
        change: 0.05,
        to: (15.0, -40.0),
        rpm: 500,
    },
    Stroke {
        lead: 1.0,
        change: 0.02,
        to: (40.0, 3.0),
        rpm: 400,
    },
    // From a fine lead to a coarse one.
    Stroke {
        lead: 0.5,
        change: 0.5,
        to: (10.0, -50.0),
        rpm: 100,
    },
    Stroke {
        lead: 8.0,
        change: -1.0,
        to: (10.0, -31.0),
        rpm: 100,
    },
];

#[test]
fn the_locked_part_is_the_law_to_the_nanometre_at_any_speed() {
    let params = Params::default();
    for stroke in &STROKES {
        let plan = stroke.plan(&params).unwrap();
        let rpm = f64::from(stroke.rpm.abs());
        let (steady, slow) = (per_tick(rpm), per_tick(rpm / 3.0));
        // Steady, a third as fast, and rippling by 10 %.
        let ripple = |tick: i64| {
            let share = (tick as f64 / 40.0).sin() * 0.1 + 1.0;
            (steady as f64 * share) as i64
        };
        let mut locked = 0;
        for points in [
            setpoints(&plan, |_| steady),
            setpoints(&plan, |_| slow),
            setpoints(&plan, ripple),
        ] {
            // The axis leaves rest the lead-in before the start, within a tick.
            let first = points
                .iter()
                .position(|(_, point)| point.phase != Phase::Waiting)
                .unwrap();
            let turned = points[first].0.raw().unsigned_abs() as f64 / 2f64.powi(32);
            let lead_in = plan.lead_in().nm() as f64 / 1e6 / stroke.lead;
            let base = (turned + lead_in - 0.25).floor() + 0.25;
            for (angle, point) in &points {
                if point.phase != Phase::Locked {
                    continue;
                }
                locked += 1;
                let t = angle.raw().unsigned_abs() as f64 / 2f64.powi(32) - base;
                let way = if t < 0.0 {
                    stroke.lead * t
                } else {
                    (stroke.lead + stroke.change * t / 2.0) * t
                };
                let (x, z) = (point.position.x.nm() as f64, point.position.z.nm() as f64);
                let is = if stroke.long_x() {
                    (x - 10e6).abs()
                } else {
                    z.abs()
                };
                assert!(
                    (is - way * 1e6).abs() <= 0.51,
                    "F{} K{}: {is} instead of {}",
                    stroke.lead,
                    stroke.change,
                    way * 1e6
                );
                // The short axis stays on its line.
                let line = if stroke.long_x() {
                    (z - is * 3.0 / 30.0).abs()
                } else {
                    (x - 10e6 - is * (stroke.to.0 - 10.0) / stroke.to.1.abs()).abs()
                };
                assert!(line <= 1.0, "{line}");
            }
            let end = points.last().unwrap().1.position;
            assert_eq!(end, point(stroke.to.0, stroke.to.1));
        }
        assert!(locked > 1000, "{locked}");
    }
}

#[test]
fn no_axis_leaves_its_limits_and_none_goes_back() {
    let params = Params::default();
    for stroke in &STROKES {
        let plan = stroke.plan(&params).unwrap();
        // As fast as the plan allows.
        let fastest = plan.speed_limit().raw() / 1000;
        let points = setpoints(&plan, |_| fastest);
        for axis in [Axis::X, Axis::Z] {
            let at = |n: usize| {
                let position = points[n.min(points.len() - 1)].1.position;
                let nm = if axis == Axis::X {
                    position.x
                } else {
                    position.z
                };
                nm.nm()
            };
            let speed = params.rapid(axis).nm_per_min() / 60_000;
            let acceleration = params.acceleration(axis).nm_per_s2() / 1_000_000;
            let jerk = params.jerk(axis).nm_per_s3() / 1_000_000_000;
            let target = if axis == Axis::X {
                stroke.to.0 - 10.0
            } else {
                stroke.to.1
            };
            let sign = if target < 0.0 { -1 } else { 1 };
            for n in 0..points.len() {
                let steps = [at(n), at(n + 1), at(n + 2), at(n + 3)];
                let first = (steps[1] - steps[0]) * sign;
                let second = steps[2] - 2 * steps[1] + steps[0];
                let third = steps[3] - 3 * steps[2] + 3 * steps[1] - steps[0];
                let told = std::format!("F{} K{} {axis:?} {n}", stroke.lead, stroke.change);
                assert!((0..=speed + 1).contains(&first), "{told}: {first}");
                assert!(second.abs() <= acceleration + 2, "{told}: {second}");
                assert!(third.abs() <= jerk + 4, "{told}: {third} {jerk}");
            }
        }
    }
}

#[test]
fn a_stop_from_the_changing_lead_keeps_the_limits() {
    let params = Params::default();
    for stroke in &STROKES {
        let plan = stroke.plan(&params).unwrap();
        let rate = per_tick(f64::from(stroke.rpm.abs()));
        let rate = if plan.is_reverse() { -rate } else { rate };
        let long = if stroke.long_x() { Axis::X } else { Axis::Z };
        let acceleration = params.acceleration(long).nm_per_s2() / 1_000_000;
        let ticks = setpoints(&plan, |_| rate.abs()).len();
        for share in [3, 5, 7, 9] {
            let mut angle = Turns::ZERO;
            let speed = TurnRate::from_raw(rate);
            let mut run = ThreadRun::start(&plan, angle, speed).unwrap();
            let mut ways = Vec::new();
            for tick in 0..ticks + 2000 {
                if tick == ticks * share / 10 {
                    run.stop(&plan);
                }
                angle += Turns::from_raw(rate);
                let at = run.tick(&plan, angle).position;
                ways.push(if stroke.long_x() {
                    at.x.nm()
                } else {
                    at.z.nm()
                });
            }
            assert_eq!(run.phase(), Phase::Done);
            for step in ways.windows(3) {
                let second = step[2] - 2 * step[1] + step[0];
                assert!(second.abs() <= acceleration + 2, "{second}");
            }
        }
    }
}

#[test]
fn speed_and_change_are_checked_at_the_fastest_point() {
    let params = Params::default();
    let code = |lead, change, length: f64, rpm| {
        let stroke = Stroke {
            lead,
            change,
            to: (10.0, -length),
            rpm,
        };
        stroke.plan(&params).map(|_| ()).map_err(|alarm| alarm.code)
    };
    // Z may do 8 m/min in a feed: at 1000 rpm a lead of 8 mm. With K1 a lead of 4 mm is there after 24 mm.
    assert_eq!(code(4.0, 0.0, 24.5, 1000), Ok(()));
    assert_eq!(code(4.0, 1.0, 24.5, 1000), Err(Code::LeadTooFast));
    assert_eq!(code(8.1, -0.1, 24.5, 1000), Err(Code::LeadTooFast));
    // K 0.4 at 1000 rpm is 0.134 m/s², more than the jerk lets it step by.
    assert_eq!(code(1.0, 0.4, 20.0, 1000), Err(Code::LeadChangeTooFast));
    assert_eq!(code(1.0, 0.4, 20.0, 500), Ok(()));
}

/// The spindle runs down in a pass whose drives differ by 20 ms or not at all, and a stop comes when it hardly turns, or
/// turns back: the axes come to rest together. The short one leapt by what it was ahead, and where the spindle turned
/// back, both stood from one tick to the next.
#[test]
fn a_stop_of_a_spindle_that_hardly_turns_lets_no_axis_leap() {
    const APART: usize = 20;
    const DOWN: usize = 250;
    leadscrew_seed::volume(529, |seed| {
        let mut random = leadscrew_seed::Random(seed);
        let mut below = |bound| random.index(bound);
        let mut params = Params::default();
        params
            .set(crate::params::Entry::find_text("9003.X").unwrap(), 20_000)
            .unwrap();
        let stroke = Stroke {
            lead: 2.0,
            change: 0.0,
            to: (30.0, -60.0),
            rpm: 1500,
        };
        let plan = stroke.plan(&params).unwrap();
        let steady = per_tick(1500.0);
        for _ in 0..leadscrew_seed::amount(200, 2000) {
            let (down, leaves, is_behind) = (below(1400), below(2) == 0, below(2) == 0);
            let retract = down.saturating_sub(below(100));
            let (turns_back, is_apart) = (below(2) == 0, below(2) == 0);
            // Down to a seventieth in 0.2 s, or beyond.
            let least = if turns_back { steady / -5 } else { steady / 70 };
            let rate = |tick: usize| {
                let left = 200 - tick.saturating_sub(down) as i64;
                (steady * left / 200).max(least)
            };
            let mut angles = std::vec![0];
            for tick in 0..20_000 {
                angles.push(angles[tick] + rate(tick));
            }
            let angle = |tick: usize| Turns::from_raw(angles[tick]);
            let ahead = angle(APART);
            let mut run = ThreadRun::start(&plan, ahead, TurnRate::from_raw(1000)).unwrap();
            let mut places = std::vec![[10_000_000, 0]; 2];
            let mut stopped = None;
            for tick in 0.. {
                if leaves && tick == retract {
                    run.retract(&plan, Length::from_nm(50_000_000));
                }
                if tick == down + DOWN {
                    run.stop(&plan);
                    stopped = Some(tick);
                }
                let (one, other) = (angle(tick), angle(tick + APART));
                let at = match (is_apart, is_behind) {
                    (true, true) => run.tick_apart(&plan, other, one),
                    (true, false) => run.tick_apart(&plan, one, other),
                    (false, _) => run.tick(&plan, one),
                };
                places.push([at.position.x.nm(), at.position.z.nm()]);
                if at.phase == Phase::Done && stopped.is_some() {
                    break;
                }
                assert!(tick < 19_000, "no end: {down} {leaves} {retract}");
            }
            places.push(*places.last().unwrap());
            let stopped = stopped.unwrap();
            for (n, axis) in [Axis::X, Axis::Z].into_iter().enumerate() {
                let most = params.acceleration(axis).nm_per_s2() as f64 * 1e-6;
                for three in places[stopped..].windows(3) {
                    let size = (three[2][n] - 2 * three[1][n] + three[0][n]).abs();
                    assert!(
                        size as f64 <= most + 2.0,
                        "{axis:?} {size} nm, limit {most}: down from {down}, out {leaves} at {retract}, {is_behind} {turns_back} {is_apart}"
                    );
                }
            }
        }
    });
}

/// A pass that waits may be left as if nothing had been, so no axis may have left then.
#[test]
fn no_axis_has_left_while_a_pass_waits() {
    let stroke = Stroke {
        lead: 2.0,
        change: 0.0,
        to: (30.0, -60.0),
        rpm: 1500,
    };
    let plan = stroke.plan(&Params::default()).unwrap();
    let angle = |tick: i64| Turns::from_raw(per_tick(1500.0) * tick);
    for apart in [-20, 20] {
        let mut run =
            ThreadRun::start(&plan, angle(apart.max(0)), TurnRate::from_raw(1000)).unwrap();
        let mut begun = 0;
        for tick in 1..200 {
            let point = run.tick_apart(&plan, angle(tick), angle(tick + apart));
            let stands = point.position == plan.start();
            assert!(stands || run.phase() != Phase::Waiting, "{apart} {tick}");
            assert_eq!(run.phase(), point.phase);
            begun += i32::from(!stands);
        }
        assert!(begun > 50, "{begun}");
    }
}
