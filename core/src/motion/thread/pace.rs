//! How fast a pass goes, and what that makes of its ends: the ramps of run-in, run-out and retract.

use super::plan::{Ramp, whole};
use super::ramp::{DIAGONAL, Machine, Slope, seen, slope};
use super::shape::Shape;
use crate::alarm::{Alarm, Arg, Code};
use crate::motion::ease::{Bounds, Ease, Fine};
use crate::motion::wide::mul_div_up;
use crate::params::Params;
use crate::units::{Axis, Feed, Lead, Rpm, TurnRate, mul_div};

/// Percent of the spindle's speed for which a run-out is tried that does not fit with the whole margin.
const MARGINS: [u64; 4] = [110, 105, 102, 100];

/// The speed a pass is planned for.
pub(super) struct Pace {
    /// The faster of commanded and measured speed, magnitude.
    pub nominal: TurnRate,
    /// Percent of it that the plan leaves room for.
    pub margin: u64,
    /// That much of it.
    pub limit: TurnRate,
    /// M04.
    pub reverse: bool,
}

impl Pace {
    /// The pace of a pass, its feeds checked.
    #[inline(never)]
    pub fn new(
        shape: &Shape,
        params: &Params,
        commanded: Rpm,
        measured: TurnRate,
    ) -> Result<Self, Alarm> {
        if commanded == Rpm::STOPPED && measured == TurnRate::ZERO {
            return Err(shape.alarm(Code::SpindleStopped));
        }
        let reverse = if commanded == Rpm::STOPPED {
            measured.is_negative()
        } else {
            commanded.get() < 0
        };
        let nominal = TurnRate::of_rpm(commanded).abs().max(measured.abs());
        let margin = u64::from(params.spindle_variation_percent()).saturating_add(100);
        let limit = mul_div_up(nominal.raw().unsigned_abs(), margin, 100);
        let pace = Self {
            nominal,
            margin,
            limit: TurnRate::from_raw(i64::try_from(limit).unwrap_or(i64::MAX)),
            reverse,
        };

        // nm/min, exact where the command decides, so that a feed that is just reached is no alarm.
        let lead = shape.thread.lead;
        let asked = if nominal > measured.abs() || measured == TurnRate::ZERO {
            mul_div(lead_nm(lead), u64::from(commanded.abs()), lead_turns(lead))
        } else {
            let per_second = mul_div(
                lead_nm(lead),
                nominal.raw().unsigned_abs(),
                lead_turns(lead),
            );
            mul_div(per_second, 60, 1 << 32)
        };
        let (long, short) = axes(shape);
        let checks = [
            (long, asked, params.max_feed(long)),
            (long, mul_div(asked, margin, 100), params.rapid(long)),
            (
                short,
                mul_div(asked, shape.taper.unsigned_abs(), DIAGONAL),
                params.max_feed(short),
            ),
        ];
        for (axis, feed, most) in checks {
            let feed = Feed::from_nm_per_min(i64::try_from(feed).unwrap_or(i64::MAX));
            if feed > most {
                let alarm = shape.alarm(Code::LeadTooFast).word(b'F');
                return Err(alarm.with([
                    Arg::Letter(axis.letter()),
                    Arg::Feed(feed),
                    Arg::Feed(most),
                    Arg::Rpm(nominal.rpm()),
                ]));
            }
        }
        Ok(pace)
    }

    /// The axes at `percent` of the nominal speed.
    pub fn machine(&self, shape: &Shape, params: &Params, percent: u64) -> Machine {
        let (long, short) = axes(shape);
        let rate = mul_div_up(self.nominal.raw().unsigned_abs(), percent, 100);
        Machine {
            speed: travel(shape.thread.lead, rate),
            long: bounds(params, long),
            short: bounds(params, short),
            short_speed: params.max_feed(short).nm_per_min().unsigned_abs() / 60,
            taper: shape.taper.unsigned_abs(),
        }
    }

