//! One pass of a thread, as its axis went: where the groove lies, and the error of its lead, over its second half.
//!
//! A pass ends when it ends, so its half is not known before. Errors are summed up in [`BLOCKS`] blocks of equal size;
//! where all are full, two become one. At the end the blocks of the second half are left: the mean is theirs, and the
//! slope is what their later half lies off their earlier one. In between the spindle is taken to turn evenly.

use super::actual::Sample;
use crate::link::PassCut;
use crate::units::{Length, Turns};

/// Blocks of a pass. A full pass has half of them to all of them.
const BLOCKS: usize = 16;

/// Fewer blocks say nothing of a half.
const LEAST: usize = 4;

/// Binary places of a turn.
const PLACES: u32 = 10;

/// Errors beyond so many nanometres count as that: sums of means over all blocks have 32 bits.
const MOST: i64 = 1 << 25;

/// A pass under way, or none.
#[derive(Debug)]
pub struct Pass {
    /// Ticks of the stroke in which the error of the setpoint was measured.
    ticks: u32,
    samples: u32,
    lead: Length,
    first: Turns,
    last: Turns,
    /// The last error.
    error: Length,
    /// Sums of errors in nanometres.
    blocks: [i64; BLOCKS],
    full: usize,
    /// Binary logarithm of the samples in a full block; samples in the one that is being filled.
    log: u32,
    within: u32,
}

