//! The observer on an ideal encoder: angles, index, slip, counts that are not a power of two, standstill.

mod few;
mod learned;
mod rest;
mod steady;
mod swinging;

extern crate std;

use std::vec::Vec;

use super::*;
use crate::units::{Rpm, Ticks, TurnRate, Turns};

const TURN: i128 = 1 << 32;

/// An encoder at a steady speed, exact in integers. The angle moves `step` 2⁻³² turns each tick, from `angle` on. The
/// counter stands at `zero` where the angle is 0.
#[derive(Clone, Copy)]
struct Encoder {
    counts: i64,
    zero: i32,
    angle: i64,
    step: i64,
    edges: bool,
    tick_ns: i64,
}

impl Encoder {
    fn new(step: i64) -> Self {
        Self {
            counts: 4096,
            zero: 0,
            angle: 0,
            step,
            edges: true,
            tick_ns: 1_000_000,
        }
    }

    fn count(&self, angle: i64) -> i64 {
        (i128::from(angle) * i128::from(self.counts)).div_euclid(TURN) as i64
    }

    fn tick(&mut self) -> EncoderSample {
        let before = self.count(self.angle);
        self.angle += self.step;
        let count = self.count(self.angle);
        let shown = |count: i64| self.zero.wrapping_add(count as i32);
        let turn = |count: i64| count.div_euclid(self.counts);
        let index = if count > before && turn(count) > turn(before) {
            Some(turn(count) * self.counts)
        } else {
            let upper = turn(before) * self.counts;
            (count < before && before > upper && count <= upper).then_some(upper)
        };
        let boundary = i128::from(count + i64::from(self.step < 0)) * TURN;
        let way = (i128::from(self.angle) * i128::from(self.counts) - boundary).abs();
        let age = way * i128::from(self.tick_ns)
            / (i128::from(self.step.abs().max(1)) * i128::from(self.counts));
        EncoderSample {
            count: shown(count),
            edge_age_ns: (self.edges && self.step != 0).then_some(age as u32),
            index: index.map(shown),
        }
    }
}

/// The angle that a spindle covers in a tick of one millisecond.
fn step(rpm: i32) -> i64 {
    TurnRate::of_rpm(Rpm::new(rpm)).raw() / 1000
}

/// Signed difference of two angles within a turn.
fn apart(a: Turns, b: i64) -> i64 {
    i64::from((a.raw() as i32).wrapping_sub(b as i32))
}

#[test]
fn steady_speed_is_known_exactly_with_edge_times() {
    for rpm in [1, 10, 300, 3000, 4000, -1, -300, -4000] {
        for counts in [4096, 5000, 1, 1000] {
            let mut encoder = Encoder::new(step(rpm));
            encoder.counts = counts;
            // The hardware counter wraps during the test.
            encoder.zero = if rpm > 0 { i32::MAX - 3 } else { i32::MIN + 3 };
            let mut observer = Observer::new(counts as u32, 35, 1000);
            // At about one count in eight ticks the age of edges is still used in full.
            let enough = counts * step(rpm).abs() >= (1 << 32) / 8;
            for _ in 0..3000 {
                observer.tick(encoder.tick());
            }
            if !enough {
                continue;
            }
            let indexed = observer.indexed();
            assert_eq!(indexed, step(rpm).abs() * 3000 >= 1 << 32);
            // One nanosecond of the edge's time, and the truncated scale.
            let allowed = step(rpm).abs() / 1_000_000 + 4;
            let error = apart(observer.angle(), encoder.angle);
            assert!(
                !indexed || error.abs() <= allowed,
                "{rpm} {counts}: {error}"
            );
            let ahead = observer.predict(Ticks::whole(3));
            let error = apart(ahead, encoder.angle + 3 * encoder.step);
            assert!(
                !indexed || error.abs() <= 4 * allowed,
                "{rpm} {counts}: {error}"
            );
            assert_eq!(observer.speed().rpm(), Rpm::new(rpm));
            assert!(observer.is_turning());
        }
    }
}

