//! From the strokes of a hole to what the tick needs. Planner work, with 128-bit divisions.
//!
//! Knows moves and limits; knows nothing of the tick or of what an operator may do.

use super::gear::Gear;
use crate::alarm::{Alarm, Span};
use crate::cycle::TapMove;
use crate::journal::TapHole;
use crate::motion::limits::{Limits, Pace, PathLimits};
use crate::motion::plan::{FEED_OVERRIDE_MAX, Refusal};
use crate::motion::profile::Ramp;
use crate::motion::rate::{PathRate, Rate};
use crate::motion::shape;
use crate::params::Params;
use crate::program::{Position, TapAxis};
use crate::units::{
    Axis, CentiRpm, Feed, Lead, Length, Millis, div_wide, mul_div, mul_wide, narrow_div, signed,
};

/// One stroke along the tap axis, from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stroke {
    /// How far the tap axis goes, signed.
    pub travel: Length,
    /// Rate at [`Rate::FULL`]: S times lead.
    pub nominal: PathRate,
    /// Its means and its largest rate.
    pub ramp: Ramp,
}

impl Stroke {
    /// The rate it reaches: the nominal one, or less where it is too short (a triangular profile) or its ramp would be
    /// longer than the profile holds.
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

    /// True where it is as fast as commanded for at least a tick. A thousandth less counts as that: the profile spreads
    /// what is left over of a tick.
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

/// A step in the hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TapStep {
    /// A stroke.
    Stroke(Stroke),
    /// Stand for so many ticks.
    Dwell(u32),
}

/// Steps a [`Tap`] can hold, pecks that are alike counted as one: infeed, one pair of pecks, back, last infeed, dwell, out,
/// and one to spare.
pub const TAP_STEPS: usize = 8;

/// Which part of a hole a [`Tap`] is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapPart {
    /// The tap is out of the hole at its end.
    pub closes: bool,
    /// It is the way out by itself (G30 P99), which begins in the hole.
    pub returns: bool,
}

/// The way from R into a hole and back, or the part of it that a K198 leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tap {
    /// What ties the spindle to the axis.
    pub gear: Gear,
    /// Where it starts.
    pub start: Position,
    /// The feed override acts on the strokes (5203.4).
    pub feed_override: bool,
    /// The hole, for the tap journal.
    pub hole: TapHole,
    /// Which part of the hole.
    pub part: TapPart,
    steps: [Option<TapStep>; TAP_STEPS],
    len: u8,
    /// The pair of steps that is done again, and how often.
    pair: u8,
    repeats: u32,
}

impl Tap {
    /// Nothing to do yet.
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

    /// Appends a step. False, and nothing changes, where there is no room.
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

    /// Two equal pairs at the end become one that is done once more. Only one pair of a tap is ever repeated.
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

    /// Step `index` of those that are stored.
    #[must_use]
    pub fn step(&self, index: u8) -> Option<&TapStep> {
        if index >= self.len {
            return None;
        }
        self.steps.get(usize::from(index)).and_then(Option::as_ref)
    }

    /// True where there is no step.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// How often the stored pair is done again.
    #[must_use]
    pub const fn repeats(&self) -> u32 {
        self.repeats
    }

    /// The step after `index` with `left` repeats to go, and the repeats then left.
    #[must_use]
    pub(super) const fn after(&self, index: u8, left: u32) -> (u8, u32) {
        if left > 0 && index == self.pair.wrapping_add(1) {
            (self.pair, left.wrapping_sub(1))
        } else {
            (index.saturating_add(1), left)
        }
    }
}

/// Plans one stroke of a tap that ends `travel` (signed, not zero) from where it begins.
///
/// Speed is S times lead, within 1430 and the axis' own limits; acceleration the axis' and the spindle's (1000 rpm in 5261
/// milliseconds, out of the hole 5271 where 5201.2 is 1; 0 means the axis alone) times lead; jerk the axis'. A ramp longer
/// than the profile holds makes the stroke slower, not another: it stays in phase, and [`Stroke::reaches_speed`] tells.
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

/// The quickest ramp; where it would be longer than the profile holds, that of a lower speed.
fn ramp(length: Length, nominal: PathRate, bounds: &mut PathLimits) -> Option<Ramp> {
    for _ in 0..128 {
        if let Some(ramp) = shape::ramp(length, nominal, bounds) {
            return Some(ramp);
        }
        let speed = bounds.speed.min(nominal);
        bounds.speed = Rate::percent(90).of(speed);
    }
    None
}

/// S times lead in a tick, to the nearest 1/256 nm.
fn rate(lead: Lead, speed: CentiRpm, tick_us: u32) -> PathRate {
    let (nm, turns) = lead.parts();
    let nm = mul_div(
        nm,
        u64::from(speed.get().unsigned_abs()),
        turns.saturating_mul(100),
    );
    let rate = PathRate::of_feed(Feed::from_nm_per_min(signed(nm)), tick_us);
    PathRate::from_raw(rate.raw().max(2))
}

/// 1000 rpm in `ramp_ms` milliseconds, times lead, in 2⁻³² nm per tick²; lacks what rounding adds to a difference of
/// setpoints. `None` for 0: no limit.
fn spindle_acceleration(lead: Lead, ramp_ms: u32, tick_us: u32) -> Option<u64> {
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
