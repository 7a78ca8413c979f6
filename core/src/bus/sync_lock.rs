//! The lock of a board's own timer to the SYNC of another one.
//!
//! A board that follows does not tick when SYNC comes: a frame on the wire is not stopped, SYNC waits for its end, and an
//! encoder sampled with that jitter has its thread up to 13 µm out of place (135 µs, lead 2 mm, 3000 rpm). So its tick stays
//! with its timer, and the timer is led to the *early edge* of the SYNCs, for a wire can only make them late [D167].
//!
//! ```text
//! SYNC as it is meant  │         │         │         │           the early edge, which nobody sees
//! SYNC on the wire     █         │ █       █         │  █        later by what the wire was busy with
//! own beats            ╵         ╵         ╵         ╵           the length of the next period but one is what is set
//! ```
//!
//! How: of the SYNCs in a window of periods the one that came earliest, seen from the own beat next to it, is the error. Half of
//! it is made good over the next window, and a part of it goes to the rate. Windows begin short (8 periods), to pull in,
//! and end long (64), to rest. Lengths are whole steps of the timer; what makes no step yet is carried.
//!
//! What it guarantees, whatever comes in:
//! - a period is within 1/64 and 1/2048 of its nominal length, to a step: there is no jump, not even while it pulls in;
//! - while it is locked, the rate is within 1/2048 (488 ppm) of the nominal one, and a phase is made good by no more than
//!   1/16 384 of a period (61 ppm) in each where SYNC is early, by a quarter of that where it is late; a SYNC that is more than a
//!   quarter of a period away moves nothing, one that is late among others neither, and without any it goes on at its rate;
//! - it is locked behind six long windows in a row that were at most 1/128 of a period off. It is no more behind two in a row
//!   (128 periods) in which none was near, or the earliest came early by more than 1/16; behind eight in which it was late by as
//!   much, which the wire can do for a while; and where its owner [forgets](SyncLock::forget);
//! - a SYNC that begins in the half of a period before a beat, or in the half behind it, counts for that beat.
//!
//! What it reaches in steps of 1 µs, clocks up to 200 ppm apart, from any phase (tests below): locked after 440 to 1 480 periods,
//! and from then on its beats within 7 µs of the early edge at a period of 1 ms, 11 µs at 2 ms, with SYNC late by anything up to
//! 135 µs, every tenth missing; that is 1.1 µm of a thread of 2 mm at 3000 rpm. Bursts in which every SYNC of 400 periods is
//! 135 µs late move it by 12 µs at 1 ms, 23 µs at 2 ms, 92 µs at 10 ms.
//!
//! What it cannot know: a wire on which no SYNC of 64 periods is in time has an edge that is later. What delays each one for
//! seconds is followed slowly, and where it then ends, SYNC is early for all the lock knows.
//!
//! Knows no timer and no frame; stamps go in, lengths come out. No division.

use super::sync::{SyncConsumer, SyncHeard};

/// Windows are of 2³ to 2⁶ periods.
const SHORT: u32 = 3;
const LONGER: u32 = 3;
/// So many long windows in a row that are right begin the lock, and so many that are far off end it.
const PROOF: i32 = 6;
const PATIENCE: i32 = -8;
/// For so many of them counts one whose SYNC cannot be late by the wire.
const OTHER: i32 = 4;
/// Bits of a fraction of a step.
const FRACTION: u32 = 14;
/// Steps behind its beat that no SYNC near it can be: half a period is less.
const LATEST: i32 = 1 << 15;

/// Leads a timer to the SYNCs of somebody else.
// All zero where nothing has come: of one in a static there is nothing in the flash of a chip.
#[derive(Clone, Copy, Debug)]
pub struct SyncLock {
    /// Steps of a nominal period, of the one under way, and of the one behind it.
    nominal: i32,
    running: i32,
    next: i32,
    /// What is to be added to each period, in 1/16 384 of a step: for the rate, and for the phase; and what of both has not
    /// made a step yet.
    rate: i32,
    slew: i32,
    rest: i32,
    /// Of those near their beat in this window the SYNC that came earliest, in steps before the [`LATEST`] there can be; zero
    /// where there was none.
    earliest: i32,
    /// Periods of this window so far.
    at: u32,
    /// How much longer than short a window is, as a power of two.
    longer: u32,
    /// Long windows in a row that were right; below zero, windows that were far off.
    right: i32,
    locked: bool,
    consumer: SyncConsumer,
    /// SYNCs of the last beat and of the one to come, and what was missing before those since the last beat.
    count: u8,
    early: u8,
    missed: u8,
}

