//! Clocks that are apart, a bus that delays, and what the lock makes of them.

#![allow(clippy::arithmetic_side_effects, clippy::indexing_slicing)]

extern crate std;

use std::collections::VecDeque;

use super::*;

/// Picoseconds of a step.
const STEP: i64 = 1_000_000;
/// Steps from the beginning of a SYNC on the wire to where it can be read.
const FRAME: i64 = 60;
/// What a SYNC waits for at most: the longest frame at 1 Mbit/s.
const LONGEST: u64 = 135 * 1_000_000;

/// Random numbers (xorshift).
struct Random(u64);

impl Random {
    fn of(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) % limit
    }
}

/// By how many picoseconds the wire makes a SYNC late.
type Jitter = fn(&mut Random, i64) -> u64;

fn none(_: &mut Random, _: i64) -> u64 {
    0
}

fn half(random: &mut Random, _: i64) -> u64 {
    let busy = random.below(2);
    busy * random.below(LONGEST + 1)
}

fn uniform(random: &mut Random, _: i64) -> u64 {
    random.below(LONGEST + 1)
}

/// In 400 periods of every 5000 all are as late as they can be.
fn bursts(random: &mut Random, sync: i64) -> u64 {
    if sync % 5000 < 400 {
        LONGEST
    } else {
        uniform(random, sync)
    }
}

/// Somebody who gives the beat, the wire, and a timer that is led.
struct Wire {
    random: Random,
    jitter: Jitter,
    /// Thousandths of all SYNCs that are lost, and that come twice.
    lost: u64,
    doubled: u64,
    /// Theirs: the period, the instant of the next SYNC, and how many there were; in picoseconds of the own clock.
    period: i64,
    next: i64,
    sent: i64,
    /// On the wire: when it began, in steps, and its counter.
    wire: VecDeque<(i64, u8)>,
    lock: SyncLock,
    /// The own beat, in steps, and the two lengths that are set already.
    beat: i64,
    lengths: [i64; 2],
}

/// A quotient rounded up.
fn up(a: i64, b: i64) -> i64 {
    (a + b - 1) / b
}

/// What a beat was like.
struct Beat {
    heard: SyncHeard,
    /// Picoseconds behind the SYNC that was meant next to it.
    error: i64,
    /// The period set, against the nominal one.
    longer: i64,
}

impl Wire {
    /// Their clock is faster by `ppm`; their first SYNC comes `phase` steps behind an own beat.
    fn new(nominal: u16, ppm: i64, phase: i64, jitter: Jitter, seed: u64) -> Self {
        let steps = i64::from(nominal);
        Self {
            random: Random::of(seed),
            jitter,
            lost: 0,
            doubled: 0,
            period: steps * (STEP - ppm),
            next: phase * STEP,
            sent: 0,
            wire: VecDeque::new(),
            lock: SyncLock::new(nominal),
            beat: 0,
            lengths: [steps; 2],
        }
    }

    fn period(&mut self) -> Beat {
        let [now, next] = self.lengths;
        let end = self.beat + now;
        while self.next < end * STEP {
            let late = (self.jitter)(&mut self.random, self.sent);
            let began = (self.next + i64::try_from(late).unwrap()) / STEP;
            let counter = u8::try_from(self.sent % 240 + 1).unwrap();
            let lost = self.random.below(1000) < self.lost;
            let doubled = self.random.below(1000) < self.doubled;
            for _ in 0..u8::from(!lost) * (1 + u8::from(doubled)) {
                self.wire.push_back((began, counter));
            }
            self.sent += 1;
            self.next += self.period;
        }
        while let Some((began, counter)) = self.wire.front().copied()
            && began + FRAME <= end
        {
            self.wire.pop_front();
            let since = i32::try_from(began - self.beat).unwrap();
            self.lock.hear(since, Some(counter));
        }
        let heard = self.lock.beat();
        self.beat = end;
        self.lengths = [next, self.lock.next_steps().into()];
        let behind = self.beat * STEP - self.next;
        let error = (behind + self.period / 2).rem_euclid(self.period) - self.period / 2;
        Beat {
            heard,
            error,
            longer: self.lengths[1] - i64::from(self.lock.nominal_steps()),
        }
    }

    /// Periods until it was locked.
    fn pull_in(&mut self) -> u32 {
        let most = up(33 * i64::from(self.lock.nominal_steps()), 2048);
        (1..=2_500)
            .find(|_| {
                let beat = self.period();
                assert!(beat.longer.abs() <= most);
                beat.heard.locked
            })
            .expect("it locks")
    }

