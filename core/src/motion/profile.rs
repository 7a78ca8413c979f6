//! The jerk-limited profile: two running means over a path rate.
//!
//! Knows lengths, speeds and ticks; knows nothing of axes, paths, planning or why the operator asks for a rate.
//!
//! # The filter
//!
//! The input `u(t)` is a path rate, never above the cap `v`, whose sum is the length of the move. It passes a running
//! mean over n1 ticks and one over n2 ticks; what comes out is the speed. With
//!
//! ```text
//! K(t) = u(t) − u(t−n1) − u(t−n2) + u(t−n1−n2),   A += K,   V += A,   s += V / (n1·n2)
//! ```
//!
//! speed is V/(n1·n2), acceleration A/(n1·n2), jerk K/(n1·n2). From 0 ≤ u ≤ v follow V ≤ n1·n2·v and |A| ≤ n2·v; where
//! also |K| ≤ v, speed is within v, acceleration within v/n1 and jerk within v/(n1·n2), whatever the input does. A mean
//! forgets nothing: the division carries its remainder, so the output ends exactly where the input ends. A constant
//! pulse of n1 + n2 ticks or more comes out as the time-optimal ramp, cruise, ramp.
//!
//! # The governor
//!
//! Override, feed hold and a feed that follows the spindle change the wanted rate `w` from tick to tick in any way. The
//! governor makes the input of it. N = n1 + n2, R is the length not yet put in, L the level: what the governor wants to
//! put in, zero at the start. Each tick, with c = u(t−n1) + u(t−n2) − u(t−N):
//!
//! 1. the input must be within lo = max(0, c − v) and hi = min(v, c + v), that is |K| ≤ v. Since −v ≤ c ≤ 2v there is
//!    always such an input;
//! 2. the level falls at once, to w or hi. It rises to at most R/N, and only where R/N is at least M, the largest input
//!    of the last N ticks;
//! 3. the input is the level, or lo where that is higher ("forced"), or R where that is lower: the end.
//!
//! Then the input can always end, that is lo ≤ R always, and lo = 0 from the tick on in which R is spent:
//!
//! - A forced input is x + y − z − v of three older inputs, so at most the smaller of x and y. A forced input forces no
//!   other: where x is one, made of x', y', z', then z = y', and x + y − z − v = (x' − v) + (y − v) − z' ≤ 0; the same
//!   for y.
//! - Let the level rise last at t0, and let M count that rise too. All inputs from t0 on are at most M, levels by rule 2,
//!   forced ones by the line above. R(t0) ≥ M·N, so at t0 + i at least M·(N − i) is left: enough for every lo before
//!   t0 + N.
//! - From t0 + N on, x, y and z are all younger than t0, where the level only falls. x and y are levels, not forced; z is
//!   the oldest, so z ≥ x and lo ≤ y − v ≤ 0. Nothing is forced any more, in particular not after the end.
//! - Where less than N units (of 1/256 nm) are left the level is one unit, taken from rest only; K is then at most two
//!   units, and the cap is never less.
//!
//! Nothing can get stuck: at level zero the filter drains, at rest M is zero, and from rest every rest of a length has a
//! level. M is kept as the maxima of two stretches of N ticks, so that it may remember up to 2·N ticks; that only delays.

use super::rate::{PathRate, Rate, Travel};
use crate::units::{Divisor, Length};

/// Ticks the profile can look back: the longest ramp n1 + n2.
pub const CAPACITY: u16 = 2048;

const MASK: usize = CAPACITY as usize - 1;

/// The two means of a motion and the largest rate they are made for.
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
    /// within cap/(n1·n2), per tick. `None` where a mean has no ticks, the two have more than [`CAPACITY`] together, or
    /// `cap` is less than two units (1/128 nm per tick).
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

    /// True where it is the same ramp.
    #[must_use]
    pub const fn is(&self, other: &Self) -> bool {
        self.cap.raw() == other.cap.raw() && self.n1 == other.n1 && self.n2 == other.n2
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

/// Where a tick has brought the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Distance from the start of the motion.
    pub travel: Travel,
    /// True where the motion stands and nothing is left to do: at its end, or where it was abandoned.
    pub done: bool,
}

/// The one long-lived profile of a machine: about 8 KiB, most of it the ring of past inputs.
#[derive(Clone, Debug)]
pub struct Profile {
    /// R: what has not been put in yet, in 1/256 nm.
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
    /// M is the larger of the two.
    peak: u32,
    older_peak: u32,
    peak_ticks: u16,
    /// Inputs since the start of this motion, up to the capacity; what is older in the ring belongs to another motion
    /// and counts as zero.
    filled: u16,
    abandoned: bool,
    /// Slot of the next input.
    head: usize,
    ring: [u32; CAPACITY as usize],
}

