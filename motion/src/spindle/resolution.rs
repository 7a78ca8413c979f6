//! What an encoder tells of the spindle: how slowly it may turn, and how much reading whole counts shakes an axis.
//!
//! Without the times of its edges, the observer takes the middle of the count as the angle. This is wrong by up to half a
//! count, and the error changes with each tick. An axis on the lead follows the predicted angle, so the error shakes the
//! axis. With the times the angle at an edge is exact. But if edges come too seldom for the observer to bridge the gap, it
//! loses the spindle, timed or not. This module computes both effects for checks before anything moves; the tick knows
//! nothing of this module.

use super::looks::FEW;
use super::observer::steady;
use crate::units::{Acceleration, Lead, Length, Rpm, Ticks, mul_div, signed};
use leadscrew_spindle::Gains;

/// Counts a second for each hertz of the observer's bandwidth. The speed is then within 15 % at a steady spindle. With 12
/// counts it is within 23 %, with 6 within 45 %; with one count it is four times too fast. (Simulated over all phases,
/// bandwidths of 15 to 80 Hz at ticks of 1 and 2 ms.)
const UNTIMED: u32 = 20;

/// The same where edges are timed. With 8 the setpoints of a lead of 6 mm have at most 7 m/s², with 4 up to 70, and with 3
/// or fewer the observer swings: 100 to 3000 µm beside the helix, hundreds of m/s². (Simulated at 54 to 608 rpm, bandwidths
/// of 15, 35 and 60 Hz, without ripple and with 10 % at 5 Hz, 5 % at 20 Hz, 10 % once and 2 % twice a turn.)
const TIMED: u32 = 8;

/// Counts a second that are enough for a pass where they are timed and few, and not learned: the bandwidth then
/// follows them. The setpoints of a lead of 6 mm have at most 4 m/s² and are at most 14 µm beside the helix at 60
/// counts a turn or more, where the spindle swings by 10 % at 5 Hz or by 5 % at 20 Hz. (Simulated from here to five
/// times the speed.)
const FEW_A_SECOND: u32 = 80;

/// An encoder of fewer counts is learned. With as many or more, the quick observer follows a swing of unknown
/// frequency more closely than a tracker that has not learned it.
const FEW_TIMED: u32 = 60;
const FEW_UNTIMED: u32 = 1024;

/// The same where the frequency of the drive's swing is known. With as many timed counts, the quick observer is as
/// good; where they have no times, a count of a lead of 6 mm is 0.6 µm.
const FEW_TIMED_WITH_SWING: u32 = 256;
const FEW_UNTIMED_WITH_SWING: u32 = 10_000;

/// Counts a second that a tracker needs: with fewer it learns for more than half a minute.
const LEARNED: u32 = 8;

/// Below this, the speed that says whether the spindle has arrived is coarse, however many counts there are. (Simulated at
/// ticks of 500 µs: an axis keeps to [`Resolution::uncertainty`] down to 10 rpm.)
const SLOWEST_LEARNED: i32 = 20;

/// Counts by which the predicted angle jumps in a tick where the spindle turns back: edges come seldom there, so that the
/// first one is believed little, and the second one shows the count in which the spindle stood and the one after it.
/// (Simulated: 1.59 counts once in 12 000 taps of 0.4 to 2.5 mm with pecks, else at most 1.25; 25 to 999 counts, ticks of 1
/// and 2 ms.)
const TURNING_BACK: u64 = 2;

/// A step has left the observer after this many time constants of its poles.
const POLES: u32 = 24;

/// The largest number of ticks that are added up; the slowest observer needs 3056.
const LONGEST: u32 = 4096;

/// An encoder, and the observer that follows it.
#[derive(Clone, Copy, Debug)]
pub struct Resolution {
    /// Counts per turn, 1…2²⁰.
    pub counts: u32,
    /// The hardware captures the times of its edges.
    pub timed: bool,
    /// The frequency with which the spindle's drive swings is known.
    pub swing_known: bool,
    /// Bandwidth of the observer, 1…1000 Hz.
    pub bandwidth_hz: u32,
    /// Time between two samples, 250…10 000 µs.
    pub tick_us: u32,
}

impl Resolution {
    /// True where a pass on the lead follows an angle that is learned: with few counts, and with counts that have no times,
    /// where the swing of the spindle's drive is known.
    #[must_use]
    pub const fn is_learned(self) -> bool {
        let few = match (self.timed, self.swing_known) {
            (true, false) => FEW_TIMED,
            (true, true) => FEW_TIMED_WITH_SWING,
            (false, false) => FEW_UNTIMED,
            (false, true) => FEW_UNTIMED_WITH_SWING,
        };
        self.counts < few
    }

    /// The same spindle and encoder where the frequency with which the drive swings is known.
    #[must_use]
    pub const fn with_swing(self) -> Self {
        Self {
            swing_known: true,
            ..self
        }
    }

    /// The bandwidth of the observer in Hz where the spindle turns at `rpm`: an encoder of few counts narrows it.
    #[must_use]
    pub fn bandwidth_at(self, rpm: u32) -> u32 {
        if self.counts >= FEW {
            return self.bandwidth_hz;
        }
        let a_second = self.counts.saturating_mul(rpm) / 60;
        let most = a_second.checked_div(self.to_bandwidth());
        self.bandwidth_hz.min(most.unwrap_or(u32::MAX))
    }

