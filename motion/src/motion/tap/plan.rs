//! Plans the strokes of a hole for the tick. Background work, with 128-bit divisions.
//!
//! This module knows moves and limits; it knows nothing of the tick or of what an operator may do.

use super::gear::Gear;
use crate::alarm::{Alarm, Span};
use crate::call::{Position, TapAxis};
use crate::journal::TapHole;
use crate::motion::limits::{Limits, Pace, PathLimits};
use crate::motion::plan::{FEED_OVERRIDE_MAX, Refusal};
use crate::motion::profile::Ramp;
use crate::motion::rate::{PathRate, Rate};
use crate::motion::shape;
use crate::moves::TapMove;
use crate::params::Params;
use crate::units::{
    Axis, CentiRpm, Feed, Lead, Length, Millis, div_wide, mul_div, mul_wide, narrow_div, signed,
};

/// One stroke along the tap axis, from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stroke {
    /// Travel of the tap axis, signed.
    pub travel: Length,
    /// Rate at [`Rate::FULL`]: S times lead.
    pub nominal: PathRate,
    /// Its ramp: the two means and the largest rate.
    pub ramp: Ramp,
}

impl Stroke {
    /// The rate that the stroke reaches. This is less than the nominal rate if the stroke is too short (a triangular
    /// profile), or if its ramp would be longer than the profile holds.
    #[must_use]
    pub fn peak(&self) -> PathRate {
        let units = self.travel.nm().unsigned_abs().saturating_mul(256);
        let share = units
            .checked_div(u64::from(self.ramp.ticks()))
            .unwrap_or(0)
            .max(1);
        let share = PathRate::from_raw(u32::try_from(share).unwrap_or(u32::MAX));
        self.nominal.min(self.ramp.cap()).min(share)
    }

    /// True if the stroke runs at the commanded speed for at least a tick. A speed a thousandth lower also counts,
    /// because the profile spreads the remainder of a tick.
    #[must_use]
    pub fn reaches_speed(&self) -> bool {
        let (peak, nominal) = (u64::from(self.peak().raw()), u64::from(self.nominal.raw()));
        peak.saturating_mul(1000) >= nominal.saturating_mul(999)
    }

    /// Ticks from rest to rest at [`Rate::FULL`].
    #[must_use]
    pub fn duration_ticks(&self) -> u64 {
        shape::duration_ticks(self.travel.abs(), self.nominal, &self.ramp)
    }
}

/// A step in the hole of a tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapStep {
    /// A stroke.
    Stroke(Stroke),
    /// Stand still for this many ticks.
    Dwell(u32),
}

/// Number of steps a [`Tap`] can hold, with equal pecks counted as one: infeed, one pair of pecks, back, last infeed,
/// dwell, out, and one to spare.
pub const TAP_STEPS: usize = 8;

/// The part of a hole that a [`Tap`] covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapPart {
    /// The tap is out of the hole at the end of this part.
    pub closes: bool,
    /// This part is the way out alone (G30 P99), which begins in the hole.
    pub returns: bool,
}

/// The way from R into the hole and back, or the part of this way that a K198 leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tap {
    /// The gear between axis and spindle.
    pub gear: Gear,
    /// Position at which the tap starts.
    pub start: Position,
    /// The feed override acts on the strokes (5203.4).
    pub feed_override: bool,
    /// The hole, for the tap journal.
    pub hole: TapHole,
    /// The part of the hole that this tap covers.
    pub part: TapPart,
    steps: [Option<TapStep>; TAP_STEPS],
    len: u8,
    /// The pair of steps that is repeated, and the number of repeats.
    pair: u8,
    repeats: u32,
}

impl Tap {
    /// A tap without steps.
    #[must_use]
    pub const fn new(gear: Gear, hole: TapHole, start: Position, feed_override: bool) -> Self {
        Self {
            gear,
            start,
            feed_override,
            hole,
            part: TapPart {
                closes: false,
                returns: false,
            },
            steps: [None; TAP_STEPS],
            len: 0,
            pair: 0,
            repeats: 0,
        }
    }

    /// Appends a step. Returns false and changes nothing if there is no room.
    #[must_use]
    pub fn push(&mut self, step: TapStep) -> bool {
        let Some(place) = self.steps.get_mut(usize::from(self.len)) else {
            return false;
        };
        *place = Some(step);
        self.len = self.len.saturating_add(1);
        self.fold();
        true
    }

    /// Merges two equal pairs at the end into one pair with one more repeat. A tap repeats only one pair.
    fn fold(&mut self) {
        let Some(first) = self.len.checked_sub(4) else {
            return;
        };
        let at = |offset: u8| self.step(first.wrapping_add(offset));
        let alike = at(0) == at(2) && at(1) == at(3);
        if alike && (self.repeats == 0 || self.pair == first) {
            self.pair = first;
            self.repeats = self.repeats.saturating_add(1);
            self.len = first.wrapping_add(2);
        }
    }

    /// Stored step number `index`.
    #[must_use]
    pub fn step(&self, index: u8) -> Option<&TapStep> {
        if index >= self.len {
            return None;
        }
        self.steps.get(usize::from(index)).and_then(Option::as_ref)
    }

    /// True if the tap has no step.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Number of times the stored pair is repeated.
    #[must_use]
    pub const fn repeats(&self) -> u32 {
        self.repeats
    }

