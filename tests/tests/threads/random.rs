//! Random passes: limits of both axes, exact ends, and a spindle that does what it likes.

use leadscrew_core::alarm::Code;
use leadscrew_core::call::Position;
use leadscrew_core::motion::{Phase, Retract, ThreadPlan, ThreadPoint, ThreadRun};
use leadscrew_core::moves::{Move, Stage};
use leadscrew_core::params::{Entry, Params, Part};
use leadscrew_core::units::{Axis, Lead, Length, Rpm, StartAngle, TurnRate, Turns};
use leadscrew_tests::watch::Watch;

use crate::{pass, position};

/// Passes tried.
fn passes() -> u32 {
    leadscrew_seed::amount(1_000, 3_000)
}

/// xorshift64*.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// low…high, both possible.
    fn whole(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() >> 1) as i64 % (high - low + 1)
    }

    /// Even in the logarithm.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf((self.next() >> 11) as f64 / 2f64.powi(53))
    }

    fn chance(&mut self, percent: i64) -> bool {
        self.whole(1, 100) <= percent
    }
}

fn set(params: &mut Params, no: u16, part: Option<Part>, raw: i64) {
    params.set(Entry::find(no, part).unwrap(), raw).unwrap();
}

/// A machine with other accelerations and another tick than the built-in one.
fn machine(random: &mut Random) -> Params {
    let mut params = Params::default();
    for axis in [Axis::X, Axis::Z] {
        let part = Some(Part::Axis(axis));
        set(&mut params, 1620, part, random.scale(0.3e9, 10e9) as i64);
        set(&mut params, 1622, part, random.scale(5e9, 400e9) as i64);
    }
    let tick = [250, 500, 1000, 1000, 1000, 2000, 4000][random.whole(0, 6) as usize];
    set(&mut params, 9000, None, tick);
    params
}

struct Case {
    params: Params,
    from: Position,
    moves: Vec<Move>,
    rpm: i32,
    long_x: bool,
}

/// A pass of random shape: either long axis, either direction, taper, run-in, run-out, lead and speed.
fn case(random: &mut Random) -> Case {
    let params = machine(random);
    let long_x = random.chance(20);
    let sign = if random.chance(50) { 1 } else { -1 };
    let side = if random.chance(50) { 1 } else { -1 };
    let length = random.scale(2e6, 40e6) as i64;
    let taper = if random.chance(40) {
        random.whole(-length / 2, length / 2)
    } else {
        0
    };
    let run_in = if random.chance(30) {
        random.whole(1, length / 3)
    } else {
        0
    };
    let run_out = if random.chance(70) {
        random.whole(1, length / 3)
    } else {
        0
    };
    let lead = random.scale(0.2e6, 20e6) as i64;
    let rpm = (random.scale(20.0, 3000.0) as i32)
        .min((8e9 / lead as f64) as i32)
        .max(1);
    let at = |long: i64, short: i64| {
        let (long, short) = (10_000_003 + sign * long, 20_000_001 + side * short);
        if long_x {
            position(long, short)
        } else {
            position(short, long)
        }
    };
    let on_line = |long: i64| (i128::from(taper) * i128::from(long) / i128::from(length)) as i64;
    let mut points = Vec::new();
    let mut from = at(0, 0);
    if run_in > 0 {
        from = at(0, on_line(run_in) + run_in);
        points.push((at(run_in, on_line(run_in)), Stage::RunIn));
    }
    points.push((
        at(length - run_out, on_line(length - run_out)),
        Stage::Rough,
    ));
    if run_out > 0 {
        let out = random.whole(1, 2 * run_out);
        points.push((at(length, on_line(length - run_out) + out), Stage::RunOut));
    }
    let rpm = if random.chance(50) { rpm } else { -rpm };
    Case {
        moves: pass(
            &points,
            Lead::new(lead, 1).unwrap(),
            rpm,
            long_x,
            StartAngle::INDEX,
        ),
        params,
        from,
        rpm,
        long_x,
    }
}

fn long(case: &Case, at: Position) -> i64 {
    if case.long_x { at.x.nm() } else { at.z.nm() }
}