#[test]
fn counts_alone_are_good_to_about_half_a_count() {
    for rpm in [30, 300, 3000, -300] {
        let mut encoder = Encoder::new(step(rpm));
        encoder.edges = false;
        let mut observer = Observer::new(4096, 35, 1000);
        let mut worst = 0;
        for n in 0..5000 {
            observer.tick(encoder.tick());
            if n > 3000 {
                worst = worst.max(apart(observer.angle(), encoder.angle).abs());
            }
        }
        // 2⁻³² turns: 0.55 counts.
        assert!(worst <= 576_716, "{rpm}: {worst}");
    }
}

#[test]
fn starts_from_rest_and_stands_again() {
    let mut encoder = Encoder::new(0);
    let mut observer = Observer::new(4096, 35, 1000);
    let mut worst = 0;
    // 1000 rpm in half a second, hold, down again.
    let top = step(1000);
    let speeds: Vec<i64> = (0..1500)
        .map(|n: i64| match n {
            0..500 => top * n / 500,
            500..1000 => top,
            _ => top * (1500 - n) / 500,
        })
        .collect();
    for (n, speed) in speeds.into_iter().enumerate() {
        encoder.step = speed;
        observer.tick(encoder.tick());
        // At the corners the filter needs some ticks to learn the acceleration that changed within two milliseconds.
        if n % 500 > 100 {
            worst = worst.max(apart(observer.angle(), encoder.angle).abs());
        }
    }
    assert!(worst <= (1 << 32) / 4096, "{worst}");
    encoder.step = 0;
    for _ in 0..500 {
        observer.tick(encoder.tick());
    }
    assert!(!observer.is_turning());
    assert_eq!(observer.speed().rpm(), Rpm::STOPPED);
    assert!(apart(observer.angle(), encoder.angle).abs() <= (1 << 32) / 4096);
}

#[test]
fn reversal_keeps_the_angle() {
    let mut encoder = Encoder::new(step(300));
    let mut observer = Observer::new(4096, 35, 1000);
    for n in 0..4000_i64 {
        encoder.step = step(300) * (1000 - (n - 2000).abs().min(2000)) / 1000;
        observer.tick(encoder.tick());
        let error = apart(observer.angle(), encoder.angle).abs();
        assert!(n < 1000 || error <= (1 << 32) / 4096, "{n}: {error}");
    }
}

#[test]
fn the_first_index_is_the_zero_and_the_nearest_turn_is_kept() {
    for (first, rpm) in [(0.0, 300), (0.3, 300), (0.8, 300), (0.3, -300), (0.8, -300)] {
        let mut encoder = Encoder::new(step(rpm));
        encoder.angle = (first * 4_294_967_296.0) as i64;
        let mut observer = Observer::new(4096, 35, 1000);
        let mut events = Vec::new();
        let mut before = observer.angle();
        for _ in 0..1000 {
            let predicted = observer.predict(Ticks::ONE);
            if let Some(event) = observer.tick(encoder.tick()) {
                let jump = (observer.angle() - predicted).raw().abs();
                assert!(jump <= (1 << 31) + (1 << 20));
                events.push(event);
            }
            before = observer.angle();
        }
        assert_eq!(events, [SpindleEvent::Indexed]);
        assert!(apart(before, encoder.angle).abs() < 1 << 8);
    }
}

#[test]
fn lost_counts_are_noticed_at_the_next_index() {
    for rpm in [300, -300] {
        for lost in [1_i32, 2, -7] {
            let mut encoder = Encoder::new(step(rpm));
            let mut observer = Observer::new(4096, 35, 1000);
            for _ in 0..500 {
                observer.tick(encoder.tick());
            }
            encoder.zero += lost;
            let mut events = Vec::new();
            for _ in 0..490 {
                events.extend(observer.tick(encoder.tick()));
            }
            // One count is within the tolerance for an index on a boundary.
            let slip = SpindleEvent::Slipped { counts: lost };
            let wanted = if lost == 1 {
                Vec::new()
            } else {
                std::vec![slip; 2]
            };
            assert_eq!(events, wanted);
        }
    }
}

