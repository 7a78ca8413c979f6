//! The plan of an ordinary tap: every figure the tick needs, from the call, the axis' limits and the spindle's ramp.
//! Background work.

use super::course::Course;
use super::law::Law;
use super::turner::Turner;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{Hand, TapAxis, TapCall, TapCycle};
use crate::motion::ease::{Bounds, Ease};
use crate::motion::lead::{speed_of, turns_of};
use crate::motion::limits::bounds;
use crate::motion::tap::{Gear, dwell_ticks};
use crate::motion::wide::{mul_div_up, root_mul_div_up};
use crate::moves::TapMove;
use crate::params::Params;
use crate::units::{Axis, CentiRpm, Lead, Length, Ticks, TurnRate, mul_div, signed};

/// The spindle's ramps may take one part in this many of the axis' acceleration.
const RAMP_SHARE: u64 = 16;

/// Limits for the rounding before the bottom, in nanometres. Within them the rounding is as short as the jerk allows.
const SHORTEST_BRAKE: u64 = 5_000;
const LONGEST_BRAKE: u64 = 50_000;

/// A whole hole of an ordinary tap, ready for [`FloatRun`](super::FloatRun).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FloatPlan {
    pub(super) span: Span,
    pub(super) law: Law,
    pub(super) course: Course,
    pub(super) turner: Turner,
    /// The speed at which the spindle goes in, 2⁻³² turns per tick: S, or the highest speed from which it can stop at
    /// the first depth.
    pub(super) entry: i64,
    pub(super) entry_rate: TurnRate,
    /// The spindle must have had the entry speed for this many ticks, so that it is no longer slowing down to it
    /// [D153].
    pub(super) settling: u32,
    /// How far the spindle turns on after a turning point at which the axis must be at rest, 2⁻³² turns.
    pub(super) beyond: i64,
    /// Angle from R, outwards, to where the axis is at rest at R, 2⁻³² turns.
    pub(super) out: i64,
    /// The spindle may not turn faster than this (magnitude).
    pub(super) speed_limit: TurnRate,
    /// A spindle slower than this counts as standing.
    pub(super) standing: TurnRate,
    /// Parameter 5275.
    pub(super) lag: Ticks,
    /// `corner`: the square of the speed that the axis may still have at the rounding before the bottom. `room`: twice
    /// the axis' acceleration, per nanometre. Both in (nm/16 per tick)².
    pub(super) corner: u64,
    pub(super) room: u32,
    /// If the spindle does not brake, the axis brakes by this much each tick, 2⁻¹⁶ nm per tick².
    pub(super) brake: i64,
}

