//! How coarse an encoder is whose edges are not timed: what its counts leave unknown, and what the observer makes of that.
//!
//! The observer takes the middle of the count for the angle and is wrong by up to half a count, in a way that changes with
//! each tick. An axis on the lead follows the predicted angle, so it is shaken by that error. And where counts come more
//! seldom than the observer can bridge, its speed swings from count to count. Both are computed here for checks before
//! anything moves; the tick knows nothing of this.

use super::observer::Gains;
use crate::units::{Acceleration, Lead, Rpm, Ticks, mul_div, signed};

/// Counts a second for each hertz of the observer's bandwidth, from which on its speed is within 15 % at a steady spindle.
/// With 12 it is within 23 %, with 6 within 45 %, with one count four times too fast. (Simulated over all phases,
/// bandwidths of 15 to 80 Hz at ticks of 1 and 2 ms.)
const COUNTS_TO_BANDWIDTH: u32 = 20;

/// Ticks until a step has left the observer: so many times the time of its poles.
const POLES: u32 = 24;

/// Most ticks that are added up; the slowest observer needs 3056.
const LONGEST: u32 = 4096;

/// An encoder whose edges are not timed, and the observer that follows it.
#[derive(Clone, Copy, Debug)]
pub struct Coarse {
    /// Counts a turn, 1…2²⁰.
    pub counts: u32,
    /// Bandwidth of the observer, 1…1000 Hz.
    pub bandwidth_hz: u32,
    /// Time between two samples, 250…10 000 µs.
    pub tick_us: u32,
}

impl Coarse {
    /// The largest acceleration that reading whole counts can give an axis which is on this lead, and whose setpoints are
    /// predicted `ahead` of the sample.
    ///
    /// A bound: the error of half a count in the worst order. What comes is about 70 % of it.
    #[must_use]
    pub fn noise(self, lead: Lead, ahead: Ticks) -> Acceleration {
        let gain = self.second_difference(ahead);
        // Half a count of error, in 2⁻³² turns a tick squared; then a second squared, and the lead.
        let tick = u64::from(self.tick_us);
        let counts = u64::from(self.counts);
        let divisor = counts.saturating_mul(tick).saturating_mul(tick);
        let turns_per_s2 = mul_div(gain >> 1, 1_000_000_000_000, divisor);
        let (nm, turns) = lead.parts();
        // One division after the other rounds as one by both would, and no lead is too odd for it.
        let along = mul_div(turns_per_s2, nm, 1 << 32);
        Acceleration::from_nm_per_s2(signed(mul_div(along, 1, turns)))
    }

    /// The slowest spindle whose speed the observer knows to 15 %, rounded up.
    #[must_use]
    pub fn slowest(self) -> Rpm {
        let counts_a_minute = self
            .bandwidth_hz
            .saturating_mul(COUNTS_TO_BANDWIDTH)
            .saturating_mul(60);
        let rpm = counts_a_minute.div_ceil(self.counts.max(1));
        Rpm::new(i32::try_from(rpm).unwrap_or(i32::MAX))
    }

    /// The sum of the magnitudes of the predicted angle's second differences after a single error of one, in 2⁻³².
    fn second_difference(self, ahead: Ticks) -> u64 {
        let Gains { alpha, beta, gamma } = Gains::new(self.bandwidth_hz, self.tick_us);
        let (alpha, beta, gamma) = (alpha.to_bits(), beta.to_bits(), gamma.to_bits());
        let one = 1_i64 << 32;
        let ahead = i64::from(ahead.raw());
        let half_square = ahead.wrapping_mul(ahead >> 1) >> 16;
        let (mut angle, mut speed, mut acceleration) = (0_i64, 0_i64, 0_i64);
        let (mut last, mut before) = (0_i64, 0_i64);
        let mut sum = 0_u64;
        for tick in 0..self.ticks_to_rest() {
            let measured = if tick == 0 { one } else { 0 };
            let predicted = angle.wrapping_add(speed).wrapping_add(acceleration >> 1);
            let surprise = measured.wrapping_sub(predicted);
            angle = predicted.wrapping_add(times(alpha, surprise));
            speed = speed
                .wrapping_add(acceleration)
                .wrapping_add(times(beta, surprise));
            acceleration = acceleration.wrapping_add(times(gamma, surprise));
            let shown = angle
                .wrapping_add(scaled(speed, ahead))
                .wrapping_add(scaled(acceleration, half_square));
            let difference = shown
                .wrapping_sub(last.wrapping_mul(2))
                .wrapping_add(before);
            sum = sum.saturating_add(difference.unsigned_abs());
            (before, last) = (last, shown);
        }
        sum
    }

    /// Ticks after which nothing of an error is left.
    fn ticks_to_rest(self) -> u32 {
        // The time of a pole is 1/(2π·f).
        let product = self
            .bandwidth_hz
            .saturating_mul(self.tick_us)
            .saturating_mul(6);
        POLES
            .saturating_mul(1_000_000)
            .checked_div(product)
            .unwrap_or(LONGEST)
            .clamp(8, LONGEST)
    }
}

/// `gain · value`, the gain in 2⁻³² and at most 1.5, the value at most some units in 2⁻³².
const fn times(gain: i64, value: i64) -> i64 {
    ((gain as i128).wrapping_mul(value as i128) >> 32) as i64
}

/// `value` times a number of ticks (or their square) in 2⁻¹⁶.
const fn scaled(value: i64, ticks: i64) -> i64 {
    ((value as i128).wrapping_mul(ticks as i128) >> 16) as i64
}
