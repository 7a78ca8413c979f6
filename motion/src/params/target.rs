//! What a drive takes of its targets (607Fh, 60C5h), and what that leaves of the limits of an axis.
//!
//! Behind the inverse of the lag of a drive a target moves by y' = v + κ·a and y″ = a + κ·j, where a and j are smoothed
//! over the time τ, with κ = (1 − ff)/Kv and τ = ff/Kv. A drive that limits its targets (9077, 9078) falls behind where
//! that is more than it takes, so the axis gets less:
//!
//! - A motion that keeps to a speed V, an acceleration A and a jerk J has v + a²/(2·J) ≤ V at any time, and its smoothed
//!   acceleration is at most a + J·τ, and A. So y' exceeds V by at most κ·J·(κ/2 + τ) where J ≤ A·Kv, else by
//!   κ·A − (A − J·τ)²/(2·J), and never by more than κ·A.
//! - j is made of the last three setpoints, and from one tick to the next twice of it can come.
//!
//! Jerk is given up before acceleration: it costs the least time. Must not know how a target is made.

use super::Params;
use super::backlash::SPEED_PART;
use super::pitch::STEEPEST;
use crate::units::{Axis, mul_div};

/// Nanoseconds of a second.
const NS: u64 = 1_000_000_000;

/// The least that is left of jerk and acceleration, in per cent.
pub(super) const LEAST_SHARE: u64 = 10;

/// Highest acceleration and jerk of an axis, nm/s² and nm/s³ (rotary: µ°).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Highest {
    pub acceleration: u64,
    pub jerk: u64,
}

impl Params {
    /// Highest acceleration and jerk of an axis, of its motion and of what is put in for backlash and errors of the pitch
    /// together: 1620 and 1622, or what the targets of its drive leave of them.
    #[inline(never)]
    pub(super) fn highest(&self, axis: Axis) -> Highest {
        let acceleration = self.acceleration(axis).nm_per_s2().unsigned_abs();
        let mut highest = Highest {
            acceleration,
            jerk: self.jerk(axis).nm_per_s3().unsigned_abs(),
        };
        let ahead = self.ahead_ns(axis);
        if let Some(room) = self.room_of_target(axis) {
            let jerk = room.map_or(0, |room| self.jerk_within(axis, room, highest));
            highest.jerk = jerk.clamp(1, highest.jerk.max(1));
        }
        let takes = self.drive_max_acceleration(axis).nm_per_s2().unsigned_abs();
        if takes != 0 {
            // Half of it is the acceleration's in any case.
            let room = takes.saturating_sub(acceleration).max(takes >> 1);
            let twice = ahead.saturating_mul(2);
            if twice != 0 {
                let jerk = mul_div(room, NS, twice);
                highest.jerk = jerk.clamp(1, highest.jerk.max(1));
            }
            let by_jerk = mul_div(highest.jerk, twice, NS);
            let left = takes.saturating_sub(by_jerk).max(1);
            highest.acceleration = acceleration.min(left);
        }
        highest
    }

    /// What the targets of a drive leave of the jerk and of the acceleration of its axis, in per cent, where that is too
    /// little to move.
    pub(super) fn unusable_target(&self, axis: Axis) -> Option<[u64; 2]> {
        let highest = self.highest(axis);
        let all = [
            self.jerk(axis).nm_per_s3(),
            self.acceleration(axis).nm_per_s2(),
        ];
        let left = [highest.jerk, highest.acceleration];
        let mut shares = [0; 2];
        for (share, (left, all)) in shares.iter_mut().zip(left.into_iter().zip(all)) {
            *share = mul_div(left, 100, all.unsigned_abs().max(1));
        }
        (shares.into_iter().min() < Some(LEAST_SHARE)).then_some(shares)
    }

    /// κ in nanoseconds: how far a target lies ahead of its setpoint.
    fn ahead_ns(&self, axis: Axis) -> u64 {
        let unknown = 1000_u32.saturating_sub(self.drive_feed_forward(axis));
        self.part_of_lag_ns(axis, unknown)
    }