impl Default for Profile {
    fn default() -> Self {
        Self::new()
    }
}

impl Profile {
    /// A profile at rest with nothing to do.
    #[must_use]
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            ring: [0; CAPACITY as usize],
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

    /// At rest with nothing to do, as [`new`](Self::new): what is in the ring counts no more.
    pub const fn begin_anew(&mut self) {
        self.filled = 0;
        self.left = 0;
        self.level = 0;
        (self.accel, self.speed) = (0, 0);
        self.forget_peaks();
        self.abandoned = true;
    }

    /// Starts a motion of `length` from rest; at [`Rate::FULL`] it goes at `nominal`, or at the ramp's cap where that is
    /// less. False, and nothing changes, while the last motion is not done.
    #[must_use]
    pub const fn begin(&mut self, length: Length, nominal: PathRate, ramp: Ramp) -> bool {
        if !self.at_rest() || self.left != 0 {
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

    /// Joins a further piece of `length` to the motion under way, with the same ramp and without a stop: travel goes on
    /// counting. `nominal` holds from now on, also for what is left of the piece before. False, and nothing changes, where
    /// there is none or it was abandoned.
    #[must_use]
    pub const fn extend(&mut self, length: Length, nominal: PathRate) -> bool {
        if self.abandoned {
            return false;
        }
        self.left = self.left.saturating_add(to_units(length));
        self.nominal = nominal;
        true
    }

    /// Gives up what is left: the motion stops as on a feed hold and is then done, wherever it stands. Nothing of it
    /// comes back.
    pub const fn abandon(&mut self) {
        self.abandoned = true;
        if self.at_rest() {
            self.left = 0;
        }
    }

    /// True while nothing moves and nothing is on its way through the means: speed and acceleration are zero.
    #[must_use]
    pub const fn at_rest(&self) -> bool {
        self.speed == 0 && self.accel == 0
    }

    /// What has not entered the means yet, rounded down.
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

    /// One tick at `rate`. Constant work, no division.
    pub fn tick(&mut self, rate: Rate) -> Progress {
        let cap = i64::from(self.ramp.cap.raw());
        let (n1, n2) = (self.ramp.n1, self.ramp.n2);
        let sum = n1.wrapping_add(n2);
        // Four numbers below 2³²: no overflow here or below.
        let c = self
            .past(n1)
            .wrapping_add(self.past(n2))
            .wrapping_sub(self.past(sum));
        let lowest = c.wrapping_sub(cap).max(0) as u32;
        let highest = c.wrapping_add(cap).min(cap) as u32;

        let wanted = if self.abandoned {
            0
        } else {
            rate.of(self.nominal).raw()
        };
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
        self.put(input, sum);

        // |A| ≤ n2·cap < 2⁴³ and 0 ≤ V ≤ n1·n2·cap < 2⁵².
        self.accel = self.accel.wrapping_add(i64::from(input)).wrapping_sub(c);
        self.speed = self.speed.wrapping_add(self.accel);
        let dividend = ((self.speed as u64) << 8).wrapping_add(u64::from(self.remainder));
        let (step, remainder) = self.ramp.area.divide(dividend);
        self.travel = self.travel.wrapping_add(step);
        self.remainder = remainder;

        if self.abandoned && self.at_rest() {
            self.left = 0;
        }
        Progress {
            travel: Travel::from_raw(self.travel),
            done: self.left == 0 && self.at_rest(),
        }
    }

    /// Rule 2 of the governor: the level the length allows, for a wanted rate above the level.
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

    /// The input of `ticks` ticks ago.
    fn past(&self, ticks: u16) -> i64 {
        if ticks > self.filled {
            return 0;
        }
        let slot = self.head.wrapping_sub(usize::from(ticks)) & MASK;
        i64::from(self.ring.get(slot).copied().unwrap_or(0))
    }

    fn put(&mut self, input: u32, window: u16) {
        if let Some(slot) = self.ring.get_mut(self.head & MASK) {
            *slot = input;
        }
        self.head = self.head.wrapping_add(1) & MASK;
        self.filled = self.filled.wrapping_add(1).min(CAPACITY);

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

/// Nanometres to the unit of the input.
const fn to_units(length: Length) -> u64 {
    if length.nm() < 0 {
        0
    } else {
        (length.nm() as u64) << 8
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests;
