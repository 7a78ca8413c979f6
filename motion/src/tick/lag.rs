//! How far the target of a drive has to be ahead of its setpoint, so that the axis is where the setpoint says: the inverse
//! of the drive's lag (9070, 9071).
//!
//! A position loop with the gain Kv and a share ff of speed known beforehand moves its axis by `z' = Kv·(y − z) + ff·y'`
//! behind its targets y. So the axis z is at the setpoint r where `y = r + r'/Kv`, smoothed over the time ff/Kv:
//!
//! ```text
//! u = (3·r − 4·r₋₁ + r₋₂) · 1/(2·T·Kv)      r'/Kv of the last three setpoints: exact up to steady acceleration
//! x = r + u
//! y = ρ·y₋₁ + (1 − ρ)·(x + x₋₁)/2           late by D = ff/(Kv·T) periods, exactly: ρ = (D − ½)/(D + ½)
//! y = (1 − D)·x + D·x₋₁                     the same where D is below a half
//! ```
//!
//! Kept is y − r, seen from the newest setpoint. What a drive is merely late by (setpoints that wait, interpolation) is not
//! taken off here: setpoints are calculated for the instant at which they act (9003). At rest target and setpoint are the
//! same. In the tick: products of 32 bits, no division.
//!
//! Must not know what an axis is moved for, or its drive's increments.

use crate::params::Params;
use crate::units::{Axis, Turns};

/// Binary places of what a target is ahead by: a gain of 5 /s at a tick of 250 µs has room in 32 bits.
const PLACES: u32 = 22;

/// Binary places of a share.
const SHARE: u32 = 31;

/// Gain and tick are tenths per second and microseconds: their product is this where the gain times the tick is one.
const ONE: u64 = 10_000_000;

/// What the speed that a drive knows beforehand does to its targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Smoothing {
    None,
    /// ρ.
    Kept(i32),
    /// D.
    Delayed(i32),
}

/// What the parameters say of the lag of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lag {
    /// 1/(2·T·Kv), with [`PLACES`].
    gain: i32,
    smoothing: Smoothing,
}

impl Lag {
    /// `gain`: tenths per second, 0 where the lag is not known; `forward`: tenths of a per cent.
    fn of(gain: u32, forward: u32, tick_us: u32) -> Option<Self> {
        // T·Kv, and 2·D·T·Kv, which is twice the share known beforehand.
        let pace = u64::from(gain).saturating_mul(u64::from(tick_us));
        let delay = u64::from(forward).saturating_mul(2 * ONE / 1000);
        let smoothing = if delay == 0 {
            Smoothing::None
        } else if delay >= pace {
            let sum = delay.saturating_add(pace);
            Smoothing::Kept(share(delay.saturating_sub(pace), sum)?)
        } else {
            Smoothing::Delayed(share(delay, pace.saturating_mul(2))?)
        };
        let gain = ((ONE / 2) << PLACES).checked_div(pace)?;
        Some(Self {
            gain: i32::try_from(gain).unwrap_or(i32::MAX),
            smoothing,
        })
    }

    /// Of an axis; `None` where its lag is not known.
    pub(super) fn of_axis(params: &Params, axis: Axis) -> Option<Self> {
        Self::of(
            params.drive_gain(axis),
            params.drive_feed_forward(axis),
            params.tick_us(),
        )
    }

    /// Of the spindles in position mode.
    pub(super) fn of_spindle(params: &Params) -> Option<Self> {
        Self::of(
            params.spindle_drive_gain(),
            params.spindle_drive_feed_forward(),
            params.tick_us(),
        )
    }
}

/// `n / d`, below one, as a share; `None` for `d` of zero.
fn share(n: u64, d: u64) -> Option<i32> {
    // Both are below 2³³.
    i32::try_from((n << SHARE).checked_div(d)?).ok()
}