    /// The step after `index` when `left` repeats remain, and the repeats that then remain.
    #[must_use]
    pub(super) const fn after(&self, index: u8, left: u32) -> (u8, u32) {
        if left > 0 && index == self.pair.wrapping_add(1) {
            (self.pair, left.wrapping_sub(1))
        } else {
            (index.saturating_add(1), left)
        }
    }
}

/// Plans one stroke of a tap. The stroke ends `travel` (signed, not zero) from its start.
///
/// The speed is S times lead, within 1430 and the axis' own limits. The acceleration is within the axis' limit and
/// within the spindle's acceleration times lead. The spindle's acceleration is 1000 rpm in 5261 milliseconds, or in
/// 5271 milliseconds out of the hole if 5201.2 is 1; 0 means that the axis alone decides. The jerk is the axis'. If a
/// ramp is longer than the profile holds, the same stroke becomes slower. It stays in phase, and
/// [`Stroke::reaches_speed`] tells that it is slower.
///
/// # Errors
/// [`Code::MoveTooFar`](crate::alarm::Code::MoveTooFar);
/// [`Code::SpeedOutOfReach`](crate::alarm::Code::SpeedOutOfReach) where even the slowest ramp is too long.
pub fn stroke(
    tap: &TapMove,
    travel: Length,
    params: &Params,
    limits: &Limits,
    span: Span,
) -> Result<Stroke, Alarm> {
    if !travel.is_in_range() {
        return Err(Refusal::TooFar.alarm(span));
    }
    let axis = match tap.axis {
        TapAxis::X => Axis::X,
        TapAxis::Z => Axis::Z,
    };
    let tick_us = limits.tick_us();
    let nominal = rate(tap.lead, tap.speed, tick_us);
    let mut bounds = limits.of_axis(axis, Pace::Cutting);
    let ramp_ms = if tap.outward && params.tap_retract_ramp_differs() {
        params.tap_retract_ramp_ms()
    } else {
        params.tap_ramp_ms()
    };
    if let Some(by_spindle) = spindle_acceleration(tap.lead, ramp_ms, tick_us) {
        bounds.acceleration = bounds.acceleration.min(by_spindle);
    }
    let top = if params.tap_feed_override() {
        let most = params.tap_max_rpm().min(params.spindle_max_rpm());
        let most = i32::try_from(most.saturating_mul(100)).unwrap_or(i32::MAX);
        FEED_OVERRIDE_MAX
            .of(nominal)
            .min(rate(tap.lead, CentiRpm::new(most), tick_us).max(nominal))
    } else {
        nominal
    };
    bounds.speed = bounds.speed.min(top);
    let Some(ramp) = ramp(travel.abs(), nominal, &mut bounds) else {
        return Err(Refusal::OutOfReach(bounds.speed.feed(tick_us)).alarm(span));
    };
    Ok(Stroke {
        travel,
        nominal,
        ramp,
    })
}

/// The quickest ramp, or the ramp of a lower speed if the quickest is longer than the profile holds.
pub(in crate::motion) fn ramp(
    length: Length,
    nominal: PathRate,
    bounds: &mut PathLimits,
) -> Option<Ramp> {
    for _ in 0..128 {
        if let Some(ramp) = shape::ramp(length, nominal, bounds) {
            return Some(ramp);
        }
        let speed = bounds.speed.min(nominal);
        bounds.speed = Rate::percent(90).of(speed);
    }
    None
}

/// S times lead per tick, to the nearest 1/256 nm.
pub(in crate::motion) fn rate(lead: Lead, speed: CentiRpm, tick_us: u32) -> PathRate {
    let (nm, turns) = lead.parts();
    let nm = mul_div(
        nm,
        u64::from(speed.get().unsigned_abs()),
        turns.saturating_mul(100),
    );
    let rate = PathRate::of_feed(Feed::from_nm_per_min(signed(nm)), tick_us);
    PathRate::from_raw(rate.raw().max(2))
}

/// 1000 rpm in `ramp_ms` milliseconds, times lead, in 2⁻³² nm per tick². The result is lower by the amount that
/// rounding adds to a difference of setpoints. `None` for 0: no limit.
pub(in crate::motion) fn spindle_acceleration(
    lead: Lead,
    ramp_ms: u32,
    tick_us: u32,
) -> Option<u64> {
    if ramp_ms == 0 {
        return None;
    }
    // 1000 / 60 turns a second in ramp_ms / 1000 seconds; the tick is tick_us / 10⁶ seconds.
    let (nm, turns) = lead.parts();
    let square = u64::from(tick_us).wrapping_mul(u64::from(tick_us));
    let ramp = u64::from(ramp_ms).wrapping_mul(60_000_000);
    let acceleration = div_wide(mul_wide(u128::from(nm) << 32, square), turns);
    let acceleration = narrow_div(acceleration, ramp);
    Some(acceleration.saturating_sub(4 << 16).max(1))
}

/// A dwell in whole ticks, rounded up.
#[must_use]
pub fn dwell_ticks(time: Millis, tick_us: u32) -> u32 {
    let ticks = u64::from(time.get())
        .saturating_mul(1000)
        .div_ceil(u64::from(tick_us.max(1)));
    u32::try_from(ticks).unwrap_or(u32::MAX)
}
