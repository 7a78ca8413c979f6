//! The jerk-limited profile: two running means over a path rate.
//!
//! This module knows lengths, speeds and ticks. It knows nothing of axes, paths or planning, nor why the operator asks
//! for a rate.
//!
//! # The filter
//!
//! The input `u(t)` is a path rate that never exceeds the cap `v`. The sum of all inputs is the length of the move. The
//! input passes a running mean over n1 ticks and then a running mean over n2 ticks; the result is the speed. With
//!
//! ```text
//! K(t) = u(t) − u(t−n1) − u(t−n2) + u(t−n1−n2),   A += K,   V += A,   s += V / (n1·n2)
//! ```
//!
//! speed is V/(n1·n2), acceleration A/(n1·n2), jerk K/(n1·n2). From 0 ≤ u ≤ v follow V ≤ n1·n2·v and |A| ≤ n2·v. If
//! also |K| ≤ v, speed is within v, acceleration within v/n1 and jerk within v/(n1·n2), whatever the input does. A mean
//! loses nothing: the division carries its remainder, so the output ends exactly where the input ends. A constant pulse
//! of n1 + n2 ticks or more comes out as the time-optimal ramp, cruise, ramp.
//!
//! # The governor
//!
//! Override, feed hold and a feed that follows the spindle change the wanted rate `w` from tick to tick in any way. The
//! governor turns this wanted rate into the input. N = n1 + n2. R is the length that has not been put in yet. L is the
//! level: the input that the governor aims for, zero at the start. Each tick, with c = u(t−n1) + u(t−n2) − u(t−N):
//!
//! 1. The input must be within lo = max(0, c − v) and hi = min(v, c + v), that is |K| ≤ v. Since −v ≤ c ≤ 2v, such an
//!    input always exists.
//! 2. The level falls at once, to w or hi. The level rises to at most R/N, and only if R/N is at least M, the largest
//!    input of the last N ticks.
//! 3. The input is the level, or lo if lo is higher (a "forced" input), or R if R is lower (the end).
//!
//! With these rules the input can always end: lo ≤ R always, and lo = 0 from the tick on in which R is spent. The
//! proof:
//!
//! - A forced input is x + y − z − v of three older inputs, so it is at most the smaller of x and y. A forced input
//!   forces no other input: if x is a forced input made of x', y', z', then z = y', and x + y − z − v
//!   = (x' − v) + (y − v) − z' ≤ 0; the same holds for y.
//! - Let t0 be the tick of the level's last rise, and let M count that rise too. All inputs from t0 on are at most M:
//!   levels by rule 2, forced inputs by the point above. R(t0) ≥ M·N, so at t0 + i at least M·(N − i) is left. This is
//!   enough for every lo before t0 + N.
//! - From t0 + N on, x, y and z are all younger than t0, and since t0 the level only falls. x and y are levels, not
//!   forced; z is the oldest, so z ≥ x and lo ≤ y − v ≤ 0. No input is forced any more, in particular not after the
//!   end.
//! - If less than N units (of 1/256 nm) are left, the level is one unit, and only from rest. K is then at most two
//!   units, and the cap is never less.
//!
//! The profile cannot get stuck. At level zero the filter drains; at rest M is zero; and from rest every remaining
//! length has a level. The code keeps M as the maxima of two stretches of N ticks, so M may remember up to 2·N ticks.
//! This only delays a rise.
//!
//! # Without the governor
//!
//! A motion that is [begun open](Profile::begin_open) gets its input from outside, any input from 0 to v in any tick. Then
//! only |K| ≤ 2·v holds: the speed is within v, the acceleration within v/n1, and the jerk within 2·v/(n1·n2). The ramp of
//! such a motion has to be long enough for that. No length has to be known ahead, so further pieces may come at any time.
//!
//! Its input may also be [of either sign](Profile::put_in_signed), from −v to v. Then |K| ≤ 4·v and |A| ≤ 2·n2·v: the
//! speed is within v, the acceleration within 2·v/n1, and the jerk within 4·v/(n1·n2). It turns round without a stop.

use super::rate::{PathRate, Rate, Travel};
use crate::units::{Divisor, Length};