impl SyncLock {
    /// For nominal periods of so many steps of the timer; it runs freely at first.
    #[must_use]
    pub const fn new(nominal_steps: u16) -> Self {
        let nominal = nominal_steps as i32;
        Self {
            nominal,
            running: nominal,
            next: nominal,
            rate: 0,
            slew: 0,
            rest: 0,
            earliest: 0,
            at: 0,
            longer: 0,
            right: 0,
            locked: false,
            consumer: SyncConsumer::new(),
            count: 0,
            early: 0,
            missed: 0,
        }
    }

    /// A SYNC that has been read began so many steps behind the last own beat, or before it. Before half a period it counts for
    /// that beat, from there on for the next.
    pub fn hear(&mut self, since_steps: i32, counter: Option<u8>) {
        let half = self.nominal >> 1;
        let (count, offset) = match since_steps < half {
            true => (&mut self.count, since_steps),
            false => (&mut self.early, since_steps.wrapping_sub(self.running)),
        };
        *count = count.saturating_add(1);
        let missed = self.consumer.count(counter).missed;
        self.missed = self.missed.saturating_add(missed);
        let gate = if self.locked { half >> 1 } else { half };
        if (gate.wrapping_neg()..=gate).contains(&offset) {
            self.earliest = self.earliest.max(LATEST.wrapping_sub(offset));
        }
    }

    /// The own beat: all SYNCs heard before it have been given. What the beat before it has brought.
    pub fn beat(&mut self) -> SyncHeard {
        let heard = SyncHeard {
            count: core::mem::replace(&mut self.count, core::mem::take(&mut self.early)),
            missed: core::mem::take(&mut self.missed),
            locked: self.locked,
        };
        self.at = self.at.wrapping_add(1);
        if self.at.wrapping_shr(self.width()) > 0 {
            self.judge();
        }
        self.running = self.next;
        let rest = self.rest.wrapping_add(self.rate).wrapping_add(self.slew);
        self.next = self.nominal.wrapping_add(rest >> FRACTION);
        self.rest = rest & ((1 << FRACTION) - 1);
        heard
    }

    /// The SYNC of the beat that has begun has come already.
    #[must_use]
    pub const fn is_early(&self) -> bool {
        self.count > 0
    }

    /// There was no SYNC for longer than can be borne: the next may have any phase. The lock begins again, at the rate it had.
    pub const fn forget(&mut self) {
        self.longer = 0;
        self.right = 0;
        self.locked = false;
    }

    /// Steps of the nominal period.
    #[must_use]
    pub const fn nominal_steps(&self) -> u16 {
        self.nominal as u16
    }

    /// Steps of the period behind the one that has begun with the last beat.
    #[must_use]
    pub const fn next_steps(&self) -> u32 {
        self.next.cast_unsigned()
    }

    /// Periods of a window as a power of two.
    const fn width(&self) -> u32 {
        self.longer.wrapping_add(SHORT)
    }

    /// The end of a window.
    #[cold]
    #[inline(never)]
    fn judge(&mut self) {
        self.at = 0;
        self.slew = 0;
        let nominal = self.nominal << FRACTION;
        let earliest = core::mem::take(&mut self.earliest);
        let mut error = LATEST.wrapping_sub(earliest) << FRACTION;
        let away = error.wrapping_abs();
        let is_near = earliest > 0 && away <= nominal >> 4;
        if !is_near {
            // Late may be the wire, for a while. Early, or none near, is another beat.
            let is_other = error.cast_unsigned() >= (LATEST << FRACTION).cast_unsigned();
            let far = if is_other { OTHER } else { 1 };
            self.right = self.right.min(0).wrapping_sub(far);
            if !self.locked || self.right <= PATIENCE {
                self.forget();
            }
        } else if away > nominal >> 7 {
            self.right = 0;
        } else if self.longer < LONGER {
            self.longer = self.longer.wrapping_add(1);
        } else {
            self.right = self.right.max(0).wrapping_add(1).min(PROOF);
            self.locked |= self.right == PROOF;
        }
        if earliest == 0 {
            return;
        }
        let mut part = 3;
        let mut most = nominal >> 2;
        if self.locked {
            // Late may be the wire, early is they.
            error = error.min(nominal >> 9);
            most = nominal >> 7;
            part = 4;
        }
        error = within(error, most).wrapping_shr(self.width());
        self.slew = error >> 1;
        if is_near {
            let rate = self.rate.wrapping_add(error >> part);
            self.rate = within(rate, nominal >> 11);
        }
    }
}

/// A value no further from zero than `most`, which is not negative.
fn within(value: i32, most: i32) -> i32 {
    value.min(most).max(most.wrapping_neg())
}

#[cfg(test)]
mod tests {
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
        let mut random = Random::of(1);
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
    }
}