impl FloatPlan {
    /// Plans the holes of an ordinary tapping call for a tap of this hand. All holes of a call are alike.
    ///
    /// # Errors
    /// The spindle stands ([`Code::TapSpindleStands`]); the lead is impossible ([`Code::TapFeed`]); the hole is too
    /// shallow to get onto the lead at this speed ([`Code::StrokeTooShortForSpeed`]).
    pub fn new(call: &TapCall, hand: Hand, span: Span, params: &Params) -> Result<Self, Alarm> {
        if call.speed.get() <= 0 {
            return Err(standing(call, span, params));
        }
        let lead = call.lead.value;
        let axis = axis_of(call.axis);
        let limits = bounds(params, axis);
        let turner = turner(call.axis, lead, call.speed, params);
        let total = (call.bottom.value - call.level.value).abs();
        let tick_us = u64::from(params.tick_us());
        let per_tick2 =
            |value: u64| mul_div(value, tick_us.saturating_mul(tick_us), 1_000_000_000_000);

        // In a hole of this depth the spindle cannot get faster, in or out.
        let angle = turns_of(lead, fine(total)).raw();
        let fastest = turner.stopping(angle.wrapping_mul(2)).min(turner.top());
        let margin = u64::from(params.spindle_variation_percent()).saturating_add(100);
        let nominal = mul_div_up(turner.rate(fastest).raw() as u64, margin, 100);
        let speed_limit = mul_div_up(turner.rate(turner.top()).raw() as u64, margin, 100);
        let speed = speed_of(lead, nominal);
        let share = limits.acceleration / RAMP_SHARE;
        let joining = Bounds {
            acceleration: limits.acceleration.saturating_sub(share),
            ..limits
        };
        let join = Ease::new(speed, speed, &joining);
        let lag = u64::from(params.tap_lag_cycles()).saturating_mul(tick_us);
        let foreseen = lag.saturating_add(u64::from(params.latency_us(axis)));
        let round = rounding(&turner, lead, limits.jerk, tick_us, foreseen);
        let brake = Ease::of(round, round >> 1);
        if join.half().wrapping_add(brake.half()) > fine(total) {
            let letter = match call.axis {
                TapAxis::X => b'X',
                TapAxis::Z => b'Z',
            };
            let alarm = Alarm::new(Code::StrokeTooShortForSpeed, span).word(letter);
            return Err(alarm.with([
                Arg::Length(total),
                Arg::Length(Length::from_nm(join.half_nm())),
                Arg::Length(Length::from_nm(brake.half_nm())),
                Arg::Rpm(TurnRate::from_raw(signed(nominal)).rpm()),
            ]));
        }
        let inward = (call.bottom.value - call.level.value).signum();
        let Some(gear) = Gear::new(call.axis, call.level.value, inward, lead, hand) else {
            return Err(Alarm::new(Code::TapFeed, call.lead.span).word(b'F'));
        };
        let law = Law::new(&gear, hand, lead, total, &join, &brake);

        // The spindle turns on a quarter further than the rounding. So the axis is at rest at the bottom, and the
        // holder takes up only little more.
        let round = Length::from_nm(brake.half_nm());
        let beyond = turns_of(lead, fine(round)).raw();
        let beyond = beyond.wrapping_add(beyond >> 2);
        let course = Course::new(total, &call.form, dwell_ticks(call.dwell, params.tick_us()));
        let first = course.first();
        let mut way = law.turns_to(first.depth).saturating_add(law.join_turns());
        if course.is_bottom(&first) {
            way = way.saturating_add(beyond);
        }
        let stopping = turner.stopping(way);
        let entry = stopping.min(turner.top());
        // A measured speed up to a sixteenth too fast counts as the entry speed, and ripple adds to this. If the
        // spindle cannot stop from an eighth above the entry speed, its ramp over this eighth must be over before the
        // hole begins.
        let settling = if stopping < entry.wrapping_add(entry >> 3) {
            let eighths = tick_us.saturating_mul(800);
            let centi_rpm = u64::from(turner.centi_rpm(entry).get() as u32);
            mul_div_up(centi_rpm, u64::from(params.spindle_ramp_ms()), eighths)
        } else {
            0
        };
        // ¾ of the axis' acceleration.
        let braking = limits.acceleration.saturating_sub(limits.acceleration >> 2);
        let braking = per_tick2(braking);
        Ok(Self {
            span,
            law,
            course,
            turner,
            entry,
            entry_rate: turner.rate(entry),
            settling: u32::try_from(settling).unwrap_or(u32::MAX),
            beyond,
            out: law.join_turns().wrapping_add(beyond),
            speed_limit: TurnRate::from_raw(signed(speed_limit)),
            standing: standing_rate(params),
            lag: Ticks::whole(u16::try_from(params.tap_lag_cycles()).unwrap_or(u16::MAX)),
            corner: mul_div(braking, (brake.half_nm() as u64) << 8, 1),
            room: u32::try_from(mul_div(braking, 512, 1)).unwrap_or(u32::MAX),
            brake: signed(braking << 16).max(1),
        })
    }

    /// The axis that travels.
    #[must_use]
    pub const fn axis(&self) -> TapAxis {
        self.law.gear().axis()
    }

    /// The way from R to where the axis is on the lead. The material may begin there, for a thread without a fault and
    /// a holder without work.
    #[must_use]
    pub fn lead_in(&self) -> Length {
        let (join, _) = self.law.halves();
        Length::from_nm(join >> 16)
    }

    /// How far the axis is ahead of the lead while it joins and leaves the lead: the largest value, at R.
    #[must_use]
    pub fn ahead(&self) -> Length {
        let (way, _) = self.law.at(0);
        Length::from_nm(way.wrapping_add(1 << 15) >> 16)
    }

