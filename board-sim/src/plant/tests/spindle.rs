//! Spindle and encoder against the formula and the true angle.

extern crate std;

use super::super::*;
use leadscrew_core::units::Rpm;
use std::vec::Vec;

const TAU: f64 = std::f64::consts::TAU;

fn turns(angle: FineTurns) -> f64 {
    angle.raw() as f64 / 2f64.powi(64)
}

/// Speed and angle by the formula, in doubles: from rest at t = 0, ramp to `rpm`, ripple of `part` at `hz`.
fn formula(t: f64, rpm: f64, ramp_ms: f64, part: f64, hz: f64) -> (f64, f64) {
    let acceleration = 1000.0 / 60.0 / (ramp_ms / 1000.0) * rpm.signum();
    let top = rpm / 60.0;
    let arrival = top / acceleration;
    let w = TAU * hz;
    let ripple_on_ramp =
        |t: f64| part * acceleration * (-t * (w * t).cos() / w + (w * t).sin() / (w * w));
    let ramp_time = t.min(arrival);
    let mut angle = acceleration * ramp_time * ramp_time / 2.0 + ripple_on_ramp(ramp_time);
    let mut speed = acceleration * ramp_time;
    if t > arrival {
        angle += top * (t - arrival) + part * top * ((w * arrival).cos() - (w * t).cos()) / w;
        speed = top;
    }
    (speed * (1.0 + part * (w * t).sin()), angle)
}

#[test]
fn the_angle_is_that_of_the_formula() {
    for (rpm, ramp, percent, hz) in [
        (300, 500, 0.0, 1.0),
        (300, 500, 10.0, 5.0),
        (-300, 500, 10.0, 5.0),
        (3000, 500, 90.0, 0.01),
        (1, 60_000, 25.0, 300.0),
        (4000, 1, 3.5, 1000.0),
        (777, 333, 12.345, 7.777),
    ] {
        let ripple = Ripple::new(
            (percent * 1000.0f64).round() as u32,
            (hz * 1000.0f64).round() as u32,
        )
        .unwrap();
        let mut s = Spindle::new(ramp, Some(ripple), Turns::ZERO).unwrap();
        s.command(MilliRpm::of(Rpm::new(rpm), 100));
        let mut worst: f64 = 0.0;
        for tick in 1..=20_000u32 {
            s.advance(997_000, |_| ());
            let t = f64::from(tick) * 997e-6;
            let (speed, angle) = formula(t, f64::from(rpm), f64::from(ramp), percent / 100.0, hz);
            worst = worst.max((turns(s.angle()) - angle).abs());
            let miss = f64::from(s.speed().get()) - speed * 60_000.0;
            assert!(miss.abs() < 1.5, "{rpm} rpm: speed off by {miss} mrpm");
        }
        // At large angles the doubles themselves lose digits.
        assert!(worst < 1e-9, "{rpm} rpm, {percent} % at {hz} Hz: {worst:e}");
    }
}

#[test]
fn an_hour_does_not_drift() {
    let mut s = Spindle::new(500, Ripple::new(10_000, 5_000), Turns::ZERO).unwrap();
    s.command(MilliRpm::of(Rpm::new(300), 100));
    // 300 rpm is 5 turns a second; the ramp of 150 ms costs 0.375 turns. The ripple during the ramp leaves a constant.
    s.advance(10_000_000_000, |_| ());
    let begin = s.angle();
    for _ in 0..360_000 {
        s.advance(10_000_000, |_| ());
    }
    let gone = s.angle().raw() - begin.raw();
    assert!(
        (gone - (18_000i128 << 64)).unsigned_abs() < 1 << 30,
        "{gone:X}"
    );
}

#[test]
fn without_ripple_the_angle_is_exact() {
    // 600 rpm in 300 ms: 1.5 turns on the ramp, then 10 turns a second, in steps of any length.
    for step in [1_000_000u64, 250_000, 1, 999_999_937] {
        let mut s = Spindle::new(500, None, Turns::whole(-3)).unwrap();
        s.command(MilliRpm::of(Rpm::new(600), 100));
        let mut left = 2_300_000_000u64;
        if step == 1 {
            // Single nanoseconds for a while, then the rest at once.
            for _ in 0..1000 {
                s.advance(1, |_| ());
            }
            left -= 1000;
        }
        while left > 0 {
            let ns = left.min(step.max(1000));
            s.advance(ns, |_| ());
            left -= ns;
        }
        // −3 + 1.5 + 20.
        assert_eq!(s.angle().raw(), (37i128 << 64) / 2);
        assert_eq!(s.angle().micro_turns(), 18_500_000);
        assert_eq!(s.speed().get(), 600_000);
    }
}

#[test]
fn reversal_passes_through_standstill_without_a_jump() {
    let mut s = Spindle::new(500, Ripple::new(20_000, 11_000), Turns::ZERO).unwrap();
    s.command(MilliRpm::of(Rpm::new(500), 100));
    s.advance(1_000_000_000, |_| ());
    s.command(MilliRpm::of(Rpm::new(-500), 100));
    let mut last = (turns(s.angle()), f64::from(s.speed().get()) / 60_000.0);
    let mut directions = Vec::new();
    for _ in 0..700 {
        s.advance(1_000_000, |piece| {
            let (a, b) = (piece.angle(0), piece.angle(piece.duration()));
            if a != b {
                directions.push(b > a);
            }
        });
        let now = (turns(s.angle()), f64::from(s.speed().get()) / 60_000.0);
        // In a millisecond the speed changes by 0.033 turns/s on the ramp and 0.12 by the ripple at most.
        assert!((now.1 - last.1).abs() < 0.16);
        assert!((now.0 - last.0 - (now.1 + last.1) / 2.0 * 1e-3).abs() < 2e-6);
        last = now;
    }
    // Forwards until it stands, then backwards.
    assert!(directions.is_sorted_by(|a, b| a >= b));
    assert!(directions[0] && !directions[directions.len() - 1]);
}