    /// So many periods while it is locked: the least and the greatest error in nanoseconds.
    fn follow(&mut self, periods: u32) -> (i64, i64) {
        let bound = up(9 * i64::from(self.lock.nominal_steps()), 16_384);
        let mut errors = (i64::MAX, i64::MIN);
        for _ in 0..periods {
            let beat = self.period();
            assert!(beat.heard.locked);
            assert!(beat.longer.abs() <= bound, "{}", beat.longer);
            errors = (errors.0.min(beat.error), errors.1.max(beat.error));
        }
        (errors.0 / 1000, errors.1 / 1000)
    }
}

/// Locks from everywhere, and follows for so many periods: the longest pull-in, the least and the greatest error.
fn everywhere(nominal: u16, jitter: Jitter, periods: u32) -> (u32, i64, i64) {
    let mut worst = (0, i64::MAX, i64::MIN);
    for ppm in [-200, -100, 0, 100, 200] {
        for phase in [0, 100, 300, 499, 500, 501, 700, 950] {
            for lost in [0, 100] {
                let seed = 7 + u64::try_from(phase + 300 + ppm).unwrap();
                let steps = phase * i64::from(nominal) / 1000;
                let mut wire = Wire::new(nominal, ppm, steps, jitter, seed);
                wire.lost = lost;
                let pulled = wire.pull_in();
                let (least, most) = wire.follow(periods);
                worst = (worst.0.max(pulled), worst.1.min(least), worst.2.max(most));
            }
        }
    }
    worst
}

#[test]
fn from_any_phase_it_locks_and_keeps_to_the_early_edge() {
    // The longest pull-in in periods, and the errors in nanoseconds; 80 runs each.
    assert_eq!(everywhere(1_000, none, 15_000), (769, -2_100, 2_000));
    assert_eq!(everywhere(1_000, half, 15_000), (817, -3_100, 2_000));
    assert_eq!(everywhere(1_000, uniform, 15_000), (1_361, -3_400, 6_800));
    assert_eq!(everywhere(1_000, bursts, 15_000), (1_481, -4_200, 12_000));
    // What two whole boards on a wire have.
    assert_eq!(everywhere(2_000, none, 15_000), (769, -2_600, 3_800));
    assert_eq!(everywhere(2_000, half, 15_000), (817, -6_600, 3_200));
    assert_eq!(everywhere(2_000, uniform, 15_000), (953, -8_200, 10_400));
    assert_eq!(everywhere(2_000, bursts, 15_000), (1_305, -6_400, 22_200));
    // Bursts are longer here too.
    assert_eq!(everywhere(4_000, bursts, 15_000), (1_249, -11_400, 42_000));
    assert_eq!(everywhere(10_000, bursts, 15_000), (1_169, -28_000, 92_000));
}

#[test]
fn a_million_periods() {
    let mut wire = Wire::new(1000, 137, 611, uniform, 5);
    (wire.lost, wire.doubled) = (20, 20);
    wire.pull_in();
    // Clocks that become warm: 1 ppm in 20 s, 25 one way and back.
    let mut errors = (i64::MAX, i64::MIN);
    for second in 0..1000_i64 {
        wire.period = 1000 * STEP - 137_000 - (500 - (second - 500).abs()) * 50;
        let (least, most) = wire.follow(1000);
        errors = (errors.0.min(least), errors.1.max(most));
    }
    assert_eq!(errors, (-2_313, 7_610));
}

#[test]
fn at_other_periods() {
    for (nominal, pulled, errors) in [
        (500, 481, (-2_100, 100)),
        (2_000, 609, (-2_000, 1_600)),
        (4_000, 641, (-1_800, 3_800)),
        (10_000, 649, (0, 11_000)),
    ] {
        let mut wire = Wire::new(nominal, -200, i64::from(nominal) * 2 / 5, half, 3);
        assert_eq!(wire.pull_in(), pulled, "{nominal}");
        assert_eq!(wire.follow(50_000), errors, "{nominal}");
    }
}

