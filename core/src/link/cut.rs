//! What the drive's own positions say of the cut of a thread [D380].
//!
//! Figures are kept in 32 bits and in 16: the certificates of a board have to fit into one reading.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use crate::units::Length;

/// The error of the cut in a pass: where the drive was, less the helix at the measured angle of that instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassCut {
    /// Mean over the second half of the pass: where its groove lies.
    pub groove: Length,
    /// Change of the error in a turn there, with the angle growing.
    pub slope: Length,
    /// The largest distance from that line, of means over parts of the half.
    pub scatter: Length,
}

/// Nanometres of a step of what is kept in 16 bits: of a distance, and of a way in a second.
const STEP: u32 = 64;
const SPEED_STEP: u32 = 100_000;

/// The error of the cut in all passes of a thread. Lengths beyond ±2.1 m count as that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct CutTally {
    /// Actual positions that were judged; 65 535 also stands for more.
    pub samples: u16,
    /// Passes whose groove is known; 255 also stands for more.
    pub passes: u8,
    /// X is the long axis.
    pub on_x: bool,
    pub(super) lead: u32,
    pub(super) least: i32,
    pub(super) most: i32,
    pub(super) slope: i32,
    pub(super) worst: u32,
    pub(super) reach: u32,
    pub(super) scatter: u16,
    pub(super) slowest: u16,
    pub(super) fastest: u16,
}

impl CutTally {
    /// Nothing is known.
    pub const NONE: Self = Self {
        samples: 0,
        passes: 0,
        on_x: false,
        lead: 0,
        least: 0,
        most: 0,
        slope: 0,
        worst: 0,
        reach: 0,
        scatter: 0,
        slowest: 0,
        fastest: 0,
    };

    /// One with these numbers in its fields.
    #[cfg(test)]
    pub(super) const fn of_parts(count: u16, size: u32, number: i32) -> Self {
        Self {
            samples: count,
            passes: size as u8,
            on_x: number < 0,
            lead: size,
            least: number,
            most: !number,
            slope: number,
            worst: !size,
            reach: !size,
            scatter: !count,
            slowest: count,
            fastest: !count,
        }
    }

    /// Takes the error at an actual position. `change`: since the position before in this pass; `lead`: of the helix;
    /// `per_second`: the way of the axis in a second.
    pub fn take(&mut self, error: Length, change: Length, lead: Length, per_second: Length) {
        let speed = steps(per_second, SPEED_STEP);
        self.worst = self.worst.max(size(error));
        // Two positions back, on the line of the last two: before the first position of a pass nobody looks.
        let reach = size(error - change - change - change);
        self.reach = self.reach.max(reach);
        if self.samples == 0 {
            self.slowest = speed;
        }
        self.slowest = self.slowest.min(speed);
        self.fastest = self.fastest.max(speed);
        self.samples = self.samples.saturating_add(1);
        self.lead = size(lead);
    }

    /// Takes a pass that is over.
    pub fn close(&mut self, pass: &PassCut) {
        let (groove, slope) = (small(pass.groove), small(pass.slope));
        self.scatter = self.scatter.max(steps(pass.scatter, STEP));
        if self.passes == 0 {
            (self.least, self.most) = (groove, groove);
        }
        self.passes = self.passes.saturating_add(1);
        self.least = self.least.min(groove);
        self.most = self.most.max(groove);
        if slope.unsigned_abs() > self.slope.unsigned_abs() {
            self.slope = slope;
        }
    }

    /// Takes the passes of another thread along.
    pub fn join(&mut self, other: &Self) {
        self.samples = self.samples.saturating_add(other.samples);
        self.passes = self.passes.saturating_add(other.passes);
        self.least = self.least.min(other.least);
        self.most = self.most.max(other.most);
        if other.slope.unsigned_abs() > self.slope.unsigned_abs() {
            self.slope = other.slope;
        }
        self.worst = self.worst.max(other.worst);
        self.reach = self.reach.max(other.reach);
        self.scatter = self.scatter.max(other.scatter);
        self.slowest = self.slowest.min(other.slowest);
        self.fastest = self.fastest.max(other.fastest);
    }