/// The number of ticks that a machine's profile can look back: the longest ramp n1 + n2.
pub const CAPACITY: u16 = 2048;

/// The two means of a motion and the largest rate for which they are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ramp {
    cap: PathRate,
    n1: u16,
    n2: u16,
    area: Divisor,
    ticks: Divisor,
}

impl Ramp {
    /// A ramp of `n1` + `n2` ticks to the rate `cap`. Speed then stays within cap, acceleration within cap/n1 and jerk
    /// within cap/(n1·n2), per tick. `None` if a mean has no ticks, if the two means together have more than
    /// [`CAPACITY`] ticks, or if `cap` is less than two units (1/128 nm per tick).
    #[must_use]
    pub const fn new(cap: PathRate, n1: u16, n2: u16) -> Option<Self> {
        let ticks = (n1 as u32).wrapping_add(n2 as u32);
        if n1 == 0 || n2 == 0 || ticks > CAPACITY as u32 || cap.raw() < 2 {
            return None;
        }
        Some(Self {
            cap,
            n1,
            n2,
            // At most 2²⁰.
            area: Divisor::new((n1 as u32).wrapping_mul(n2 as u32)),
            ticks: Divisor::new(ticks),
        })
    }

    /// The largest rate.
    #[must_use]
    pub const fn cap(&self) -> PathRate {
        self.cap
    }

    /// Ticks of the two means.
    #[must_use]
    pub const fn means(&self) -> (u16, u16) {
        (self.n1, self.n2)
    }

    /// Ticks from standing to the full rate.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        self.ticks.get()
    }
}

/// The state of a motion after a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Distance from the start of the motion.
    pub travel: Travel,
    /// True when the motion stands and nothing is left to do: at its end, or where it was abandoned.
    pub done: bool,
}

/// A long-lived profile. Most of it is the ring of the last `N` inputs, 4 bytes each: 8 KiB for the path of a machine. `N`
/// is a power of two, and the longest ramp in ticks.
#[derive(Clone, Debug)]
pub struct Profile<const N: usize = { CAPACITY as usize }> {
    /// R: the length that has not been put in yet, in 1/256 nm.
    left: u64,
    /// A.
    accel: i64,
    /// V, never negative.
    speed: i64,
    travel: u64,
    ramp: Ramp,
    remainder: u32,
    nominal: PathRate,
    /// L.
    level: u32,
    /// M is the larger of the two peaks.
    peak: u32,
    older_peak: u32,
    peak_ticks: u16,
    /// Number of inputs since the start of this motion, up to the capacity. Older inputs in the ring belong to another
    /// motion and count as zero.
    filled: u16,
    abandoned: bool,
    /// Slot of the next input.
    head: usize,
    ring: [u32; N],
}

impl<const N: usize> Default for Profile<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Profile<N> {
    const MASK: usize = {
        assert!(N.is_power_of_two() && N <= CAPACITY as usize);
        N.wrapping_sub(1)
    };