/// Ticks until the pass is over, with a spindle whose angle is `angle(tick)`; hands every point on.
fn run(
    plan: &ThreadPlan,
    run: &mut ThreadRun,
    angle: impl Fn(u32) -> Turns,
    mut see: impl FnMut(u32, &mut ThreadRun, ThreadPoint),
) -> u32 {
    for tick in 0..20_000_000 {
        let point = run.tick(plan, angle(tick));
        see(tick, run, point);
        if point.phase == Phase::Done {
            return tick;
        }
    }
    panic!("the pass never ends");
}

/// Turns per tick in 2⁻³².
fn step(case: &Case, share: f64) -> i64 {
    let per_second = f64::from(case.rpm) / 60.0 * share;
    (per_second * f64::from(case.params.tick_us()) * 1e-6 * 2f64.powi(32)) as i64
}

fn start(case: &Case, plan: &ThreadPlan) -> ThreadRun {
    ThreadRun::start(plan, Turns::ZERO, TurnRate::of_rpm(Rpm::new(case.rpm))).unwrap()
}

#[test]
fn no_limit_is_exceeded_and_every_pass_ends_exactly() {
    leadscrew_seed::volume(1, |seed| {
        let mut random = Random(seed);
        let (mut run_count, mut lagging, mut ticks) = (0_u32, 0_u32, 0_u64);
        let mut worst = [[0.0_f64; 3]; 2];
        for n in 0..passes() {
            let case = case(&mut random);
            let plan = match ThreadPlan::new(case.from, &case.moves, &case.params, TurnRate::ZERO) {
                Ok(plan) => plan,
                Err(alarm) => {
                    let known = [
                        Code::StrokeTooShortForSpeed,
                        Code::RunInTooFast,
                        Code::LeadTooFast,
                    ];
                    assert!(known.contains(&alarm.code));
                    continue;
                }
            };
            run_count += 1;
            let last = case.moves.last().unwrap();
            if plan.end() != last.to {
                lagging += 1;
                assert_eq!(long(&case, plan.end()), long(&case, last.to));
            }
            // At the commanded speed or below it.
            let step = step(
                &case,
                if random.chance(50) {
                    1.0
                } else {
                    random.scale(0.3, 1.0)
                },
            );
            let mut x = Watch::new(&case.params, Axis::X, case.from.x.nm());
            let mut z = Watch::new(&case.params, Axis::Z, case.from.z.nm());
            let mut thread = start(&case, &plan);
            let mut end = case.from;
            let angle = |tick| Turns::from_raw(step * i64::from(tick));
            ticks += u64::from(run(&plan, &mut thread, angle, |tick, run, point| {
                x.see(point.position.x.nm());
                z.see(point.position.z.nm());
                if point.phase == Phase::Locked {
                    let exact = run.helix(&plan).at(angle(tick));
                    assert_eq!(long(&case, point.position), exact.nm());
                }
                end = point.position;
            }));
            for _ in 0..3 {
                x.see(end.x.nm());
                z.see(end.z.nm());
            }
            assert_eq!(end, plan.end(), "pass {n}");
            for (axis, watch) in [&x, &z].into_iter().enumerate() {
                for (order, over) in watch.worst.into_iter().enumerate() {
                    worst[axis][order] = worst[axis][order].max(over);
                    assert!(
                        over <= 1.0,
                        "pass {n}, axis {axis}, order {order}: {over}\n{:?}\n{plan:#?}",
                        case.moves
                    );
                }
            }
        }
        println!(
            "{run_count} of {} passes, {lagging} with a lagging run-out, {ticks} ticks; worst shares {worst:?}",
            passes()
        );
        assert!(run_count * 2 > passes() && lagging > 0);
    });
}

/// Angles of a spindle that turns forward, stops, creeps back and races, tick by tick, and at last turns on.
fn wild(random: &mut Random, case: &Case) -> Vec<Turns> {
    let most = step(case, 1.0);
    let (mut angle, mut speed, mut wanted) = (0_i64, most, most);
    let mut angles = Vec::new();
    for _ in 0..random.whole(200, 4000) {
        if random.chance(2) {
            wanted = (most as f64
                * [0.0, 0.1, 0.5, 1.0, 1.3, 3.0, -0.3][random.whole(0, 6) as usize])
                as i64;
        }
        speed += (wanted - speed) / 8;
        angle += speed;
        angles.push(Turns::from_raw(angle));
    }
    angles
}

