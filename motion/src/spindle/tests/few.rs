//! Encoders of few counts: what the observer makes of them where the spindle is steady and where it swings.

extern crate std;

use super::super::*;
use super::swinging::{LEAD_UM, Swinging, UNIT};
use crate::units::Ticks;

/// A spindle with a swing, on an encoder whose edges are timed.
#[derive(Clone, Copy, Debug)]
struct Case {
    counts: u32,
    rpm: f64,
    /// Share of the speed, and frequency in Hz.
    swing: (f64, f64),
}

/// The largest values of five seconds, after as many.
#[derive(Clone, Copy, Debug, Default)]
struct Largest {
    /// Predicted angle beside the true one, on a lead of 6 mm, µm.
    beside: f64,
    /// Of the predicted angle on that lead, m/s².
    acceleration: f64,
    /// Relative error of the speed.
    speed: f64,
}

/// Ticks of a millisecond, a bandwidth of 35 Hz.
fn run(case: Case) -> Largest {
    let mut spindle = Swinging::new(case.counts, case.rpm, case.swing);
    let mut observer = Observer::new(case.counts, 35, 1000);
    let mut before = [0.0; 2];
    let mut largest = Largest::default();
    for tick in 1..10_000 {
        let t = f64::from(tick) * 1e-3;
        observer.tick(spindle.sample(t, true));
        let shown = observer.predict(Ticks::ONE).raw() as f64 / UNIT * LEAD_UM;
        let [a, b] = before;
        before = [b, shown];
        if tick <= 5_000 {
            continue;
        }
        let beside = (shown - spindle.at(t + 1e-3) * LEAD_UM).abs();
        let wrong = observer.speed().raw() as f64 / UNIT / spindle.speed(t) - 1.0;
        largest.beside = largest.beside.max(beside);
        largest.acceleration = largest.acceleration.max((shown - 2.0 * b + a).abs());
        largest.speed = largest.speed.max(wrong.abs());
    }
    largest
}

/// Where a steady spindle was lost by 100 to 500 µm below 280 counts a second.
#[test]
fn few_timed_counts_tell_a_steady_spindle_at_any_speed() {
    for counts in [16, 60, 100, 360, 999] {
        for rpm in [10.3, 30.4, 101.0, 304.0, -101.0, 1217.0] {
            let case = Case {
                counts,
                rpm,
                swing: (0.001, 5.0),
            };
            if f64::from(counts) * rpm.abs() < 600.0 {
                // With fewer than ten counts a second, five seconds are not enough.
                continue;
            }
            let largest = run(case);
            assert!(
                largest.beside < 1.2 && largest.speed < 0.005,
                "{case:?}: {largest:?}"
            );
        }
    }
}

/// From the slowest speed that a thread may have on: the figures of `FEW_A_SECOND`.
#[test]
fn few_timed_counts_follow_a_swing_from_their_slowest_speed_on() {
    for counts in [60, 100, 360, 999] {
        let resolution = Resolution {
            counts,
            timed: true,
            swing_known: false,
            bandwidth_hz: 35,
            tick_us: 1000,
        };
        let slowest = f64::from(resolution.slowest().get());
        for times in [1.013, 1.41, 2.53, 5.07] {
            for swing in [(0.1, 5.0), (0.05, 20.0)] {
                let case = Case {
                    counts,
                    rpm: slowest * times,
                    swing,
                };
                let largest = run(case);
                assert!(
                    largest.beside < 14.0 && largest.acceleration < 4.0 && largest.speed < 0.15,
                    "{case:?}: {largest:?}"
                );
            }
        }
    }
}

/// Whatever waits for a standing spindle (M29, M3 after a rigid tap) would wait longer than it may.
#[test]
fn a_spindle_that_has_stopped_stands_after_a_second_without_an_edge() {
    for (counts, timed) in [
        (4, true),
        (16, false),
        (47, false),
        (100, true),
        (239, true),
    ] {
        let mut spindle = Swinging::new(counts, 415.0, (0.0, 5.0));
        let mut observer = Observer::new(counts, 35, 1000);
        let mut last = spindle.sample(0.0, timed);
        for tick in 1..3_000 {
            last = spindle.sample(f64::from(tick) * 1e-3, timed);
            observer.tick(last);
        }
        assert!(observer.is_turning());
        for tick in 1..=1_001 {
            let older = |age| age + tick * 1_000_000;
            observer.tick(EncoderSample {
                index: None,
                edge_age_ns: last.edge_age_ns.map(older),
                ..last
            });
        }
        assert!(!observer.is_turning(), "{counts} counts");
    }
}