/// A disturbance on the wires: the angle goes on as if nothing had happened, and the observer reports the slip in the
/// same tick.
#[test]
fn a_counter_that_jumps_is_not_followed() {
    for rpm in [0, 60, 300, -300, 3000] {
        for (tick_ns, tick_us) in [(1_000_000, 1000), (500_000, 500)] {
            for jump in [40_i32, -40, 400, -2000, 1 << 28] {
                let mut encoder = Encoder::new(step(rpm) * i64::from(tick_us) / 1000);
                encoder.tick_ns = tick_ns;
                let mut observer = Observer::new(4096, 35, tick_us as u32).for_ramp(500);
                // The first index comes immediately.
                observer.tick(encoder.tick());
                observer.tick(EncoderSample {
                    index: Some(0),
                    ..encoder.tick()
                });
                for _ in 0..700 {
                    observer.tick(encoder.tick());
                }
                encoder.zero = encoder.zero.wrapping_add(jump);
                let mut sample = encoder.tick();
                sample.index = None;
                let event = observer.tick(sample);
                assert!(
                    matches!(event, Some(SpindleEvent::Slipped { counts }) if (counts - jump).abs() <= 1),
                    "{rpm} {jump}: {event:?}"
                );
                for _ in 0..300 {
                    // Two counts: one of them for the tick in which the observer had no measurement.
                    let off = apart(observer.angle(), encoder.angle).abs();
                    assert!(off <= (1 << 33) / 4096, "{rpm} {jump}: {off}");
                    observer.forget_index();
                    let event = observer.tick(encoder.tick());
                    assert!(!matches!(event, Some(SpindleEvent::Slipped { .. })));
                    if event.is_some() {
                        break;
                    }
                }
            }
        }
    }
}

/// A counter that stands still from one tick to the next because its wire is cut: the observer reports the slip at once
/// and does not extrapolate without end.
#[test]
fn a_counter_that_stays_as_it_is_is_believed_at_the_second_tick() {
    let mut encoder = Encoder::new(step(3000));
    let mut observer = Observer::new(4096, 35, 1000).for_ramp(500);
    for _ in 0..500 {
        observer.tick(encoder.tick());
    }
    let dead = EncoderSample {
        edge_age_ns: None,
        index: None,
        ..encoder.tick()
    };
    let mut events = Vec::new();
    for _ in 0..500 {
        events.extend(observer.tick(dead));
    }
    assert!(
        matches!(
            events[..],
            [SpindleEvent::Slipped {
                counts: -204 | -205
            }]
        ),
        "{events:?}"
    );
    assert!(!observer.is_turning());
}

/// The ramp of a drive, however hard, is not reported as a disturbance.
#[test]
fn the_hardest_ramp_of_the_table_is_followed() {
    for ramp_ms in [1, 4, 20, 500] {
        let mut encoder = Encoder::new(0);
        let mut observer = Observer::new(4096, 35, 1000).for_ramp(ramp_ms);
        // From 3000 rpm backwards to 3000 rpm forwards and back, over and over.
        let (top, by) = (step(3000), step(1000) / i64::from(ramp_ms));
        let mut up = true;
        for _ in 0..5000 {
            encoder.step += if up { by } else { -by };
            if encoder.step.abs() >= top {
                encoder.step = encoder.step.clamp(-top, top);
                up = encoder.step < 0;
            }
            let event = observer.tick(encoder.tick());
            assert!(
                !matches!(event, Some(SpindleEvent::Slipped { .. })),
                "{ramp_ms}: {event:?}"
            );
        }
    }
}

/// Simulates an encoder without edge times and returns, after the observer has settled, the largest acceleration of the
/// predicted angle (turns per second squared) and the largest relative error of the speed (a fraction).
fn shaken(coarse: Resolution, rpm: f64, ahead: Ticks) -> (f64, f64) {
    let tick_s = f64::from(coarse.tick_us) * 1e-6;
    let per_tick = rpm / 60.0 * tick_s * TURN as f64;
    let mut encoder = Encoder::new(per_tick.round() as i64);
    encoder.edges = false;
    encoder.counts = i64::from(coarse.counts);
    encoder.tick_ns = i64::from(coarse.tick_us) * 1000;
    let mut observer = Observer::new(coarse.counts, coarse.bandwidth_hz, coarse.tick_us);
    let (mut shown, mut most, mut wrong) = (Vec::new(), 0.0_f64, 0.0_f64);
    for tick in 0..6_000 {
        observer.tick(encoder.tick());
        if tick < 3_000 {
            continue;
        }
        let speed = observer.speed().raw() as f64 * tick_s / per_tick;
        wrong = wrong.max((speed - 1.0).abs());
        shown.push(observer.predict(ahead).raw());
        if let [.., a, b, c] = shown[..] {
            let difference = (a - 2 * b + c) as f64 / TURN as f64;
            most = most.max(difference.abs() / tick_s / tick_s);
        }
    }
    (most, wrong)
}

