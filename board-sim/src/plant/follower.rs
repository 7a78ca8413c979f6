//! How a drive's position follows its targets: delayed by a latency, and with a lag.
//!
//! Targets are 32-bit increments for an axis. A spindle in position mode turns without end, so it counts in 64 bits.

use leadscrew_core::bus::Increments;

/// The number of kept targets, a power of two.
const KEPT: usize = 128;

/// Turns latched targets into actual positions, once a SYNC.
#[derive(Clone, Copy, Debug)]
pub struct Follower {
    /// Latched targets; the last is at `newest`.
    targets: [i64; KEPT],
    newest: usize,
    /// Latency: whole SYNC periods, and the rest in 2⁻¹⁶ periods.
    whole: usize,
    part: i64,
    /// The part of the distance that is made up in a SYNC period, in 2⁻¹⁶.
    pull: i64,
    /// Actual position in 2⁻¹⁶ increments.
    actual: i64,
}

impl Follower {
    /// A drive that stands at `at`. It reaches a target `latency_us` after the SYNC that latched it, and moves in a
    /// straight line from one target to the next. It follows with a first-order lag of `lag_ticks` SYNC periods. `None`
    /// for a latency of more than 126 periods or a period of 0.
    #[must_use]
    pub fn new(at: Increments, latency_us: u32, tick_us: u32, lag_ticks: u16) -> Option<Self> {
        let whole = latency_us.checked_div(tick_us)?;
        let rest = latency_us.wrapping_sub(whole.wrapping_mul(tick_us));
        let part = (i64::from(rest) << 16).checked_div(i64::from(tick_us))?;
        let whole = usize::try_from(whole).ok()?;
        if whole.wrapping_add(2) > KEPT {
            return None;
        }
        let pull = (1i64 << 16).checked_div(i64::from(lag_ticks).wrapping_add(1))?;
        Some(Self {
            targets: [i64::from(at.get()); KEPT],
            newest: 0,
            whole,
            part,
            pull,
            actual: i64::from(at.get()) << 16,
        })
    }

    /// A SYNC: takes the latched target and moves.
    pub fn follow(&mut self, target: Increments) {
        self.follow_count(i64::from(target.get()));
    }

    /// The same as [`follow`](Self::follow), for a target that does not wrap.
    pub fn follow_count(&mut self, target: i64) {
        self.newest = self.newest.wrapping_add(1) % KEPT;
        if let Some(slot) = self.targets.get_mut(self.newest) {
            *slot = target;
        }
        let later = self.target_before(self.whole);
        let earlier = self.target_before(self.whole.wrapping_add(1));
        let wanted =
            (later << 16).wrapping_sub(later.wrapping_sub(earlier).wrapping_mul(self.part));
        let way = wanted.wrapping_sub(self.actual);
        // The whole increments and the rest are multiplied apart: the distance may have 48 bits.
        let step = (way >> 16)
            .wrapping_mul(self.pull)
            .wrapping_add((way & 0xFFFF).wrapping_mul(self.pull) >> 16);
        self.actual = self.actual.wrapping_add(step);
    }

    /// Stops at the present position and forgets all targets that wait.
    pub fn stop(&mut self) {
        self.stand_at(self.count());
    }

    /// Stands at `count` and forgets all targets that wait.
    pub fn stand_at(&mut self, count: i64) {
        self.targets = [count; KEPT];
        self.actual = count << 16;
    }

    /// The last target.
    #[must_use]
    pub fn newest(&self) -> i64 {
        self.target_before(0)
    }

    /// The position in 2⁻¹⁶ increments, not wrapped.
    #[must_use]
    pub const fn fine(&self) -> i64 {
        self.actual
    }

    const fn count(&self) -> i64 {
        self.actual.wrapping_add(1 << 15) >> 16
    }

    /// The position, to the nearest increment.
    #[must_use]
    pub const fn actual(&self) -> Increments {
        Increments::new(self.count() as i32)
    }

    fn target_before(&self, syncs: usize) -> i64 {
        let slot = self.newest.wrapping_sub(syncs) % KEPT;
        self.targets.get(slot).copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(mut follower: Follower, targets: &[i32]) -> [i32; 8] {
        let mut out = [0; 8];
        for (slot, target) in out.iter_mut().zip(targets) {
            follower.follow(Increments::new(*target));
            *slot = follower.actual().get();
        }
        out
    }

    #[test]
    fn without_latency_and_lag_it_is_where_it_is_told() {
        let f = Follower::new(Increments::new(5), 0, 1000, 0).unwrap();
        let path = [5, 7, 1000, -2_000_000_000, 2_000_000_000, 0, 1, 2];
        assert_eq!(track(f, &path), path);
    }

    #[test]
    fn latency_delays_in_whole_periods_and_parts_of_them() {
        let ramp = [10, 20, 30, 40, 50, 60, 70, 80];
        let f = |us| Follower::new(Increments::new(0), us, 1000, 0).unwrap();
        assert_eq!(track(f(1000), &ramp), [0, 10, 20, 30, 40, 50, 60, 70]);
        assert_eq!(track(f(2500), &ramp), [0, 0, 5, 15, 25, 35, 45, 55]);
        assert!(Follower::new(Increments::new(0), 126_000, 1000, 0).is_some());
        assert!(Follower::new(Increments::new(0), 127_000, 1000, 0).is_none());
        assert!(Follower::new(Increments::new(0), 0, 0, 0).is_none());
    }

    #[test]
    fn lag_makes_up_its_part_of_the_distance_each_period() {
        let f = Follower::new(Increments::new(0), 0, 1000, 1).unwrap();
        assert_eq!(
            track(f, &[1024; 8]),
            [512, 768, 896, 960, 992, 1008, 1016, 1020]
        );
    }

    #[test]
    fn after_a_stop_nothing_is_left_to_come() {
        let mut f = Follower::new(Increments::new(0), 2000, 1000, 3).unwrap();
        for target in [100, 200, 300, 400] {
            f.follow(Increments::new(target));
        }
        f.stop();
        let at = f.actual();
        for _ in 0..200 {
            f.follow(at);
            assert_eq!(f.actual(), at);
        }
    }
}
