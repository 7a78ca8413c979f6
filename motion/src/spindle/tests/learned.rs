//! Encoders of few counts: a spindle that swings, its encoder, and what the tracker and the follower make of it.

extern crate std;

use super::super::*;
use super::swinging::{LEAD_UM, Swinging, UNIT};
use crate::units::Ticks;

/// A spindle with a swing, on an encoder.
#[derive(Clone, Copy, Debug)]
struct Case {
    counts: u32,
    timed: bool,
    rpm: f64,
    /// Share of the speed, and frequency in Hz; 0 for once a turn.
    swing: (f64, f64),
    /// The frequency is a parameter, and one per cent off.
    known: bool,
}

/// The largest values of a stretch.
#[derive(Clone, Copy, Debug, Default)]
struct Largest {
    /// Beside the true angle, on a lead of 6 mm, µm.
    beside: f64,
    /// m/s² and m/s³.
    acceleration: f64,
    jerk: f64,
}

/// The follower's limits in these tests: 2 m/s² and 60 m/s³.
fn limits(turns: f64) -> Limits {
    let unit = |mm: f64| (mm / 6.0 * UNIT * 65536.0) as i64;
    Limits {
        speed: unit(turns.abs() * 6.0 * 1.2e-3 + 0.0667),
        acceleration: unit(2e-3),
        jerk: unit(60e-6),
        beside: unit(0.05),
    }
}

/// Runs until the tracker is ready, then `settle` ticks more, then measures for five seconds. Ticks of a millisecond.
fn run(case: Case, settle: u32) -> Largest {
    let turns = case.rpm / 60.0;
    let (part, hz) = case.swing;
    let hz = if hz == 0.0 { turns.abs() } else { hz };
    let mut spindle = Swinging::new(case.counts, case.rpm, (part, hz));
    let mut observer = Observer::new(case.counts, 35, 1000);
    let known = if case.known { hz * 1010.0 } else { 0.0 };
    let mut tracker = Tracker::new(case.counts, 1000, known as u32);
    let mut follower: Option<Follower> = None;
    let mut before = [0.0; 3];
    let mut largest = Largest::default();
    let mut ready = 0;
    for tick in 1_u32.. {
        let t = f64::from(tick) * 1e-3;
        let sample = spindle.sample(t, case.timed);
        let event = observer.tick(sample);
        tracker.tick(&observer.look(sample.edge_age_ns), event.is_some());
        let now = tracker.predict(Ticks::ONE.raw());
        if follower.is_none() && tracker.is_ready() {
            let pole = tracker.pole_of_follower();
            let mut new = Follower::new(limits(turns), pole);
            new.begin(&now.learned);
            follower = Some(new);
            ready = tick;
        }
        assert!(tick < 200_000, "{case:?} is never ready");
        let Some(follower) = &mut follower else {
            continue;
        };
        let shown = now.angle as f64 + follower.tick(&now.learned) as f64 / 65536.0;
        let shown = shown / UNIT * LEAD_UM;
        if tick > ready + 3 {
            let [a, b, c] = before;
            let acceleration = (shown - 2.0 * c + b).abs();
            let jerk = (shown - 3.0 * c + 3.0 * b - a).abs() * 1e3;
            largest.acceleration = largest.acceleration.max(acceleration);
            largest.jerk = largest.jerk.max(jerk);
        }
        if tick > ready + settle {
            let beside = (shown - spindle.at(t + 1e-3) * LEAD_UM).abs();
            largest.beside = largest.beside.max(beside);
        }
        before = [before[1], before[2], shown];
        if tick > ready + settle + 5_000 {
            break;
        }
    }
    largest
}

/// What no fraction of a micrometre takes away: the axis keeps its limits whatever the encoder says.
fn keeps_limits(case: &Case, largest: &Largest) {
    assert!(
        largest.acceleration < 2.001 && largest.jerk < 60.1,
        "{case:?}: {largest:?}"
    );
}

#[test]
fn timed_edges_of_few_counts_are_good_to_a_tenth_of_a_micrometre_once_swings_are_learned() {
    // Off round speeds, and no swing beside an order of the turn.
    for counts in [16, 60, 100, 255] {
        for rpm in [101.0, 304.0, -608.0] {
            for (swing, known) in [
                ((0.0, 5.0), false),
                ((0.1, 0.0), false),
                ((0.1, 3.7), true),
                ((0.05, 13.3), true),
            ] {
                let case = Case {
                    counts,
                    timed: true,
                    rpm,
                    swing,
                    known,
                };
                // Four looks in a period are needed.
                if swing.1 * 4.5 > f64::from(counts) * rpm.abs() / 60.0 {
                    continue;
                }
                let largest = run(case, 30_000);
                keeps_limits(&case, &largest);
                assert!(largest.beside < 0.15, "{case:?}: {largest:?}");
            }
        }
    }
}

