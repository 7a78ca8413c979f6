//! A board that follows the SYNC of another: from stamps to the length of its periods, and when its setpoints may go.
//!
//! A setpoint that overtook the SYNC of its own beat would be latched by it, a period too early. The wire lets SYNC go
//! first only where that waits already, and whoever gives the beat may be late with it. So the frames of a tick wait
//! for its SYNC, unless that has come before the tick. Where none has come for three periods, which is where the board
//! stops, there is none to wait for: from then on they go at once, and when SYNC comes back the drives find what the
//! board says by then, not what it said before [D167].

use leadscrew_core::bus::{SyncHeard, SyncLock};

/// Periods without SYNC for which setpoints wait.
const WAITS: u8 = 3;

/// A timer of 16 bits that is led, and a counter beside it that runs freely in the same steps and stamps what comes.
#[derive(Clone, Copy, Debug)]
pub struct Follower {
    lock: SyncLock,
    /// The counter at the last beat.
    beat: u16,
    /// Periods without SYNC for which the next setpoints wait.
    waits: u8,
}

/// A beat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Beat {
    /// What the period before it has brought.
    pub heard: SyncHeard,
    /// Steps of the period behind the one that begins.
    pub next_steps: u32,
    /// The frames of this tick may go at once, and need not wait for SYNC.
    pub goes: bool,
}

impl Follower {
    /// For nominal periods of so many steps.
    #[must_use]
    pub const fn new(nominal_steps: u16) -> Self {
        Self {
            lock: SyncLock::new(nominal_steps),
            beat: 0,
            waits: 0,
        }
    }

    /// The nominal period is of so many steps from now on, 0 where the board gives the beat itself. Where that is another
    /// length, what is known of the SYNCs is forgotten. False where it gives the beat.
    pub fn follows(&mut self, nominal_steps: u16) -> bool {
        if nominal_steps != self.lock.nominal_steps() {
            *self = Self::new(nominal_steps);
        }
        nominal_steps > 0
    }

    /// A SYNC has come; the counter showed `stamp` when it began, less than 32 768 steps from the last beat.
    pub fn hear(&mut self, stamp: u16, counter: Option<u8>) {
        let since = stamp.wrapping_sub(self.beat).cast_signed();
        self.lock.hear(since.into(), counter);
    }