    /// So many tenths of a per cent of 1/Kv, in nanoseconds.
    fn part_of_lag_ns(&self, axis: Axis, share: u32) -> u64 {
        // Kv is in tenths of 1/s.
        u64::from(share)
            .wrapping_mul(NS / 100)
            .checked_div(u64::from(self.drive_gain(axis)))
            .unwrap_or(0)
    }

    /// What the highest speed of a target has beyond the highest of the axis, nm/s; `None` where targets have no limit.
    fn room_of_target(&self, axis: Axis) -> Option<Option<u64>> {
        let takes = self.drive_max_speed(axis).nm_per_min().unsigned_abs();
        let room = takes.checked_sub(self.fastest(axis));
        (takes != 0).then_some(room.map(|room| room / 60))
    }

    /// The largest jerk with which a target is at most `room` (nm/s) faster than its axis ever is.
    fn jerk_within(&self, axis: Axis, room: u64, highest: Highest) -> u64 {
        let Highest { acceleration, jerk } = highest;
        let ahead = self.ahead_ns(axis);
        if ahead == 0 {
            return jerk;
        }
        let smooth = self.part_of_lag_ns(axis, self.drive_feed_forward(axis));
        // An acceleration that is made of three setpoints is half a tick's jerk too large at most.
        let by_tick = mul_div(jerk, u64::from(self.tick_us()), 2_000_000);
        let room = room.saturating_sub(mul_div(by_tick, ahead, NS));
        let beyond = mul_div(acceleration, ahead, NS).saturating_sub(room);
        if beyond == 0 {
            return jerk;
        }
        // Jerk that builds the whole acceleration up in 1/Kv.
        let whole = mul_div(acceleration, NS, ahead.saturating_add(smooth));
        let low = mul_div(
            mul_div(room, NS, ahead),
            NS,
            (ahead >> 1).saturating_add(smooth),
        );
        if low <= whole {
            return low;
        }
        // (A − J·τ)² ≥ A² − 2·A·J·τ.
        let smoothed = mul_div(acceleration, smooth, NS);
        let twice = beyond.saturating_add(smoothed).saturating_mul(2);
        mul_div(acceleration, acceleration, twice).max(whole)
    }

    /// The highest speed of an axis in nm/min, with what is put in.
    fn fastest(&self, axis: Axis) -> u64 {
        let rapid = self.rapid(axis).nm_per_min().unsigned_abs();
        let highest = self.max_feed(axis).nm_per_min().unsigned_abs().max(rapid);
        let part = |has, speed: u64, of| match has {
            true => speed.div_ceil(of),
            false => 0,
        };
        // The curve through a table is up to 7/4 as steep as its steepest step.
        highest
            .saturating_add(part(self.has_backlash(axis), rapid, SPEED_PART))
            .saturating_add(part(
                self.has_pitch_errors(axis),
                highest.saturating_mul(2),
                STEEPEST,
            ))
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;
    use crate::params::{Entry, Part};

    /// The figures of docs/drives.md, for Z of the built-in machine with Kv 15.
    #[test]
    fn the_jerk_goes_before_the_acceleration() {
        let left = |number: u16, value: i64| {
            let mut params = Params::slant_bed();
            for (number, value) in [(9070, 150), (number, value)] {
                let entry = Entry::find(number, Some(Part::Axis(Axis::Z))).unwrap();
                params.set(entry, value).unwrap();
            }
            let Highest { acceleration, jerk } = params.highest(Axis::Z);
            (acceleration / 1_000_000, jerk / 1_000_000_000)
        };
        let metres_a_minute = 1_000_000_000;
        assert_eq!(left(9077, 0), (3_000, 60));
        assert_eq!(left(9077, 24 * metres_a_minute), (3_000, 60));
        assert_eq!(left(9077, 20 * metres_a_minute), (3_000, 29));
        let metres_a_second2 = 1_000_000_000;
        assert_eq!(left(9078, 8 * metres_a_second2), (3_000, 37));
        assert_eq!(left(9078, 4 * metres_a_second2), (2_000, 15));
    }
}