#[test]
fn edges_without_times_leave_no_more_than_is_said() {
    for counts in [16, 60, 100, 360, 1000] {
        for rpm in [30.4, 101.0, 304.0, 608.0] {
            for (swing, known) in [((0.0, 5.0), false), ((0.1, 0.0), false), ((0.1, 3.7), true)] {
                let case = Case {
                    counts,
                    timed: false,
                    rpm,
                    swing,
                    known,
                };
                if swing.1 * 4.5 > f64::from(counts) * rpm / 60.0 {
                    continue;
                }
                let largest = run(case, 20_000);
                keeps_limits(&case, &largest);
                let resolution = Resolution {
                    counts,
                    timed: false,
                    swing_known: known,
                    bandwidth_hz: 35,
                    tick_us: 1000,
                };
                let lead = crate::units::Lead::new(6_000_000, 1).unwrap();
                let rpm = crate::units::Rpm::new(rpm as i32);
                let said = resolution.uncertainty(lead, rpm).unwrap().nm() as f64 * 1e-3;
                assert!(
                    largest.beside < said + 0.5,
                    "{case:?}: {largest:?} of {said} µm"
                );
            }
        }
    }
}

/// What a judge of the cut needs: the way of the angle since the sample, from the differences at a later instant.
#[test]
fn the_way_since_the_sample_is_known_from_the_differences() {
    let mut spindle = Swinging::new(60, 304.0, (0.1, 3.7));
    let mut observer = Observer::new(60, 35, 1000);
    let mut tracker = Tracker::new(60, 1000, 3700);
    for tick in 1..30_000 {
        let sample = spindle.sample(f64::from(tick) * 1e-3, true);
        let event = observer.tick(sample);
        tracker.tick(&observer.look(sample.edge_age_ns), event.is_some());
        if tick < 20_000 {
            continue;
        }
        let [now, then] = [0, 7 << 15].map(|ahead| tracker.predict(ahead));
        let (way, before) = (then.angle - now.angle, then.angle - then.before());
        // A nanometre of a lead of 6 mm.
        let near = |a: i64, b: i64| ((a - b) as f64 / UNIT * LEAD_UM).abs() < 1e-3;
        assert!(near(then.grown(7 << 15), way), "{tick}: {way}");
        assert!(near(then.grown(1 << 16), before), "{tick}: {before}");
    }
}

/// A fixed stream of 64-bit numbers (SplitMix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % end
    }
}

/// Random targets, far beyond anything that a spindle does: the limits hold in every difference.
#[test]
fn a_follower_never_exceeds_its_limits() {
    leadscrew_seed::volume(0x0f01_10e5, |seed| {
        let mut random = Random(seed);
        let mut ticks = 0_u64;
        while ticks < leadscrew_seed::amount(400_000, 12_000_000) as u64 {
            let acceleration = 1_i64 << (16 + random.below(28));
            let limits = Limits {
                speed: (1 << 40) + random.below(1 << 47) as i64,
                acceleration,
                // At most the whole acceleration in two ticks.
                jerk: (acceleration >> (1 + random.below(10))).max(1),
                beside: 1,
            };
            let pole = 1 << (20 + random.below(11));
            let mut to = Differences::default();
            let mut follower = Follower::new(limits, pole);
            follower.begin(&to);
            let (mut z, mut v, mut a) = (0_i64, 0_i64, 0_i64);
            for _ in 0..2_000 {
                ticks += 1;
                let mut any = |bits: u64| random.below(1 << (bits + 1)) as i64 - (1 << bits);
                match any(4) {
                    0 => to.value += any(50),
                    1 => to.speed = any(46),
                    2 => to.acceleration = any(44),
                    3 => to.jerk = any(44),
                    _ => to.value += to.speed,
                }
                let out = to.value.wrapping_add(follower.tick(&to));
                let speed = out.wrapping_sub(z);
                let now = speed - v;
                let jerk = now - a;
                assert!(
                    speed.abs() <= limits.speed
                        && now.abs() <= acceleration
                        && jerk.abs() <= limits.jerk,
                    "seed {seed}: {limits:?} {pole}: {speed} {now} {jerk}"
                );
                (z, v, a) = (out, speed, now);
            }
        }
    });
}