#[test]
fn whole_counts_shake_an_axis_by_no_more_than_is_said_and_by_most_of_it() {
    for (bandwidth_hz, tick_us, latency_us) in [(35, 1000, 1000), (20, 2000, 0), (80, 500, 3000)] {
        for counts in [60, 100, 360, 1024, 4096] {
            let coarse = Resolution {
                timed: false,
                swing_known: false,
                counts,
                bandwidth_hz,
                tick_us,
            };
            let ahead = Ticks::one_and(latency_us, tick_us);
            let lead = crate::units::Lead::new(1_000_000_000, 1).unwrap();
            // On a lead of one metre, metres are turns.
            let said = coarse.noise(lead, ahead).nm_per_s2() as f64 * 1e-9;
            let worst = (1..160)
                .map(|n| shaken(coarse, 7.3 * f64::from(n), ahead).0)
                .fold(0.0, f64::max);
            // Fewer counts than a thousand are looked at where they move, which shakes less.
            let least = if counts < 1000 { 0.1 } else { 0.5 };
            assert!(
                worst <= said && worst > least * said,
                "{coarse:?}: {worst} of {said} turns/s²"
            );
        }
    }
}

#[test]
fn the_slowest_speed_of_an_encoder_is_known_and_a_twentieth_of_it_is_not_with_many_counts() {
    for (counts, bandwidth_hz) in [(60, 35), (360, 35), (1024, 20), (4096, 15)] {
        let coarse = Resolution {
            timed: false,
            swing_known: false,
            counts,
            bandwidth_hz,
            tick_us: 1000,
        };
        let slowest = f64::from(coarse.slowest().get());
        let wrong = |rpm: f64| shaken(coarse, rpm, Ticks::ONE).1;
        assert!(wrong(slowest) < 0.15, "{coarse:?}: {}", wrong(slowest));
        assert!(wrong(slowest * 1.07) < 0.15, "{coarse:?}");
        // Few counts are looked at where they move, so they are enough for the speed at any speed.
        let far = wrong(slowest / 20.0);
        assert!(
            if counts < 1000 { far < 0.15 } else { far > 1.0 },
            "{coarse:?}: {far}"
        );
    }
}

/// Whatever the counter does, the speed stays one that a spindle can have. If the spindle stands afterwards, the
/// observer soon knows that it stands.
#[test]
fn after_a_leap_of_the_counter_the_spindle_is_found_again() {
    for (tick_us, bandwidth) in [(250, 35), (1000, 35), (2000, 35), (10_000, 35), (1000, 200)] {
        for leap in [1025, 2048, 12_315, -11_435, 1 << 20, i32::MAX, i32::MIN] {
            // The counter leaps in one tick, or in the steps of a drive that lags: a quarter of the rest in each tick.
            for lags in [false, true] {
                for indexed in [false, true] {
                    let mut observer = Observer::new(4096, bandwidth, tick_us);
                    let mut sample = EncoderSample::default();
                    observer.tick(sample);
                    if indexed {
                        sample.index = Some(0);
                        assert_eq!(observer.tick(sample), Some(SpindleEvent::Indexed));
                        sample.index = None;
                    }
                    let mut rest = leap;
                    for tick in 0..2_000 {
                        let part = if lags { rest / 4 } else { rest };
                        let part = if part == 0 { rest } else { part };
                        sample.count = sample.count.wrapping_add(part);
                        rest -= part;
                        observer.tick(sample);
                        let rpm = observer.speed().rpm().get();
                        // The speed of the fastest spindle, plus the part that the last clipped step added.
                        assert!(
                            rpm.abs() <= 150_000,
                            "{rpm} rpm, {leap} counts, tick {tick}"
                        );
                    }
                    let at = observer.angle();
                    observer.tick(sample);
                    let still = (observer.is_turning(), observer.speed().rpm().get());
                    assert_eq!(still, (false, 0), "{leap} counts, {tick_us} µs, {lags}");
                    // Within one unit, for rounding.
                    assert!(observer.angle().raw().abs_diff(at.raw()) <= 1);
                }
            }
        }
    }
}