#[test]
fn every_sync_belongs_to_one_beat() {
    for jitter in [none, half, uniform] {
        let mut wire = Wire::new(1000, 60, 430, jitter, 11);
        wire.pull_in();
        for _ in 0..50_000 {
            let heard = wire.period().heard;
            assert_eq!((heard.count, heard.missed), (1, 0));
        }
    }
    // One is lost: it is missing at its beat, and by the counter of the next. One comes twice.
    for (lost, doubled, expected) in [
        (1000, 0, [(0, 0), (1, 1), (1, 0)]),
        (0, 1000, [(2, 239), (1, 0), (1, 0)]),
    ] {
        let mut wire = Wire::new(1000, 60, 430, half, 11);
        wire.pull_in();
        let sent = wire.sent;
        (wire.lost, wire.doubled) = (lost, doubled);
        let mut heard = std::vec::Vec::new();
        for _ in 0..8 {
            let beat = wire.period().heard;
            heard.push((beat.count, beat.missed));
            if wire.sent > sent {
                (wire.lost, wire.doubled) = (0, 0);
            }
        }
        let as_ever = heard.iter().take_while(|heard| **heard == (1, 0)).count();
        assert!(as_ever <= 2);
        assert_eq!(heard[as_ever..][..3], expected);
        assert_eq!(heard[as_ever + 3..], [(1, 0); 5][as_ever..]);
    }
}

#[test]
fn without_sync_it_goes_on_at_its_rate_and_gives_up() {
    let mut wire = Wire::new(1000, 150, 0, half, 2);
    wire.pull_in();
    wire.follow(5_000);
    wire.lost = 1000;
    assert_eq!(wire.follow(128), (-1_750, -250));
    let rest = (1..)
        .find(|_| !wire.period().heard.locked)
        .expect("it gives up");
    assert!(rest <= 64, "{rest}");
    // Back again.
    wire.lost = 0;
    assert_eq!(wire.pull_in(), 440);
    // At once, where who leads the timer says so; the rate stays.
    wire.lost = 1000;
    wire.lock.forget();
    assert!(!wire.period().heard.locked);
    wire.lost = 0;
    assert_eq!(wire.pull_in(), 439);
}

#[test]
fn a_wrong_period_is_none_to_lock_to() {
    // A per cent off.
    for ppm in [-10_000, 10_000] {
        let mut wire = Wire::new(1000, ppm, 0, none, 1);
        for _ in 0..100_000 {
            assert!(!wire.period().heard.locked);
        }
    }
    // Every second one is missing, which is for who counts them; or one too many.
    for (period, counts) in [(2000, [0, 1]), (500, [2, 2])] {
        let mut wire = Wire::new(1000, 0, 0, none, 1);
        wire.period = period * STEP;
        for _ in 0..1_000 {
            wire.period();
        }
        let mut heard = [(); 2].map(|()| wire.period().heard.count);
        heard.sort_unstable();
        assert_eq!(heard, counts);
        assert_eq!(wire.period().heard.locked, period == 2000);
    }
}

#[test]
fn a_phase_that_jumps_is_not_followed_but_given_up() {
    // Late by so much may be the wire, for a while.
    for (jump, windows) in [(300, 2), (-300, 2), (100, 8), (-100, 2)] {
        let mut wire = Wire::new(1000, 40, 0, half, 4);
        wire.pull_in();
        wire.follow(2_000);
        wire.next += jump * STEP;
        let before = wire.period().error;
        // No jump of its own: until then it stays about where it was. And each SYNC is that of its own beat, early or late.
        let (mut periods, mut error) = (0, before);
        loop {
            let beat = wire.period();
            assert_eq!((beat.heard.count, beat.heard.missed), (1, 0), "{jump}");
            if !beat.heard.locked {
                break;
            }
            (periods, error) = (periods + 1, beat.error);
        }
        let least = 64 * (windows - 1);
        assert!(
            (least..=least + 128).contains(&periods),
            "{jump}: {periods}"
        );
        let moved = error - before;
        assert!(moved.abs() < 7 * windows * STEP, "{jump}: {moved}");
        assert!(wire.pull_in() < 1_100);
    }
}

#[test]
fn whatever_comes_a_period_is_within_its_bounds() {
    leadscrew_seed::volume(1, |seed| {
        let mut random = Random::of(seed);
        for nominal in [0, 1, 2, 3, 63, 250, 1_000, 10_000, 65_535] {
            let mut lock = SyncLock::new(nominal);
            let steps = i64::from(nominal);
            for _ in 0..50_000 {
                for _ in 0..random.below(4) {
                    let since = match random.below(4) {
                        0 => i64::from(i32::MIN) + random.below(1 << 32) as i64,
                        1 => random.below(65_536) as i64 - 32_768,
                        2 => random.below(steps.unsigned_abs() + 1) as i64,
                        _ => random.below(20) as i64 - 10,
                    };
                    let counter = random.below(300);
                    lock.hear(since as i32, u8::try_from(counter).ok());
                }
                lock.beat();
                let longer = i64::from(lock.next_steps()) - steps;
                assert!(longer.abs() <= up(33 * steps, 2048), "{longer}");
            }
        }
    });
}