    /// Way of the helix in a turn.
    #[must_use]
    pub const fn lead(&self) -> Length {
        Length::from_nm(self.lead as i64)
    }

    /// The lowest and the highest groove of a pass.
    #[must_use]
    pub const fn grooves(&self) -> [Length; 2] {
        [
            Length::from_nm(self.least as i64),
            Length::from_nm(self.most as i64),
        ]
    }

    /// The largest error of the lead of a pass.
    #[must_use]
    pub const fn slope(&self) -> Length {
        Length::from_nm(self.slope as i64)
    }

    /// The largest error.
    #[must_use]
    pub const fn worst(&self) -> Length {
        Length::from_nm(self.worst as i64)
    }

    /// How far the error may have gone where nobody looked: each change between two positions taken twice backwards.
    #[must_use]
    pub const fn reach(&self) -> Length {
        Length::from_nm(self.reach as i64)
    }

    /// The largest scatter of a pass about its line.
    #[must_use]
    pub const fn scatter(&self) -> Length {
        Length::from_nm((self.scatter as i64).wrapping_mul(STEP as i64))
    }

    /// The way of the axis in a second where it was slowest and where it was fastest, rounded up.
    #[must_use]
    pub const fn per_second(&self) -> [Length; 2] {
        let step = SPEED_STEP as i64;
        [
            Length::from_nm((self.slowest as i64).wrapping_mul(step)),
            Length::from_nm((self.fastest as i64).wrapping_mul(step)),
        ]
    }
}

#[inline(never)]
fn small(length: Length) -> i32 {
    length.nm().clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

#[inline(never)]
fn size(length: Length) -> u32 {
    u32::try_from(length.abs().nm()).unwrap_or(u32::MAX)
}

/// Steps of `step` nanometres, rounded up.
#[inline(never)]
fn steps(length: Length, step: u32) -> u16 {
    u16::try_from(size(length).div_ceil(step)).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(groove: i64, slope: i64) -> PassCut {
        let [groove, slope] = [groove, slope].map(Length::from_nm);
        PassCut {
            groove,
            slope,
            scatter: Length::from_nm(65),
        }
    }

    #[test]
    fn the_first_pass_sets_both_ends_and_the_others_widen_them() {
        let mut cut = CutTally::NONE;
        cut.close(&pass(7, -3));
        assert_eq!(cut.grooves().map(Length::nm), [7, 7]);
        cut.close(&pass(9, 2));
        cut.close(&pass(-1, -4));
        assert_eq!(cut.grooves().map(Length::nm), [-1, 9]);
        assert_eq!((cut.slope().nm(), cut.passes), (-4, 3));
        for (error, change, speed) in [(5, 0, 500_000), (-700, -705, 399_999), (-100, 600, 600_001)]
        {
            let [error, change, lead, speed] = [error, change, -6, speed].map(Length::from_nm);
            cut.take(error, change, lead, speed);
        }
        assert_eq!(cut.per_second().map(Length::nm), [400_000, 700_000]);
        assert_eq!((cut.reach().nm(), cut.scatter().nm()), (1_900, 128));
        assert_eq!(
            (cut.samples, cut.worst().nm(), cut.lead().nm()),
            (3, 700, 6)
        );
    }

    #[test]
    fn what_has_no_room_counts_as_the_most_that_has() {
        let mut cut = CutTally::NONE;
        cut.close(&pass(i64::MIN, i64::MAX));
        let far = Length::from_nm(i64::MIN);
        cut.take(far, far, far, far);
        assert_eq!(cut.reach().nm(), i64::from(u32::MAX));
        assert_eq!(cut.grooves().map(Length::nm), [i64::from(i32::MIN); 2]);
        assert_eq!(cut.slope().nm(), i64::from(i32::MAX));
        assert_eq!(cut.worst().nm(), i64::from(u32::MAX));
    }
}