#[test]
fn the_end_plane_is_never_passed_whatever_the_spindle_does() {
    leadscrew_seed::volume(2, |seed| {
        let mut random = Random(seed);
        let mut run_count = 0_u32;
        while run_count < passes() {
            let case = case(&mut random);
            let Ok(plan) = ThreadPlan::new(case.from, &case.moves, &case.params, TurnRate::ZERO)
            else {
                continue;
            };
            run_count += 1;
            let angles = wild(&mut random, &case);
            let on = |tick: u32| {
                let tick = tick as usize;
                let last = *angles.last().unwrap();
                let beyond = (tick + 1).saturating_sub(angles.len()) as i64;
                angles
                    .get(tick)
                    .copied()
                    .unwrap_or(last + Turns::from_raw(8 * beyond * step(&case, 1.0)))
            };
            let (first, last) = (long(&case, case.from), long(&case, plan.end()));
            let mut thread = start(&case, &plan);
            let mut end = case.from;
            run(&plan, &mut thread, on, |_, _, point| {
                let here = long(&case, point.position);
                assert!(here >= first.min(last) && here <= first.max(last));
                end = point.position;
            });
            assert_eq!(end, plan.end());
            // Over is over: the spindle may turn back now.
            assert_eq!(thread.tick(&plan, Turns::ZERO).position, end);
        }
    });
}

/// What an operator does in mid-pass.
#[derive(Clone, Copy, PartialEq)]
enum Act {
    Retract,
    Stop,
}

/// Passes at constant speed, each interrupted once; gives the worst shares of the limits.
fn interrupted(act: Act, seed: u64) -> [[f64; 3]; 2] {
    let mut random = Random(seed);
    let mut worst = [[0.0_f64; 3]; 2];
    let (mut run_count, mut leaving) = (0_u32, 0_u32);
    while run_count < passes() {
        let case = case(&mut random);
        let Ok(plan) = ThreadPlan::new(case.from, &case.moves, &case.params, TurnRate::ZERO) else {
            continue;
        };
        run_count += 1;
        let step = step(
            &case,
            if random.chance(50) {
                1.0
            } else {
                random.scale(0.3, 1.0)
            },
        );
        let mut thread = start(&case, &plan);
        let angle = |tick: u32| Turns::from_raw(step * i64::from(tick));
        let whole = run(&plan, &mut thread.clone(), angle, |_, _, _| {});
        let when = random.whole(0, i64::from(whole)) as u32;
        // The short axis starts at 20 mm and leaves away from zero.
        let short = |at: Position| if case.long_x { at.z } else { at.x };
        let wanted = random.whole(0, 5_000_000);
        let target = short(plan.end());
        let target = target + Length::from_nm(target.signum() * wanted);
        let mut x = Watch::new(&case.params, Axis::X, case.from.x.nm());
        let mut z = Watch::new(&case.params, Axis::Z, case.from.z.nm());
        let (first, last) = (long(&case, case.from), long(&case, plan.end()));
        let mut end = case.from;
        let took = run(&plan, &mut thread, angle, |tick, thread, point| {
            x.see(point.position.x.nm());
            z.see(point.position.z.nm());
            let here = long(&case, point.position);
            assert!(here >= first.min(last) && here <= first.max(last));
            if tick == when {
                match act {
                    Act::Retract => {
                        leaving += u32::from(thread.retract(&plan, target) == Retract::Leaving)
                    }
                    Act::Stop => thread.stop(&plan),
                }
            }
            end = point.position;
        });
        if act == Act::Retract {
            assert!(took <= whole);
        }
        for _ in 0..3 {
            x.see(end.x.nm());
            z.see(end.z.nm());
        }
        for (axis, watch) in [&x, &z].into_iter().enumerate() {
            for (order, over) in watch.worst.into_iter().enumerate() {
                worst[axis][order] = worst[axis][order].max(over);
            }
        }
    }
    println!("{run_count} passes, {leaving} left; worst shares {worst:?}");
    worst
}

#[test]
fn a_retract_keeps_the_limits() {
    leadscrew_seed::volume(3, |seed| {
        let worst = interrupted(Act::Retract, seed);
        assert!(worst.as_flattened().iter().all(|share| *share <= 1.0));
    });
}

#[test]
fn a_stop_keeps_the_limits() {
    leadscrew_seed::volume(4, |seed| {
        let worst = interrupted(Act::Stop, seed);
        assert!(worst.as_flattened().iter().all(|share| *share <= 1.0));
    });
}
