//! Random moves, one after another, each from where the last one ended.

use crate::machine::{self, Watch};
use crate::operator::Operator;
use crate::random::Random;
use leadscrew_core::alarm::Span;
use leadscrew_core::call::{FeedRate, Position};
use leadscrew_core::motion::{Limits, Pace, Run, plan};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Angle, Feed, FeedPerTurn, Length, Rpm};
use std::f64::consts::TAU;

fn moves() -> u32 {
    leadscrew_seed::amount(20_000, 150_000)
}
const MOVES_OF_A_MACHINE: u32 = 500;

#[test]
fn no_setpoint_exceeds_a_limit_and_every_move_ends_on_its_target() {
    leadscrew_seed::volume(2, |seed| {
        let mut random = Random::new(seed);
        let mut run = Run::new();
        let (mut ticks, mut abandoned, mut used) = (0_u64, 0_u32, [0.0_f64; 3]);
        let mut done = 0;
        while done < moves() {
            let params = machine::random(&mut random);
            let limits = Limits::from_params(&params);
            let mut at = Position::default();
            let mut watch = Watch::new(&params, at);
            for _ in 0..MOVES_OF_A_MACHINE {
                let (wanted, pace) = random_move(&mut random, &params, at);
                let planned = match plan::timed(at, &wanted, &limits) {
                    Ok(planned) => planned.expect("time drives it"),
                    Err(alarm) => panic!("move {done}: {alarm:?} for {wanted:?}"),
                };
                assert!(run.begin(&planned));
                let mut operator = Operator::random(&mut random, pace);
                let (mut tick, mut touched, mut gave_up) = (0, false, false);
                // A long arc in a machine of little acceleration takes some 300 000 ticks by itself.
                let most = 200_000 + 20 * planned.duration_ticks();
                loop {
                    let rate = operator.rate(&mut random, tick);
                    touched |= rate != leadscrew_core::motion::Rate::FULL;
                    if operator.gives_up(tick) && !run.at_rest() {
                        run.abandon();
                        gave_up = true;
                    }
                    let step = run.tick(rate, &planned);
                    tick += 1;
                    if let Err(excess) = watch.setpoint(step.position, pace) {
                        panic!(
                            "move {done}, tick {tick}: {excess}\n{wanted:?} from {at:?}\n{planned:?}"
                        );
                    }
                    at = step.position;
                    if step.done {
                        break;
                    }
                    assert!(tick < most, "move {done} never ends: {planned:?}");
                }
                if gave_up {
                    abandoned += 1;
                } else {
                    assert_eq!(at, wanted.to, "move {done}");
                    if !touched {
                        assert_eq!(tick, planned.duration_ticks().max(1), "move {done}");
                    }
                }
                ticks += tick;
                done += 1;
            }
            for (most, used) in used.iter_mut().zip(watch.used) {
                *most = most.max(used);
            }
        }
        println!(
            "{done} moves, {ticks} setpoints, {abandoned} abandoned; most of speed, acceleration, jerk used: {used:.4?}"
        );
        // The limits are reached, not merely kept.
        assert!(used.iter().all(|used| *used > 0.99), "{used:?}");
        assert!(abandoned > moves() / 100);
    });
}

/// A rapid, a feed per minute or per turn, or an arc, from nanometres to centimetres.
fn random_move(random: &mut Random, params: &Params, from: Position) -> (Move, Pace) {
    let tick = f64::from(params.tick_us()) * 1e-6;
    let mut to = from;
    let length = random.decades(1.0, 3e7);
    let kind = random.below(5);
    let mut arc = None;
    if kind == 4 {
        let (end, i, k, clockwise) = random_arc(random, from, length);
        (to.x, to.z) = (end.0, end.1);
        arc = Some((i, k, clockwise));
    } else {
        let mut step = |most: i64| {
            // Each axis stands, moves a little or moves as far as the others, back towards zero if far away.
            match random.below(4) {
                0 => 0,
                1 => random.below(most / 50 + 2) - most / 100 - 1,
                _ => random.below(2 * most + 1) - most,
            }
        };
        let home = |at: i64, by: i64| {
            if (at + by).abs() > 1 << 40 {
                at - by
            } else {
                at + by
            }
        };
        to.x = Length::from_nm(home(from.x.nm(), step(length)));
        to.z = Length::from_nm(home(from.z.nm(), step(length)));
        to.c = Angle::from_udeg(home(from.c.udeg(), step(length)));
    }
    // A feed that takes 3 to 3000 ticks, as far as the machine can.
    let ticks = random.decades(3.0, 3_000.0) as f64;
    let nm_per_min = (length as f64 / (ticks * tick) * 60.0).max(60_000.0) as i64;
    let feed = if random.one_in(3) {
        FeedRate::PerTurn(FeedPerTurn::from_nm(nm_per_min / 60 + 1), Rpm::new(-60))
    } else {
        FeedRate::PerMinute(Feed::from_nm_per_min(nm_per_min))
    };
    let (kind, pace) = match (kind, arc) {
        (_, Some((i, k, clockwise))) => (
            MoveKind::Arc {
                i: Length::from_nm(i),
                k: Length::from_nm(k),
                clockwise,
                feed,
            },
            Pace::Cutting,
        ),
        (0 | 1, None) => (MoveKind::Rapid, Pace::Rapid),
        _ => (MoveKind::Feed(feed), Pace::Cutting),
    };
    let wanted = Move {
        span: Span::default(),
        to,
        kind,
        tag: None,
    };
    (wanted, pace)
}

/// An arc of about the length, to either side: its end, and its centre from the start.
fn random_arc(
    random: &mut Random,
    from: Position,
    length: i64,
) -> ((Length, Length), i64, i64, bool) {
    // Rounded ends must not change sides.
    let length = length.max(10);
    let radius = random.decades((length as f64 / 6.0).max(20.0), 1e9) as f64;
    let angle = random.below(1 << 30) as f64 / (1 << 30) as f64 * TAU;
    let (i, k) = (
        (radius * angle.sin()).round(),
        (radius * angle.cos()).round(),
    );
    let turn = (length as f64 / radius).min(TAU) * if random.one_in(2) { 1.0 } else { -1.0 };
    // Rounding adds a nanometre and a half, and a quarter of the radius is the most.
    let off = random.below((radius / 5.0 - 1.5).clamp(0.0, 9_000.0) as i64 + 1) as f64;
    let (x, z) = (
        i - (radius + off) * (angle + turn).sin(),
        k - (radius + off) * (angle + turn).cos(),
    );
    let end = (
        from.x + Length::from_nm(x.round() as i64),
        from.z + Length::from_nm(z.round() as i64),
    );
    // The other way round where that is not much further.
    let clockwise = (turn < 0.0) != ((length as f64) > radius && random.one_in(3));
    (end, i as i64, k as i64, clockwise)
}
