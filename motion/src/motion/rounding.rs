//! Rounds the corners between joined cuts: two running means over the position.
//!
//! A path with a corner has a velocity with a step. Each mean takes the same number of ticks, so that the step is spread
//! over twice that number, in the shape of a triangle. The look-ahead of the background plans how fast a corner may be
//! passed so that the tool stays within the tolerance and the axes within their limits.
//!
//! This module knows positions and ticks. It knows nothing of paths, speeds or limits.

use crate::call::Position;
use crate::units::{Divisor, Length};

/// The longest mean, in ticks.
pub(super) const MEAN_MAX: u16 = 64;

const MASK: usize = MEAN_MAX as usize - 1;

/// The length of each of the two means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mean {
    ticks: u16,
    /// The square of the ticks.
    area: Divisor,
}

impl Mean {
    /// Means of `ticks`, from 1 to [`MEAN_MAX`].
    pub(super) const fn new(ticks: u16) -> Self {
        let ticks = if ticks == 0 {
            1
        } else if ticks > MEAN_MAX {
            MEAN_MAX
        } else {
            ticks
        };
        Self {
            ticks,
            area: Divisor::new((ticks as u32).wrapping_mul(ticks as u32)),
        }
    }

    /// Its ticks.
    #[must_use]
    pub const fn ticks(self) -> u16 {
        self.ticks
    }

    /// `sum` over the square of the ticks, to the nearest.
    #[inline]
    const fn of(self, sum: i64) -> i64 {
        let half = (self.area.get() / 2) as u64;
        let (quotient, _) = self.area.divide(sum.unsigned_abs().wrapping_add(half));
        if sum < 0 {
            (quotient as i64).wrapping_neg()
        } else {
            quotient as i64
        }
    }
}

/// The two means of X and Z. They hold distances from the start of the motion, so that nothing has to be filled in at the
/// start.
#[derive(Clone, Debug)]
pub(super) struct Rounding {
    start: Position,
    mean: Mean,
    x: Means,
    z: Means,
    /// Positions put in since the start, up to the longest mean.
    filled: u16,
    head: usize,
    /// The last position put in, and the ticks for which it has been the same.
    last: Position,
    still: u16,
}

impl Rounding {
    /// Stands at the machine's zero.
    pub(super) const fn new() -> Self {
        Self {
            start: Position::ZERO,
            mean: Mean::new(1),
            x: Means::new(),
            z: Means::new(),
            filled: 0,
            head: 0,
            last: Position::ZERO,
            still: u16::MAX,
        }
    }

    /// Stands at `start` from now on.
    pub(super) const fn begin(&mut self, start: Position, mean: Mean) {
        (self.start, self.last) = (start, start);
        self.mean = mean;
        self.x.begin();
        self.z.begin();
        self.filled = 0;
        self.still = mean.ticks.wrapping_mul(2);
    }

    /// Forgets a motion that is under way.
    pub(super) const fn rest(&mut self) {
        self.still = u16::MAX;
    }

    /// Puts in the position of a tick and returns the rounded one. C is not rounded: it stands in a joined cut.
    pub(super) fn put(&mut self, position: Position) -> Position {
        self.still = if position == self.last {
            self.still.saturating_add(1)
        } else {
            0
        };
        self.last = position;
        let head = self.head & MASK;
        // As long as the means are not full, what leaves them is the start.
        let oldest = (self.filled >= self.mean.ticks)
            .then(|| head.wrapping_sub(usize::from(self.mean.ticks)) & MASK);
        let x = self.x.put((position.x - self.start.x).nm(), oldest, head);
        let z = self.z.put((position.z - self.start.z).nm(), oldest, head);
        self.head = head.wrapping_add(1);
        self.filled = self.filled.saturating_add(1);
        Position {
            x: self.start.x + Length::from_nm(self.mean.of(x)),
            z: self.start.z + Length::from_nm(self.mean.of(z)),
            c: position.c,
        }
    }

    /// True when the rounded position has come to where the last position is.
    pub(super) const fn has_settled(&self) -> bool {
        self.still >= self.mean.ticks.wrapping_mul(2)
    }
}

/// The two means of one axis.
#[derive(Clone, Debug)]
struct Means {
    /// Sum of the positions, and sum of these sums. Distances are below 2⁴³ nm, so the second stays below 2⁵⁵.
    first: i64,
    second: i64,
    positions: [i64; MEAN_MAX as usize],
    sums: [i64; MEAN_MAX as usize],
}

impl Means {
    const fn new() -> Self {
        Self {
            first: 0,
            second: 0,
            positions: [0; MEAN_MAX as usize],
            sums: [0; MEAN_MAX as usize],
        }
    }

    const fn begin(&mut self) {
        (self.first, self.second) = (0, 0);
    }

    /// Puts `now` into the place `head`; the place `oldest` leaves the means. Returns the sum of sums.
    fn put(&mut self, now: i64, oldest: Option<usize>, head: usize) -> i64 {
        let past = |ring: &[i64; MEAN_MAX as usize]| {
            oldest.and_then(|slot| ring.get(slot)).copied().unwrap_or(0)
        };
        let (position, sum) = (past(&self.positions), past(&self.sums));
        self.first = self.first.wrapping_add(now).wrapping_sub(position);
        self.second = self.second.wrapping_add(self.first).wrapping_sub(sum);
        if let (Some(position), Some(sum)) = (self.positions.get_mut(head), self.sums.get_mut(head))
        {
            (*position, *sum) = (now, self.first);
        }
        self.second
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn at(x: i64, z: i64) -> Position {
        Position {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
            ..Position::ZERO
        }
    }

    /// The mean of means, from all positions.
    fn slowly(positions: &[i64], mean: usize) -> Vec<i64> {
        let past = |list: &[i64], i: usize, back: usize| i.checked_sub(back).map_or(0, |i| list[i]);
        let first: Vec<i64> = (0..positions.len())
            .map(|i| (0..mean).map(|back| past(positions, i, back)).sum())
            .collect();
        (0..positions.len())
            .map(|i| {
                let sum: i64 = (0..mean).map(|back| past(&first, i, back)).sum();
                let area = (mean * mean) as i64;
                (sum.abs() + area / 2) / area * sum.signum()
            })
            .collect()
    }

    #[test]
    fn it_is_two_means_and_ends_where_the_positions_end() {
        for mean in [1, 2, 7, 11, 63, 64] {
            let ways: Vec<i64> = (0..400_i64).map(|i| (i * i * 37).min(2_000_000)).collect();
            let mut rounding = Rounding::new();
            // What an earlier motion has left does not count.
            rounding.begin(at(5, 5), Mean::new(3));
            for i in 0..200 {
                let _ = rounding.put(at(i * 1_000, -i));
            }
            rounding.begin(at(-1_000, 40), Mean::new(mean as u16));
            assert!(rounding.has_settled());
            let mut rounded = Vec::new();
            for way in &ways {
                let place = rounding.put(at(-1_000 + way, 40 - 3 * way));
                rounded.push(place);
                let stands = place == at(-1_000 + way, 40 - 3 * way);
                assert!(!rounding.has_settled() || stands);
            }
            assert!(rounding.has_settled(), "{mean}");
            let x: Vec<i64> = rounded.iter().map(|place| place.x.nm() + 1_000).collect();
            assert_eq!(x, slowly(&ways, mean), "{mean}");
            let down: Vec<i64> = ways.iter().map(|way| -3 * way).collect();
            let z: Vec<i64> = rounded.iter().map(|place| place.z.nm() - 40).collect();
            assert_eq!(z, slowly(&down, mean), "{mean}");
        }
    }
}