#[test]
fn disturbances_go_along_the_ramp_and_are_undone() {
    let mut s = Spindle::new(500, None, Turns::ZERO).unwrap();
    s.command(MilliRpm::of(Rpm::new(1000), 100));
    s.advance(500_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_000_000);
    s.disturb(130);
    s.advance(100_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_200_000);
    s.advance(100_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_300_000);
    s.disturb(0);
    s.advance(650_000_000, |_| ());
    assert_eq!(s.speed().get(), 0);
    s.disturb(100);
    s.advance(500_000_000, |_| ());
    assert_eq!(s.speed().get(), 1_000_000);
}

#[test]
fn what_cannot_be_is_refused() {
    assert!(Spindle::new(0, None, Turns::ZERO).is_none());
    assert!(Spindle::new(60_001, None, Turns::ZERO).is_none());
    assert_eq!(Ripple::new(90_001, 5000), None);
    assert_eq!(Ripple::new(10_000, 9), None);
    assert_eq!(Ripple::new(10_000, 1_000_001), None);
    assert!(Encoder::new(0, true, FineTurns::default(), 0).is_none());
}

/// Runs a spindle with an encoder through speeds, and checks every sample against the true angle.
fn encoder_against_truth(zero: i32, angle: Turns) {
    const COUNTS: i64 = 4096;
    let mut s = Spindle::new(100, Ripple::new(30_000, 17_000), angle).unwrap();
    let mut e = Encoder::new(COUNTS as u32, true, s.angle(), zero).unwrap();
    let shown = |count: i64| zero.wrapping_add(count as i32);
    let count = |a: FineTurns| ((a.raw() * i128::from(COUNTS)) >> 64) as i64;
    let mut now = 0u64;
    let mut last_edge: Option<u64> = None;
    let mut pulses = 0;
    for (rpm, ticks) in [
        (0, 3),
        (300, 800),
        (3, 2000),
        (-2, 3000),
        (-3000, 900),
        (1700, 900),
        (0, 400),
    ] {
        s.command(MilliRpm::of(Rpm::new(rpm), 100));
        for _ in 0..ticks {
            let mut pulse = None;
            s.advance(1_000_000, |piece| {
                // The edge, found by halving only, to a nanosecond.
                let (from, to) = (count(piece.angle(0)), count(piece.angle(piece.duration())));
                if from != to {
                    let (mut early, mut late) = (0, piece.duration());
                    while late - early > 1 {
                        let half = (early + late) / 2;
                        if count(piece.angle(half)) == to {
                            late = half;
                        } else {
                            early = half;
                        }
                    }
                    last_edge = Some(now + late);
                }
                // Every count that was entered between the two samples.
                if to > from {
                    for c in from + 1..=to {
                        pulse = if c % COUNTS == 0 { Some(c) } else { pulse };
                    }
                } else {
                    for c in (to..from).rev() {
                        pulse = if c % COUNTS == 0 { Some(c) } else { pulse };
                    }
                }
                now += piece.duration();
                e.turn(piece);
            });
            let sample = e.sample();
            assert_eq!(sample.count, shown(count(s.angle())));
            assert_eq!(
                sample.edge_age_ns.map(u64::from),
                last_edge.map(|edge| now - edge),
                "at {now} ns"
            );
            assert_eq!(sample.index, pulse.map(shown), "at {now} ns");
            pulses += u32::from(sample.index.is_some());
        }
    }
    assert!(pulses > 20, "{pulses}");
}

#[test]
fn count_edge_time_and_index_are_those_of_the_true_angle() {
    encoder_against_truth(0, Turns::ZERO);
    encoder_against_truth(i32::MAX - 1000, Turns::from_raw(123_456_789));
    encoder_against_truth(-77, Turns::whole(-2));
}

#[test]
fn the_index_comes_once_a_turn_in_both_directions() {
    for rpm in [600, -600] {
        let mut s = Spindle::new(1, None, Turns::from_raw(1 << 31)).unwrap();
        let mut e = Encoder::new(4096, true, s.angle(), 0).unwrap();
        s.command(MilliRpm::of(Rpm::new(rpm), 100));
        let mut seen = Vec::new();
        for _ in 0..1000 {
            s.advance(1_000_000, |piece| e.turn(piece));
            seen.extend(e.sample().index);
        }
        let turns: Vec<i32> = seen.iter().map(|latched| latched / 4096).collect();
        let expected: Vec<i32> = if rpm > 0 {
            (1..=10).collect()
        } else {
            (-9..=0).rev().collect()
        };
        assert_eq!(turns, expected);
        assert!(seen.iter().all(|latched| latched % 4096 == 0));
    }
}

#[test]
fn without_the_hardware_there_is_no_edge_time() {
    let mut s = Spindle::new(1, None, Turns::ZERO).unwrap();
    let mut e = Encoder::new(4096, false, s.angle(), 0).unwrap();
    s.command(MilliRpm::of(Rpm::new(600), 100));
    s.advance(10_000_000, |piece| e.turn(piece));
    assert_eq!(e.sample().edge_age_ns, None);
    assert!(e.sample().count > 0);
}