    /// A profile at rest with nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            ring: [0; N],
            head: 0,
            filled: 0,
            ramp: Ramp {
                cap: PathRate::from_raw(2),
                n1: 1,
                n2: 1,
                area: Divisor::new(1),
                ticks: Divisor::new(2),
            },
            nominal: PathRate::ZERO,
            left: 0,
            level: 0,
            peak: 0,
            older_peak: 0,
            peak_ticks: 0,
            accel: 0,
            speed: 0,
            travel: 0,
            remainder: 0,
            abandoned: true,
        }
    }

    /// Puts the profile at rest with nothing to do, like [`new`](Self::new). The contents of the ring no longer count.
    pub const fn begin_anew(&mut self) {
        self.filled = 0;
        self.left = 0;
        self.level = 0;
        (self.accel, self.speed) = (0, 0);
        self.forget_peaks();
        self.abandoned = true;
    }

    /// Starts a motion of `length` from rest. At [`Rate::FULL`] its rate is `nominal`, or the ramp's cap if that is
    /// less. Returns false and changes nothing while the last motion is not done, or for a ramp of more than `N` ticks.
    #[must_use]
    pub const fn begin(&mut self, length: Length, nominal: PathRate, ramp: Ramp) -> bool {
        if !self.at_rest() || self.left != 0 || ramp.ticks() > N as u32 {
            return false;
        }
        self.filled = 0;
        self.ramp = ramp;
        self.nominal = nominal;
        self.left = to_units(length);
        self.level = 0;
        self.forget_peaks();
        self.travel = 0;
        self.remainder = 0;
        self.abandoned = false;
        true
    }

    /// Starts a motion from rest that gets its input by [`put_in`](Self::put_in). Returns false and changes nothing while
    /// the last motion is not done.
    #[must_use]
    pub(super) const fn begin_open(&mut self, ramp: Ramp) -> bool {
        self.begin(Length::ZERO, PathRate::ZERO, ramp)
    }

    /// One tick of an open motion with this input, at most the cap. Returns the distance from the start of the motion.
    pub(super) fn put_in(&mut self, input: PathRate) -> Travel {
        let older = self.older();
        let input = input.raw().min(self.ramp.cap.raw());
        self.store(input);
        self.advance(input, older)
    }

    /// One tick of an open motion with an input of either sign, in 1/256 nm and within the cap, which is at most
    /// `i32::MAX`. Returns the way from the start of the motion, with its sign, in 2⁻¹⁶ nm. Such a motion takes no other
    /// input.
    pub(super) fn put_in_signed(&mut self, input: i32) -> i64 {
        let (n1, n2) = (self.ramp.n1, self.ramp.n2);
        let [first, second, both] =
            [n1, n2, n1.wrapping_add(n2)].map(|ticks| i64::from(self.past(ticks) as i32));
        let older = first.wrapping_add(second).wrapping_sub(both);
        self.store(input as u32);
        self.accel = self
            .accel
            .wrapping_add(i64::from(input))
            .wrapping_sub(older);
        self.speed = self.speed.wrapping_add(self.accel);
        // The division is of numbers without sign: the cap is added before it, and taken away behind it.
        let cap = i64::from(self.ramp.cap.raw());
        let area = i64::from(self.ramp.area.get());
        let raised = self.speed.wrapping_add(area.wrapping_mul(cap));
        let dividend = ((raised as u64) << 8).wrapping_add(u64::from(self.remainder));
        let (step, remainder) = self.ramp.area.divide(dividend);
        self.travel = self
            .travel
            .wrapping_add(step)
            .wrapping_sub((cap as u64) << 8);
        self.remainder = remainder;
        self.travel as i64
    }

    /// Ticks of both means of this motion: so long after the last input it stands.
    pub(super) const fn ticks_of_ramp(&self) -> u32 {
        self.ramp.ticks()
    }

    /// Gives up the rest of the motion. The motion stops as on a feed hold and is then done, wherever it stands. The
    /// rest cannot be resumed.
    pub const fn abandon(&mut self) {
        self.abandoned = true;
        if self.at_rest() {
            self.left = 0;
        }
    }

    /// True while nothing moves and the means hold nothing that still has to come out: speed and acceleration are zero.
    #[must_use]
    pub const fn at_rest(&self) -> bool {
        self.speed == 0 && self.accel == 0
    }

    /// The length that has not entered the means yet, rounded down.
    #[must_use]
    pub const fn remaining(&self) -> Length {
        Length::from_nm((self.left >> 8) as i64)
    }

    /// Speed of the last tick.
    #[must_use]
    pub const fn speed(&self) -> PathRate {
        // V is at most n1·n2·cap, so the quotient fits.
        PathRate::from_raw(self.ramp.area.divide(self.speed as u64).0 as u32)
    }

    /// Makes a motion that ends by itself longer. False where there is none, or where it was abandoned.
    pub(super) fn extend(&mut self, more: Length) -> bool {
        if self.abandoned || self.left == 0 && self.at_rest() {
            return false;
        }
        self.left = self.left.saturating_add(to_units(more));
        true
    }

    /// One tick at `rate`. Constant work, no division.
    pub fn tick(&mut self, rate: Rate) -> Progress {
        self.tick_at(rate.of(self.nominal))
    }

    /// One tick; `wanted` is the path rate that is aimed for.
    pub(super) fn tick_at(&mut self, wanted: PathRate) -> Progress {
        let cap = i64::from(self.ramp.cap.raw());
        let window = self.ramp.n1.wrapping_add(self.ramp.n2);
        let c = self.older();
        let lowest = c.wrapping_sub(cap).max(0) as u32;
        let highest = c.wrapping_add(cap).min(cap) as u32;

        let wanted = if self.abandoned { 0 } else { wanted.raw() };
        if wanted > self.level {
            self.raise(wanted);
        }
        self.level = self.level.min(wanted).min(highest);

        let mut input = self.level.max(lowest);
        if u64::from(input) >= self.left {
            input = self.left as u32;
            self.level = 0;
        }
        self.left = self.left.wrapping_sub(u64::from(input));
        self.store(input);
        self.watch_peak(input, window);
        let travel = self.advance(input, c);

        if self.abandoned && self.at_rest() {
            self.left = 0;
        }
        Progress {
            travel,
            done: self.left == 0 && self.at_rest(),
        }
    }

    /// u(t−n1) + u(t−n2) − u(t−n1−n2), three numbers below 2³².
    fn older(&self) -> i64 {
        let (n1, n2) = (self.ramp.n1, self.ramp.n2);
        self.past(n1)
            .wrapping_add(self.past(n2))
            .wrapping_sub(self.past(n1.wrapping_add(n2)))
    }

    /// Takes an input into the means; `older` is what leaves them.
    #[inline]
    fn advance(&mut self, input: u32, older: i64) -> Travel {
        // |A| ≤ n2·cap < 2⁴³ and 0 ≤ V ≤ n1·n2·cap < 2⁵².
        self.accel = self
            .accel
            .wrapping_add(i64::from(input))
            .wrapping_sub(older);
        self.speed = self.speed.wrapping_add(self.accel);
        let dividend = ((self.speed as u64) << 8).wrapping_add(u64::from(self.remainder));
        let (step, remainder) = self.ramp.area.divide(dividend);
        self.travel = self.travel.wrapping_add(step);
        self.remainder = remainder;
        Travel::from_raw(self.travel)
    }

    /// Rule 2 of the governor, for a wanted rate above the level: raises the level as far as the length allows.
    fn raise(&mut self, wanted: u32) {
        let (share, _) = self.ramp.ticks.divide(self.left);
        let share = u32::try_from(share).unwrap_or(u32::MAX);
        let standing = self.at_rest();
        if standing {
            self.forget_peaks();
        }
        if standing && share == 0 {
            self.level = 1;
        } else if share >= self.peak.max(self.older_peak) {
            self.level = self.level.max(share.min(wanted));
        }
    }

    /// The input `ticks` ticks ago.
    fn past(&self, ticks: u16) -> i64 {
        if ticks > self.filled {
            return 0;
        }
        let slot = self.head.wrapping_sub(usize::from(ticks)) & Self::MASK;
        i64::from(self.ring.get(slot).copied().unwrap_or(0))
    }

    fn store(&mut self, input: u32) {
        if let Some(slot) = self.ring.get_mut(self.head & Self::MASK) {
            *slot = input;
        }
        self.head = self.head.wrapping_add(1) & Self::MASK;
        self.filled = self.filled.wrapping_add(1).min(N as u16);
    }

    fn watch_peak(&mut self, input: u32, window: u16) {
        self.peak = self.peak.max(input);
        self.peak_ticks = self.peak_ticks.wrapping_add(1);
        if self.peak_ticks >= window {
            self.older_peak = self.peak;
            self.peak = 0;
            self.peak_ticks = 0;
        }
    }

    const fn forget_peaks(&mut self) {
        self.peak = 0;
        self.older_peak = 0;
        self.peak_ticks = 0;
    }
}

/// Converts nanometres to the unit of the input.
#[must_use]
pub const fn to_units(length: Length) -> u64 {
    if length.nm() < 0 {
        0
    } else {
        (length.nm() as u64) << 8
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests;