/// The setpoints of one drive, and how far its target is ahead of them. A setpoint changes by less than 2²⁴ from one tick
/// to the next, as the parameters' checks demand of the fastest motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Inverse {
    lag: Lag,
    /// The last setpoint.
    last: i64,
    /// Its change from the one before.
    change: i32,
    /// u of the last setpoint, with [`PLACES`].
    lead: i64,
    /// How far the last target is ahead of the last setpoint, with [`PLACES`].
    ahead: i64,
}

impl Inverse {
    /// A drive at rest at zero.
    pub(super) const fn new(lag: Lag) -> Self {
        Self {
            lag,
            last: 0,
            change: 0,
            lead: 0,
            ahead: 0,
        }
    }

    /// The axis rests here, whatever was before.
    pub(super) const fn rest(&mut self, at: i64) {
        *self = Self::new(self.lag);
        self.last = at;
    }

    /// How far the target is ahead of the next setpoint.
    #[inline(never)]
    pub(super) const fn ahead(&mut self, setpoint: i64) -> i64 {
        let change = setpoint.wrapping_sub(self.last) as i32;
        let slope = change.wrapping_mul(3).wrapping_sub(self.change);
        let lead = product(slope, self.lag.gain);
        let way = (change as i64) << PLACES;
        let ahead = match self.lag.smoothing {
            Smoothing::None => lead,
            Smoothing::Kept(share) => {
                let mean = lead.wrapping_add(self.lead).wrapping_sub(way) >> 1;
                let kept = self.ahead.wrapping_sub(way).wrapping_sub(mean);
                mean.wrapping_add(part(share, kept))
            }
            Smoothing::Delayed(share) => {
                let before = self.lead.wrapping_sub(way);
                lead.wrapping_add(part(share, before.wrapping_sub(lead)))
            }
        };
        (self.last, self.change) = (setpoint, change);
        (self.lead, self.ahead) = (lead, ahead);
        ahead.wrapping_add(1 << (PLACES - 1)) >> PLACES
    }

    /// The target of a spindle for its next angle.
    pub(super) fn angle(&mut self, setpoint: Turns) -> Turns {
        // Half a turn in a tick has to be below 2²⁴.
        let ahead = self.ahead(setpoint.raw() >> FINER);
        Turns::from_raw(setpoint.raw().wrapping_add(ahead << FINER))
    }

    /// The spindle rests here.
    pub(super) const fn rest_at(&mut self, angle: Turns) {
        self.rest(angle.raw() >> FINER);
    }
}

/// Binary places of an angle that are not needed to tell how far the target is ahead.
const FINER: u32 = 8;

const fn product(a: i32, b: i32) -> i64 {
    (a as i64).wrapping_mul(b as i64)
}

/// A share, which is not negative, of a number: two products of 32 bits.
const fn part(share: i32, of: i64) -> i64 {
    let rest = (of as u32 as u64).wrapping_mul(share as u64) >> SHARE;
    (product((of >> 32) as i32, share) << (32 - SHARE)).wrapping_add(rest as i64)
}

/// The drives of the axes, where the lag of one of them is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lags([Option<Inverse>; 3]);

impl Lags {
    /// `None` where no lag is known.
    pub(super) fn of(lags: [Option<Lag>; 3]) -> Option<Self> {
        let any = lags.iter().any(Option::is_some);
        any.then(|| Self(lags.map(|lag| lag.map(Inverse::new))))
    }

    /// An axis that rests has another place from now on.
    pub(super) const fn rest(&mut self, axis: Axis, place: i64) {
        let [x, z, c] = &mut self.0;
        let inverse = match axis {
            Axis::X => x,
            Axis::Z => z,
            Axis::C => c,
        };
        if let Some(inverse) = inverse {
            inverse.rest(place);
        }
    }

