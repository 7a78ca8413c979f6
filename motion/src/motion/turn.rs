//! The spindle in position mode, turned from one angle to another: from rest to rest, within its acceleration and jerk.
//!
//! The profile counts lengths, so a turn is a length here. The way is known in the tick alone, when the spindle stands; its
//! ramp is planned before, and is good for a way of any length.
//!
//! This module knows angles and ticks; it knows nothing of the encoder or the drive.

use super::limits::{Limits, PathLimits};
use super::plan::Refusal;
use super::profile::Ramp;
use super::rate::{PathRate, Rate};
use super::run::Run;
use super::tap::{ramp, rate, spindle_acceleration};
use crate::alarm::{Alarm, Span};
use crate::params::Params;
use crate::units::{Angle, CentiRpm, Lead, Length, Turns, mul_div};

/// A turn as a length: 2³⁰ nm.
const TURN_BITS: u32 = 30;

/// The highest speed on the way, in hundredths of a turn per minute [D507].
const MOST: u32 = 6_000;

/// The acceleration is built up in this time at least, in microseconds [D507].
const RISE_US: u64 = 50_000;

/// How the spindle goes to an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orientation {
    /// The angle within its turn, from the index.
    pub angle: Turns,
    nominal: PathRate,
    ramp: Ramp,
}

impl Orientation {
    /// To `angle`. The acceleration is that of 9004, or that of rigid taps where it is lower.
    ///
    /// # Errors
    /// [`Code::SpeedOutOfReach`](crate::alarm::Code::SpeedOutOfReach) where even the slowest ramp is too long.
    #[inline(never)]
    pub fn new(angle: Angle, params: &Params, limits: &Limits, span: Span) -> Result<Self, Alarm> {
        let tick_us = limits.tick_us();
        let lead = Lead::new(1 << TURN_BITS, 1).unwrap_or(Lead::LEAST);
        let ramp_ms = params.spindle_ramp_ms().max(params.tap_ramp_ms());
        let lowest = (1..=4)
            .filter(|gear| params.gear(*gear).is_some())
            .map(|gear| params.spindle_most(gear))
            .fold(params.spindle_max_rpm(), u32::min);
        let most = lowest.saturating_mul(100).min(MOST);
        let nominal = rate(lead, CentiRpm::new(most as i32), tick_us);
        let acceleration = spindle_acceleration(lead, ramp_ms, tick_us).unwrap_or(u64::MAX);
        let jerk = mul_div(acceleration, u64::from(tick_us), RISE_US);
        let mut bounds = PathLimits {
            speed: nominal,
            acceleration,
            jerk: jerk.max(1),
        };
        let half = Length::from_nm(1 << (TURN_BITS - 1));
        let Some(ramp) = ramp(half, nominal, &mut bounds) else {
            return Err(Refusal::OutOfReach(bounds.speed.feed(tick_us)).alarm(span));
        };
        let within = angle.udeg().rem_euclid(360_000_000);
        // Below 2⁶¹.
        let turns = (within << 32).wrapping_add(180_000_000) / 360_000_000;
        Ok(Self {
            angle: Turns::from_raw(turns),
            nominal,
            ramp,
        })
    }

    /// The way from a spindle that stands at `here`: the shorter one.
    #[must_use]
    pub const fn way(&self, here: Turns) -> Turns {
        // The part of a turn has 32 bits; with its sign, they are within half a turn.
        Turns::from_raw(self.angle.raw().wrapping_sub(here.raw()) as i32 as i64)
    }
}

/// A way under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurnRun {
    from: Turns,
    way: Turns,
}

impl TurnRun {
    /// Begins the way from `from`, at most two turns. `None` where there is no way, or the run is not at rest.
    pub(super) fn begin(from: Turns, way: Turns, by: &Orientation, run: &mut Run) -> Option<Self> {
        let length = Length::from_nm(way.raw().saturating_abs() >> (32 - TURN_BITS));
        let begun = length != Length::ZERO && run.begin_length(length, by.nominal, by.ramp);
        begun.then_some(Self { from, way })
    }

    /// One tick: the angle, and whether the spindle stands with nothing left to do. A way that was given up ends where the
    /// spindle comes to rest.
    pub(super) fn tick(&self, run: &mut Run, aborted: bool) -> (Turns, bool) {
        let progress = run.progress(Rate::FULL);
        if progress.done && !aborted {
            return (self.from + self.way, true);
        }
        // From 2⁻¹⁶ of a length's unit.
        let raw = (progress.travel.raw() >> (16 + TURN_BITS - 32)) as i64;
        let turned = match self.way.raw() < 0 {
            true => Turns::from_raw(raw.wrapping_neg()),
            false => Turns::from_raw(raw),
        };
        (self.from + turned, progress.done)
    }
}