    /// How far the spindle turns on at the bottom while the axis stands there, as a length that the holder takes up.
    #[must_use]
    pub fn past_bottom(&self) -> Length {
        let (_, round) = self.law.halves();
        Length::from_nm(round.wrapping_add(round >> 2) >> 16)
    }

    /// The speed at which the spindle goes in: S, or less if the spindle could not stop from S at the first depth.
    #[must_use]
    pub fn entry_speed(&self) -> CentiRpm {
        self.turner.centi_rpm(self.entry)
    }

    /// The greatest speed of a stroke over `travel`, from rest to rest.
    #[must_use]
    pub fn peak(&self, travel: Length) -> CentiRpm {
        let way = self.law.turns_to(travel);
        self.turner.centi_rpm(self.turner.peak(way))
    }
}

/// About how many ticks a stroke of an ordinary tap takes, with the ramps for which the spindle is planned.
#[must_use]
pub fn float_ticks(tap: &TapMove, travel: Length, params: &Params) -> u64 {
    let speed = CentiRpm::new(tap.speed.get().saturating_abs());
    if speed.get() == 0 {
        return 0;
    }
    let turner = turner(tap.axis, tap.lead, speed, params);
    turner.ticks(
        turns_of(tap.lead, fine(travel.abs())).raw(),
        !tap.opens,
        !tap.closes,
    )
}

fn turner(axis: TapAxis, lead: Lead, speed: CentiRpm, params: &Params) -> Turner {
    let limits = bounds(params, axis_of(axis));
    Turner::new(speed, lead, limits.acceleration / RAMP_SHARE, params)
}

const fn axis_of(axis: TapAxis) -> Axis {
    match axis {
        TapAxis::X => Axis::X,
        TapAxis::Z => Axis::Z,
    }
}

fn standing(call: &TapCall, span: Span, params: &Params) -> Alarm {
    let code = match params.tap_m_code() {
        0 => 29,
        code => i64::from(code),
    };
    // The G code in tenths.
    let name = match call.cycle {
        TapCycle::G84 => 840,
        TapCycle::G88 => 880,
    };
    let args = [Arg::GCode(name), Arg::Int(code), Arg::None, Arg::None];
    Alarm::new(Code::TapSpindleStands, span).with(args)
}

/// Parameter 5276, in tenths of a turn a minute. 0 stands for a quarter of a turn a minute; no lower speed can be told
/// from standing.
fn standing_rate(params: &Params) -> TurnRate {
    const SLOWEST: u64 = (1 << 32) / 240;
    let rate = mul_div(u64::from(params.tap_reversal_speed()), 1 << 32, 600).max(SLOWEST);
    TurnRate::from_raw(signed(rate))
}

/// Half of the rounding before the bottom, in nanometres. The rounding is the spindle's last way at its planned ramp;
/// over this way the axis rounds off within its jerk.
///
/// The angle is foreseen for so many microseconds, as if the spindle kept its speed. So at the bottom the axis still has
/// the speed that the spindle loses in this time, and more right after the spindle has begun to brake: three times that
/// is reckoned with [D524].
fn rounding(turner: &Turner, lead: Lead, jerk: u64, tick_us: u64, foreseen: u64) -> u64 {
    // β = ramp · lead, in nm/s²; (4β)³ / j².
    let square = tick_us.saturating_mul(tick_us);
    let per_second2 = mul_div(turner.gentle() as u64, 1_000_000_000_000, square);
    let ramp = speed_of(lead, per_second2);
    let four = ramp.saturating_mul(4);
    let by_jerk = mul_div(mul_div(four, four, jerk.max(1)), four, jerk.max(1));
    // √(v³ / j).
    let speed = mul_div(ramp, foreseen.saturating_mul(3), 1_000_000);
    let by_speed = root_mul_div_up(speed.saturating_mul(speed), speed, jerk.max(1));
    by_jerk.max(by_speed).clamp(SHORTEST_BRAKE, LONGEST_BRAKE)
}

const fn fine(length: Length) -> i64 {
    length.nm().wrapping_shl(16)
}