    /// The targets for setpoints, in nanometres (C: millionths of a degree). A drive that does not follow yet is told where
    /// its axis is.
    #[inline(never)]
    pub(super) fn targets(&mut self, mut places: [i64; 3], follow: [bool; 3]) -> [i64; 3] {
        for ((inverse, place), follows) in self.0.iter_mut().zip(&mut places).zip(follow) {
            let Some(inverse) = inverse else { continue };
            if follows {
                *place = place.wrapping_add(inverse.ahead(*place));
            } else {
                inverse.rest(*place);
            }
        }
        places
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    /// Microseconds of a tick, and periods of a trial.
    const TICK_US: u32 = 1000;
    const PERIODS: usize = 4000;

    /// An axis whose drive goes straight from target to target, exactly: `z' = Kv·(y − z) + ff·y'`. `follow` gets the
    /// place of the axis at the end of each period, a period after the target was sent.
    struct Driven {
        gain_per_tick: f64,
        forward: f64,
        place: f64,
        target: f64,
    }

    impl Driven {
        fn follow(&mut self, target: f64) -> f64 {
            // A ramp of slope s is followed by s·(1 − ff)/Kv behind; what is left of the error decays.
            let slope = target - self.target;
            let lag = |at: f64| at - slope * (1.0 - self.forward) / self.gain_per_tick;
            let error = self.place - lag(self.target);
            self.place = lag(target) + error * (-self.gain_per_tick).exp();
            self.target = target;
            self.place
        }
    }

    /// Setpoints of jerk-limited motion at random, whole nanometres, at rest before and after.
    fn setpoints(seed: u64) -> Vec<i64> {
        let mut state = seed;
        let mut random = |below: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) % below
        };
        let mut wanted = 0.0;
        let mut means = [[0.0; 40]; 2];
        let mut place = 0.0;
        (0..PERIODS)
            .map(|k| {
                if k % 200 == 0 {
                    // At most 200 mm/s, in nm per tick; means of 40 ticks twice bound acceleration and jerk.
                    wanted = if k + 600 < PERIODS {
                        random(400_000) as f64 - 200_000.0
                    } else {
                        0.0
                    };
                }
                let mut speed = wanted;
                for mean in &mut means {
                    mean[k % 40] = speed;
                    speed = mean.iter().sum::<f64>() / 40.0;
                }
                place += speed;
                place.round() as i64
            })
            .collect()
    }

    #[test]
    fn an_axis_whose_lag_is_known_is_where_its_setpoint_is() {
        leadscrew_seed::volume(70, |seed| {
            for (gain, forward) in [
                (150, 0),
                (300, 0),
                (1000, 0),
                (300, 5),
                (300, 15),
                (300, 500),
                (150, 1000),
                (1000, 900),
                (50, 1000),
            ] {
                let lag = Lag::of(gain, forward, TICK_US).unwrap();
                let mut inverse = Inverse::new(lag);
                let mut axis = Driven {
                    gain_per_tick: f64::from(gain) / 10_000.0,
                    forward: f64::from(forward) / 1000.0,
                    place: 0.0,
                    target: 0.0,
                };
                let setpoints = setpoints(seed);
                let mut worst = 0.0_f64;
                for setpoint in &setpoints {
                    let place = axis.follow((*setpoint + inverse.ahead(*setpoint)) as f64);
                    worst = worst.max((place - *setpoint as f64).abs());
                }
                // Uncorrected it is up to 200 mm/s over Kv behind: 13 mm at 15 /s. What is left: a·T²/12, since a
                // drive goes straight from target to target (a: 10 m/s²), and j·T²/(3·Kv), of the last three
                // setpoints (j: 250 m/s³).
                let bound = 1_000.0 + 833_333.0 / f64::from(gain);
                assert!(worst < bound, "gain {gain}, forward {forward}: {worst} nm");
                // What is kept of the way decays with the time ff/Kv, 0.2 s at most here.
                let rest = *setpoints.last().unwrap();
                let last = (0..PERIODS).map(|_| inverse.ahead(rest)).last();
                assert_eq!(last, Some(0), "gain {gain}, forward {forward}");
            }
        });
    }
}