    /// The largest acceleration that reading whole counts, without the times of edges, can give an axis on this lead. The
    /// axis's setpoints are predicted `ahead` of the sample.
    ///
    /// This is a bound: it assumes errors of half a count in the worst order. Real accelerations reach about 70 % of
    /// it.
    #[must_use]
    pub fn noise(self, lead: Lead, ahead: Ticks) -> Acceleration {
        let gain = self.second_difference(ahead);
        // Half a count of error, in 2⁻³² turns per tick squared; then per second squared; then times the lead.
        let tick = u64::from(self.tick_us);
        let counts = u64::from(self.counts);
        let divisor = counts.saturating_mul(tick).saturating_mul(tick);
        let turns_per_s2 = mul_div(gain >> 1, 1_000_000_000_000, divisor);
        let (nm, turns) = lead.parts();
        // Two divisions, one after the other, round like one division by the product, and they work for any lead.
        let along = mul_div(turns_per_s2, nm, 1 << 32);
        Acceleration::from_nm_per_s2(signed(mul_div(along, 1, turns)))
    }

    /// The largest acceleration that an encoder of few timed counts gives an axis on this lead where the spindle turns back
    /// (two counts in a tick); `None` for other encoders.
    #[must_use]
    pub fn noise_of_few(self, lead: Lead) -> Option<Acceleration> {
        if !self.timed || self.counts >= FEW {
            return None;
        }
        let (nm, turns) = lead.parts();
        let parts = turns.saturating_mul(u64::from(self.counts));
        let jump = mul_div(nm, TURNING_BACK, parts);
        let tick = u64::from(self.tick_us);
        let a_second = mul_div(jump, 1_000_000_000_000, tick.saturating_mul(tick));
        Some(Acceleration::from_nm_per_s2(signed(a_second)))
    }

    /// The lowest spindle speed at which a pass may follow the observer, rounded up.
    #[must_use]
    pub fn slowest(self) -> Rpm {
        let a_second = self.of_bandwidth();
        if self.timed && self.counts < FEW {
            return self.at(a_second.min(FEW_A_SECOND));
        }
        self.at(a_second)
    }

    /// The lowest spindle speed of a thread, rounded up: of a pass that follows an angle that is learned, or the observer.
    #[must_use]
    pub fn slowest_of_thread(self) -> Rpm {
        if self.is_learned() {
            self.slowest_learned()
        } else {
            self.slowest()
        }
    }

    /// The lowest spindle speed at which an ordinary tap may follow the observer, rounded up: it has to be as quick as its
    /// bandwidth, for the spindle turns back.
    #[must_use]
    pub fn slowest_of_tap(self) -> Rpm {
        self.at(self.of_bandwidth())
    }

    /// The counts a second that the bandwidth needs.
    fn of_bandwidth(self) -> u32 {
        self.bandwidth_hz.saturating_mul(self.to_bandwidth())
    }

    /// Counts a second for each hertz of the bandwidth.
    const fn to_bandwidth(self) -> u32 {
        if self.timed { TIMED } else { UNTIMED }
    }

    /// The speed that gives so many counts a second, rounded up.
    fn at(self, a_second: u32) -> Rpm {
        let rpm = a_second.saturating_mul(60).div_ceil(self.counts.max(1));
        Rpm::new(i32::try_from(rpm).unwrap_or(i32::MAX))
    }

    /// The lowest spindle speed at which a tracker learns the spindle, rounded up.
    #[must_use]
    pub fn slowest_learned(self) -> Rpm {
        Rpm::new(self.at(LEARNED).get().max(SLOWEST_LEARNED))
    }

    /// How far an axis on this lead may be beside the spindle's true angle, where the angle is learned: 1.5 times the way
    /// in the smaller of a count and a tick. `None` where edges are timed: then it is less than the encoder's own error.
    ///
    /// Near a whole fraction of a count a tick, the edges come at the same places of their ticks for long, and no observer
    /// takes this error away.
    #[must_use]
    pub fn uncertainty(self, lead: Lead, rpm: Rpm) -> Option<Length> {
        if self.timed || !self.is_learned() {
            return None;
        }
        let (nm, turns) = lead.parts();
        let counts = u64::from(self.counts);
        let by_count = mul_div(nm, 3, turns.saturating_mul(counts).saturating_mul(2));
        let per_minute = mul_div(nm, u64::from(rpm.abs()), turns);
        let by_tick = mul_div(
            per_minute,
            u64::from(self.tick_us).saturating_mul(3),
            120_000_000,
        );
        Some(Length::from_nm(signed(by_count.min(by_tick))))
    }

    /// The predicted angle's second differences after a single error of one: the sum of their magnitudes, in 2⁻³².
    fn second_difference(self, ahead: Ticks) -> u64 {
        let Gains { alpha, beta, gamma } = steady(self.bandwidth_hz, self.tick_us);
        let (alpha, beta, gamma) = (alpha.to_bits(), beta.to_bits(), gamma.to_bits() >> 16);
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

    /// The number of ticks after which an error has fully decayed.
    fn ticks_to_rest(self) -> u32 {
        // The time constant of a pole is 1/(2π·f).
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

/// `gain · value`. The gain is in 2⁻³² and at most 1.5; the value is at most a few units in 2⁻³².
const fn times(gain: i64, value: i64) -> i64 {
    ((gain as i128).wrapping_mul(value as i128) >> 32) as i64
}

/// `value` times a number of ticks (or their square) in 2⁻¹⁶.
const fn scaled(value: i64, ticks: i64) -> i64 {
    ((value as i128).wrapping_mul(ticks as i128) >> 16) as i64
}