    /// The timer begins a period, when the counter shows `stamp`. All that came before it has been given.
    pub fn beat(&mut self, stamp: u16) -> Beat {
        self.beat = stamp;
        let heard = self.lock.beat();
        self.waits = match heard.count {
            0 => self.waits.saturating_sub(1),
            _ => WAITS,
        };
        if self.waits == 0 {
            self.lock.forget();
        }
        Beat {
            heard,
            next_steps: self.lock.next_steps(),
            goes: self.waits == 0 || self.lock.is_early(),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    /// Microseconds that frames take: SYNC, a setpoint, the longest one there is.
    const SYNC: u32 = 60;
    const SETPOINT: u32 = 115;
    const LONGEST: u32 = 135;
    /// Microseconds that a tick takes.
    const TICK: u32 = 25;

    #[derive(Clone, Copy, PartialEq, Eq)]
    enum On {
        Sync { began: u32 },
        Setpoint(u32),
        Other,
    }

    /// Somebody who gives the beat, not very punctually; a board that follows with one drive; and a wire on which
    /// others speak as they like. In microseconds.
    struct Shop {
        random: u64,
        /// Setpoints wait for their SYNC.
        gated: bool,
        now: u32,
        /// The wire is taken so long, by what.
        taken: Option<(u32, On)>,
        sync_waits: bool,
        /// So many SYNCs are not sent at all.
        silent: u32,
        /// Their beat, and when its SYNC is to go next.
        base: u32,
        due: u32,
        /// Their next beat comes so much later, or earlier, and with it all behind it.
        jump: i32,
        follower: Follower,
        stamps: Vec<u16>,
        goes: bool,
        locked: bool,
        counts: Vec<u8>,
        ticks: u32,
        /// When the own periods end: this one, and the length of the next.
        end: u32,
        next: u32,
        /// The setpoint of which tick waits, and from when on.
        waits: Option<(u32, u32)>,
        /// In the drive.
        told: u32,
        /// What a SYNC has made count, and the tick it belongs to.
        latched: Vec<(u32, u32)>,
    }

    impl Shop {
        fn new(gated: bool) -> Self {
            Self {
                random: 0x2545_F491_4F6C_DD1D,
                gated,
                now: 0,
                taken: None,
                sync_waits: false,
                silent: 0,
                base: 700,
                due: 700,
                jump: 0,
                follower: Follower::new(1000),
                stamps: Vec::new(),
                goes: true,
                locked: false,
                counts: Vec::new(),
                ticks: 0,
                end: 1000,
                next: 1000,
                waits: None,
                told: 0,
                latched: Vec::new(),
            }
        }

        fn below(&mut self, limit: u64) -> u32 {
            self.random ^= self.random << 13;
            self.random ^= self.random >> 7;
            self.random ^= self.random << 17;
            u32::try_from((self.random >> 16) % limit).unwrap()
        }

        fn tick(&mut self) {
            for stamp in self.stamps.drain(..) {
                self.follower.hear(stamp, None);
            }
            let beat = self.follower.beat(self.now as u16);
            self.goes = beat.goes;
            self.locked = beat.heard.locked;
            self.counts.push(beat.heard.count);
            self.ticks += 1;
            (self.end, self.next) = (self.end + self.next, beat.next_steps);
            // What is left of the tick before is called back.
            self.waits = Some((self.now + TICK, self.ticks));
        }

        fn heard(&mut self, on: On) {
            match on {
                On::Sync { began } => {
                    self.stamps.push(began as u16);
                    self.goes = true;
                    self.latched.push((self.told, self.ticks));
                }
                On::Setpoint(tick) => self.told = tick,
                On::Other => {}
            }
        }

        fn microsecond(&mut self) {
            if self.now == self.end {
                self.tick();
            }
            if self.now == self.due {
                // Up to 90 µs behind its beat, which is 10 ppm slow: a step in a hundred periods.
                let slow = u32::from(self.ticks % 100 == 99);
                self.base = self.base.wrapping_add_signed(self.jump) + 1000 + slow;
                self.jump = 0;
                self.due = self.base + self.below(90);
                self.sync_waits = self.silent == 0;
                self.silent = self.silent.saturating_sub(1);
            }
            if let Some((end, on)) = self.taken
                && end == self.now
            {
                self.taken = None;
                self.heard(on);
            }
            if self.taken.is_none() {
                let goes = self.goes || !self.gated;
                let next = if core::mem::take(&mut self.sync_waits) {
                    Some((SYNC, On::Sync { began: self.now }))
                } else if let Some((from, tick)) = self.waits
                    && from <= self.now
                    && goes
                {
                    self.waits = None;
                    Some((SETPOINT, On::Setpoint(tick)))
                } else if self.below(200) == 0 {
                    Some((LONGEST, On::Other))
                } else {
                    None
                };
                self.taken = next.map(|(takes, on)| (self.now + takes, on));
            }
            self.now += 1;
        }

        fn run(&mut self, ms: u32) {
            for _ in 0..ms * 1000 {
                self.microsecond();
            }
        }

        fn lock(&mut self) {
            for _ in 0..2_500 {
                self.run(1);
                if self.locked {
                    self.latched.clear();
                    self.counts.clear();
                    return;
                }
            }
            panic!("it locks");
        }
    }

    #[test]
    fn each_sync_latches_the_setpoint_of_the_tick_before() {
        let mut shop = Shop::new(true);
        shop.lock();
        shop.run(20_000);
        assert!(shop.locked);
        assert!(shop.counts.iter().all(|count| *count == 1));
        // Their clock is slower by 10 ppm.
        assert_eq!(shop.latched.len(), 19_999);
        for (setpoint, tick) in &shop.latched {
            assert_eq!(setpoint + 1, *tick);
        }
        // Where they do not wait, one in a hundred is latched too early, or twice as much.
        let mut shop = Shop::new(false);
        shop.lock();
        shop.run(20_000);
        let early = shop
            .latched
            .iter()
            .filter(|(setpoint, tick)| setpoint == tick);
        assert!(early.count() > 200);
    }

    #[test]
    fn a_sync_before_its_beat_latches_its_own_setpoint_too() {
        for jump in [-400, -100, -50, 100] {
            let mut shop = Shop::new(true);
            shop.lock();
            shop.run(1_000);
            shop.counts.clear();
            shop.latched.clear();
            shop.jump = jump;
            shop.run(2_000);
            let told: Vec<u32> = shop.latched.iter().map(|(setpoint, _)| *setpoint).collect();
            assert!(told.len() > 1_990);
            assert!(told.is_sorted_by(|one, next| one + 1 == *next), "{jump}");
            assert!(shop.counts.iter().all(|count| *count == 1), "{jump}");
        }
    }

    #[test]
    fn a_beat_that_was_gone_is_locked_to_anew() {
        // It may come back with any phase.
        for (silent, locked) in [(2, true), (3, false)] {
            let mut shop = Shop::new(true);
            shop.lock();
            shop.run(10);
            shop.silent = silent;
            shop.run(20);
            assert_eq!(shop.locked, locked);
        }
        // And while the board gave the beat itself, it was gone.
        let mut shop = Shop::new(true);
        shop.lock();
        assert!(shop.follower.follows(1000));
        shop.run(1);
        assert!(shop.locked);
        assert!(!shop.follower.follows(0));
        assert!(shop.follower.follows(1000));
        shop.run(1);
        assert!(!shop.locked);
    }

    #[test]
    fn without_sync_setpoints_go_after_three_periods() {
        // Where they go ahead, their own SYNC may latch them: no harm, for the
        // board has stopped by then and tells no setpoint.
        for (silent, least, most) in [(1, 2, 2), (2, 3, 3), (4, 0, 1), (20, 0, 1)] {
            let mut shop = Shop::new(true);
            shop.lock();
            shop.run(10);
            let before = shop.latched.len();
            shop.silent = silent;
            shop.run(silent + 10);
            // Those of the first three ticks without SYNC stay here, the next are in the drive before it comes.
            let mut latched = shop.latched[before..]
                .iter()
                .skip_while(|(setpoint, tick)| setpoint + 1 == *tick && *tick < shop.ticks - 11);
            let (setpoint, tick) = latched.next().unwrap();
            assert!((least..=most).contains(&(tick - setpoint)), "{silent}");
            for (setpoint, tick) in latched {
                assert_eq!(setpoint + 1, *tick, "{silent}");
            }
        }
    }
}