    /// The join, and the run-in that brings the short axis from beside the line's extension onto it: a ramp mirrored.
    #[inline(never)]
    pub fn run_in(&self, shape: &Shape, machine: &Machine) -> Result<(Ease, Ramp), Alarm> {
        if shape.run_in == 0 {
            return Ok((machine.plain(), Ramp::NONE));
        }
        let corner = machine.corner(shape.run_in_rise, shape.run_in);
        if !corner.whole {
            let alarm = shape.alarm(Code::RunInTooFast).word(b'E');
            return Err(alarm.with([
                Arg::Length(whole(machine.way_needed(shape.run_in_rise))),
                Arg::Rpm(self.nominal.rpm()),
                Arg::None,
                Arg::None,
            ]));
        }
        let ramp = Ramp {
            slope: signed(corner.slope, shape.run_in_rise),
            ease: corner.ease,
            at: shape.run_in,
        };
        Ok((corner.long, ramp))
    }

    /// The brake and the run-out; where the short axis cannot make it inside K, the K in which it could. The margin on
    /// the speed is given up, step by step, before the run-out is.
    #[inline(never)]
    pub fn run_out(
        &self,
        shape: &Shape,
        machine: &Machine,
        params: &Params,
    ) -> (Ease, Ramp, Option<Fine>) {
        if shape.run_out == 0 {
            return (machine.plain(), Ramp::NONE, None);
        }
        let mut corner = machine.corner(shape.run_out_rise, shape.run_out);
        for percent in MARGINS {
            if corner.whole || percent >= self.margin {
                continue;
            }
            let slower = self.machine(shape, params, percent);
            let tried = slower.corner(shape.run_out_rise, shape.run_out);
            if tried.whole {
                corner = tried;
            }
        }
        let ramp = Ramp {
            slope: signed(corner.slope, shape.run_out_rise),
            ease: corner.ease,
            at: shape.fine_length().wrapping_sub(shape.run_out),
        };
        let needed = (!corner.whole).then(|| {
            self.machine(shape, params, 100)
                .way_needed(shape.run_out_rise)
        });
        (corner.long, ramp, needed)
    }

    /// A retract in mid-thread: the run-out's slope, 45° where there is none.
    #[inline(never)]
    pub fn retract(&self, shape: &Shape, machine: &Machine) -> Ramp {
        let mean = if shape.run_out > 0 {
            slope(shape.run_out_rise, shape.run_out).unsigned_abs()
        } else {
            DIAGONAL
        };
        let steep = mean.min(machine.steepest());
        Ramp {
            slope: i64::try_from(steep).unwrap_or(0),
            ease: Ease::new(machine.speed, seen(machine.speed, steep), machine.short),
            at: 0,
        }
    }
}

/// Long and short axis.
const fn axes(shape: &Shape) -> (Axis, Axis) {
    if shape.thread.long_x {
        (Axis::X, Axis::Z)
    } else {
        (Axis::Z, Axis::X)
    }
}

/// Numerator of a lead.
pub(super) const fn lead_nm(lead: Lead) -> u64 {
    lead.parts().0
}

/// Denominator of a lead.
pub(super) const fn lead_turns(lead: Lead) -> u64 {
    lead.parts().1
}

/// Nanometres per second at 2⁻³² turns per second, rounded up.
fn travel(lead: Lead, rate: u64) -> u64 {
    let per_turn = mul_div_up(lead_nm(lead), 1 << 16, lead_turns(lead));
    mul_div_up(per_turn, rate, 1 << 48)
}

fn bounds(params: &Params, axis: Axis) -> Bounds {
    Bounds {
        acceleration: params.acceleration(axis).nm_per_s2().unsigned_abs(),
        jerk: params.jerk(axis).nm_per_s3().unsigned_abs(),
    }
}

fn signed(magnitude: u64, sign_of: Fine) -> Slope {
    let magnitude = i64::try_from(magnitude).unwrap_or(i64::MAX);
    if sign_of < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}
