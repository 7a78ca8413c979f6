//! Spindles that come to rest somewhere between two counts, and spindles that creep.

extern crate std;

use std::vec::Vec;

use leadscrew_seed::{Random, amount, volume};

use super::super::*;
use crate::units::TurnRate;

/// The largest number of counts that a parameter takes.
const FINEST: u32 = 1 << 20;

/// A spindle on an encoder.
#[derive(Clone, Copy, Debug)]
struct Case {
    counts: u32,
    bandwidth: u32,
    tick_us: u32,
    timed: bool,
}

/// An encoder with its observer.
struct Seen {
    case: Case,
    observer: Observer,
    /// Where the encoder stands, and the time of its last edge in seconds.
    count: i64,
    edge: Option<f64>,
    tick: u32,
}

impl Seen {
    fn new(case: Case) -> Self {
        Self {
            case,
            observer: Observer::new(case.counts, case.bandwidth, case.tick_us),
            count: 0,
            edge: None,
            tick: 0,
        }
    }

    fn time(&self) -> f64 {
        f64::from(self.tick) * f64::from(self.case.tick_us) * 1e-6
    }

    /// The next tick of a spindle that is `at` so many turns, and `passes` an angle at a time.
    fn tick(&mut self, at: impl Fn(f64) -> f64, passes: impl Fn(f64) -> f64) {
        self.tick += 1;
        let t = self.time();
        let count = (at(t) * f64::from(self.case.counts)).floor() as i64;
        if count != self.count {
            let boundary = if count > self.count { count } else { count + 1 };
            self.edge = Some(passes(boundary as f64 / f64::from(self.case.counts)));
            self.count = count;
        }
        let age = self.edge.map(|edge| ((t - edge).max(0.0) * 1e9) as u32);
        self.observer.tick(EncoderSample {
            count: count as i32,
            edge_age_ns: age.filter(|_| self.case.timed),
            index: None,
        });
    }
}

/// Each setting of the observer on an encoder.
fn settings(counts: u32) -> impl Iterator<Item = Case> {
    let each = [(250, 80), (1000, 35), (1000, 200), (2000, 15)];
    each.into_iter()
        .flat_map(move |(tick_us, bandwidth)| both(counts, tick_us, bandwidth))
}

/// With times of edges and without.
fn both(counts: u32, tick_us: u32, bandwidth: u32) -> [Case; 2] {
    [true, false].map(|timed| Case {
        counts,
        bandwidth,
        tick_us,
        timed,
    })
}

fn cases() -> Vec<Case> {
    let counts = [16, 100, 999, 1000, 1024, 4096, 5000, 20_000, FINEST];
    counts.into_iter().flat_map(settings).collect()
}