impl Pass {
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            ticks: 0,
            samples: 0,
            lead: Length::ZERO,
            first: Turns::ZERO,
            last: Turns::ZERO,
            error: Length::ZERO,
            blocks: [0; BLOCKS],
            full: 0,
            log: 0,
            within: 0,
        }
    }

    /// A stroke begins.
    pub const fn begin(&mut self) {
        (self.ticks, self.samples) = (0, 0);
        (self.full, self.log, self.within) = (0, 0, 0);
    }

    /// Takes a tick of the stroke. Where its sample, if there is one, counts, gives the change of the error since the last
    /// one.
    pub fn take(&mut self, sample: Option<&Sample>) -> Option<Length> {
        self.ticks = self.ticks.saturating_add(1);
        let sample = sample?;
        if self.ticks < sample.after {
            return None;
        }
        if self.samples == 0 {
            (self.first, self.lead) = (sample.angle, sample.lead);
            self.error = sample.error;
        } else if self.lead != sample.lead {
            // In a chain one stroke goes over into the next: two leads have no common line.
            return None;
        }
        self.samples = self.samples.saturating_add(1);
        self.last = sample.angle;
        self.fill(sample.error.nm().clamp(-MOST, MOST));
        let change = sample.error - self.error;
        self.error = sample.error;
        Some(change)
    }

    fn fill(&mut self, error: i64) {
        if self.full == BLOCKS {
            for place in 0..BLOCKS / 2 {
                let first = place.wrapping_mul(2);
                let sum = self
                    .sum(first)
                    .wrapping_add(self.sum(first.wrapping_add(1)));
                if let Some(block) = self.blocks.get_mut(place) {
                    *block = sum;
                }
            }
            self.full = BLOCKS / 2;
            self.log = self.log.wrapping_add(1);
        }
        if let Some(block) = self.blocks.get_mut(self.full) {
            let before = if self.within == 0 { 0 } else { *block };
            *block = before.wrapping_add(error);
        }
        self.within = self.within.wrapping_add(1);
        if self.within >> (self.log & 31) != 0 {
            self.within = 0;
            self.full = self.full.wrapping_add(1);
        }
    }

    fn sum(&self, block: usize) -> i64 {
        self.blocks.get(block).copied().unwrap_or(0)
    }

    /// The stroke is over. Gives the pass; `None` where there were too few samples.
    #[inline(never)]
    pub fn close(&mut self) -> Option<PassCut> {
        let full = core::mem::replace(&mut self.full, 0);
        if full < LEAST {
            return None;
        }
        // Whole blocks of the second half: three of them at the least, two where a block is a sample.
        let log = self.log & 31;
        let skipped = (self.samples >> 1).div_ceil(1 << log) as usize;
        let left = full.saturating_sub(skipped) as i32;
        let half = left >> 1;
        // Index loops: chains of iterators take 350 bytes more.
        let mean = |at: i32| (self.sum(skipped.wrapping_add(at as usize)) >> log) as i32;
        let (mut sum, mut risen) = (0_i32, 0_i32);
        for at in 0..left {
            let mean = mean(at);
            sum = sum.wrapping_add(mean);
            if at < half {
                risen = risen.wrapping_sub(mean);
            }
            if at >= left.wrapping_sub(half) {
                risen = risen.wrapping_add(mean);
            }
        }
        let (groove, risen) = (sum.checked_div(left)?, risen.checked_div(half)?);
        // So many blocks lie between the middles of both parts.
        let apart = left.wrapping_sub(half);
        let mut scatter = 0;
        for at in 0..left {
            // Halves of a block from the middle.
            let off = at.wrapping_mul(2).wrapping_add(1).wrapping_sub(left);
            let line = risen.wrapping_mul(off).checked_div(apart.wrapping_mul(2))?;
            let off = mean(at).wrapping_sub(groove).wrapping_sub(line);
            scatter = scatter.max(off.wrapping_abs());
        }
        let turned = (self.last - self.first).raw() >> (32_u32.wrapping_sub(PLACES));
        let apart = i64::from(apart) << log;
        let slope = (i64::from(risen) << PLACES)
            .wrapping_mul(self.samples.into())
            .checked_div(turned.wrapping_mul(apart));
        Some(PassCut {
            groove: Length::from_nm(groove.into()),
            slope: Length::from_nm(slope.unwrap_or(0)),
            scatter: Length::from_nm(scatter.into()),
        })
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;

    /// A pass of `count` samples and `turns` turns; its error at a part of the way, 0 to 1000.
    fn pass(count: i64, turns: i64, error: impl Fn(i64) -> i64) -> Option<PassCut> {
        let mut pass = Pass::new();
        // What was before does not count.
        for k in 0..77 {
            pass.take(Some(&sample(1_000_000, k << 32)));
        }
        pass.begin();
        for k in 0..count {
            let error = error(k * 1000 / count);
            let angle = (7 << 32) + (turns << 32) / count * k;
            assert!(pass.take(Some(&sample(error, angle))).is_some());
        }
        pass.close()
    }

    fn sample(error: i64, angle: i64) -> Sample {
        Sample {
            error: Length::from_nm(error),
            angle: Turns::from_raw(angle),
            on_x: false,
            lead: Length::from_nm(6_000_000),
            per_second: Length::from_nm(60_000_000),
            after: 0,
        }
    }

    #[test]
    fn groove_and_lead_are_those_of_the_second_half() {
        for count in [32, 100, 999, 5_000, 40_000] {
            for turns in [20_i64, -20] {
                // Settles from 90 µm, then lies at 5 µm in the middle of the half, and grows by 100 nm a turn.
                let grown = |at: i64| 5_000 + (at - 750) * 20 * 100 / 1000 * turns.signum();
                let found = pass(count, turns, |at| if at < 490 { 90_000 } else { grown(at) });
                let found = found.unwrap();
                // Blocks begin up to one of them after the half, and the last ones are not full: up to 1/8 of the pass.
                assert!(
                    (found.groove.nm() - 5_000).abs() <= 130,
                    "{count}: {found:?}"
                );
                assert!((found.slope.nm() - 100).abs() <= 4, "{count}: {found:?}");
                assert!(found.scatter.nm() <= 40, "{count}: {found:?}");
            }
        }
    }

    #[test]
    fn a_pass_of_a_few_samples_says_nothing() {
        assert_eq!(pass(3, 1, |_| 5), None);
        let found = pass(4, 1, |_| 5).unwrap();
        assert_eq!((found.groove.nm(), found.slope.nm()), (5, 0));
    }

    /// Alternately 3 µm and nothing, in parts of a tenth of the pass.
    #[test]
    fn what_is_no_line_scatters() {
        let found = pass(8_000, 20, |at| at / 100 % 2 * 3_000).unwrap();
        assert!((500..=2_500).contains(&found.scatter.nm()), "{found:?}");
    }

    #[test]
    fn a_pass_is_closed_once() {
        let mut pass = Pass::new();
        for k in 0..9 {
            pass.take(Some(&sample(5, k << 32)));
        }
        assert!(pass.close().is_some());
        assert_eq!(pass.close(), None);
    }

    #[test]
    fn before_the_first_setpoint_has_taken_effect_nothing_counts() {
        let mut pass = Pass::new();
        let sample = Sample {
            after: 4,
            ..sample(9, 0)
        };
        let counted = [None, Some(&sample), Some(&sample), Some(&sample)].map(|of| pass.take(of));
        assert_eq!(counted, [None, None, None, Some(Length::ZERO)]);
        let other = Sample {
            lead: Length::from_nm(2),
            ..sample
        };
        assert_eq!(pass.take(Some(&other)), None);
    }
}