/// From 0 to 1, another one with each call.
fn part(random: &mut Random) -> f64 {
    (random.bits() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Tries each encoder this often.
fn each(
    number: u64,
    cases: impl Fn() -> Vec<Case>,
    often: (usize, usize),
    try_one: impl Fn(Case, &mut Random),
) {
    volume(number, |seed| {
        let mut random = Random(seed);
        for case in cases() {
            for _ in 0..amount(often.0, often.1) {
                try_one(case, &mut random);
            }
        }
    });
}

/// The way it turns: 1 or −1.
fn side(random: &mut Random) -> f64 {
    if part(random) < 0.5 { 1.0 } else { -1.0 }
}

/// It turns evenly, at so many turns a second, for six seconds; of the last three each tick is judged.
fn evenly(case: Case, side: f64, speed: f64, random: &mut Random, judge: impl Fn(&Seen)) {
    let from = part(random);
    let at = |t: f64| side * (from + speed * t);
    let passes = |angle: f64| (side * angle - from) / speed;
    let mut seen = Seen::new(case);
    while seen.time() < 3.0 {
        seen.tick(at, passes);
    }
    for _ in 0..3000 {
        seen.tick(at, passes);
        judge(&seen);
    }
}

/// Where the tracker swung about the count for ever, a gear and the chuck were refused until the spindle was moved.
#[test]
fn a_spindle_that_comes_to_rest_anywhere_stands_within_a_second() {
    each(509, cases, (4, 40), |case, random| {
        let side = side(random);
        // A stop of half a second to five, from 18 to 500 rpm.
        let stop = 0.5 + 4.5 * part(random);
        let speed = 0.3 + 8.0 * part(random);
        let half = speed / stop / 2.0;
        let rest = part(random) + half * stop * stop;
        let at = |t: f64| side * (rest - half * (stop - t).max(0.0).powi(2));
        let passes = |angle: f64| stop - ((rest - side * angle).max(0.0) / half).sqrt();
        let mut seen = Seen::new(case);
        while seen.time() < stop + 1.01 {
            seen.tick(at, passes);
        }
        for _ in 0..1000 {
            seen.tick(at, passes);
            let speed = seen.observer.speed();
            assert!(
                !seen.observer.is_turning() && speed == TurnRate::ZERO,
                "{case:?}: {} rpm at rest at {} of a count",
                speed.rpm().get(),
                (rest * f64::from(case.counts)).fract()
            );
        }
    });
}

#[test]
fn a_spindle_that_creeps_faster_than_one_that_stands_turns() {
    each(510, cases, (2, 20), |case, random| {
        let side = side(random);
        // A quarter of a turn a minute, or a count in a second.
        let least = (1.0 / 240.0_f64).max(1.0 / f64::from(case.counts));
        let speed = least * (1.1 + 3.0 * part(random));
        evenly(case, side, speed, random, |seen| {
            assert!(
                seen.observer.is_turning(),
                "{case:?}: {} of the slowest speed at {}",
                speed / least,
                seen.time()
            );
        });
    });
}

/// A quarter of a turn a minute.
fn is_slow(observer: &Observer) -> bool {
    observer.speed().abs().raw() <= (1 << 32) / 240
}

/// Encoders of many counts, of which one at a quarter of a turn a minute takes 15 ticks at most: a spindle that stands in a
/// drive that is on may tremble over some of them.
fn fine_cases() -> Vec<Case> {
    let counts = [20_000, 60_000, 120_000, 250_000, 480_000, 700_000, FINEST];
    let all = counts
        .into_iter()
        .flat_map(|counts| settings(counts).chain(both(counts, 1000, 5)));
    all.filter(|case| case.counts * case.tick_us >= 16_000_000)
        .collect()
}

/// Two movements one way in a row said that it turns, whatever its speed: a gear was refused, and the chuck's switch was
/// an alarm.
#[test]
fn a_spindle_that_trembles_turns_no_faster_than_its_speed_says() {
    each(511, fine_cases, (2, 20), |case, random| {
        let most = if part(random) < 0.5 { 2.0 } else { 3.0 };
        let often = 0.2 + 0.8 * part(random);
        let mut by = 0.0;
        let mut seen = Seen::new(case);
        for tick in 0..4000 {
            if part(random) < often {
                by = ((2.0 * most + 1.0) * part(random)).floor() - most;
            }
            let place = (5.5 + by) / f64::from(case.counts);
            let now = seen.time() + f64::from(case.tick_us) * 1e-6;
            let edge = now - part(random) * f64::from(case.tick_us) * 1e-6;
            seen.tick(|_| place, |_| edge);
            // The tracker begins.
            if tick < 1000 {
                continue;
            }
            let turns = seen.observer.is_turning();
            assert!(
                !turns || !is_slow(&seen.observer),
                "{case:?}: ±{most} counts, {} rpm",
                seen.observer.speed().rpm().get()
            );
            let tells = case.counts == FINEST && case.bandwidth < 200;
            assert!(!turns || !tells, "{case:?}: ±{most} counts");
        }
    });
}

#[test]
fn a_spindle_that_drifts_slower_than_one_that_turns_stands() {
    let finest = || {
        let mut cases = fine_cases();
        cases.retain(|case| case.counts == FINEST);
        cases
    };
    each(512, finest, (2, 20), |case, random| {
        let side = side(random);
        // Up to 0.1 rpm.
        let speed = (0.02 + 0.08 * part(random)) / 60.0;
        evenly(case, side, speed, random, |seen| {
            assert!(
                !seen.observer.is_turning(),
                "{case:?}: {speed} turns a second"
            );
        });
    });
}
