//! The speed of a pass, and the ramps of run-in, run-out and retract that follow from this speed.

use super::change::Taken;
use super::ramp::{Corner, DIAGONAL, Machine, Ramp, Slope, directed, seen, slope};
use super::shape::Shape;
use super::swing::beside_follower;
use crate::alarm::{Alarm, Arg, Code};
use crate::motion::ease::{Ease, Fine, whole};
use crate::motion::lead::speed_of;
use crate::motion::limits::bounds;
use crate::motion::wide::mul_div_up;
use crate::params::Params;
use crate::units::{Feed, Rpm, TurnRate, mul_div};

/// If a run-out does not fit with the whole margin, it is tried at these percentages of the spindle's speed.
const MARGINS: [u64; 4] = [110, 105, 102, 100];

/// The speed for which a pass is planned. None of these figures is negative.
pub(super) struct Pace {
    /// The faster of commanded and measured speed, magnitude.
    pub nominal: TurnRate,
    /// Percent of the nominal speed for which the plan leaves room.
    pub margin: u64,
    /// The nominal speed times this percentage.
    pub limit: TurnRate,
    /// M04.
    pub reverse: bool,
    /// The stroke is part of a chain.
    shares: bool,
}

impl Pace {
    /// The pace of a pass.
    #[inline(never)]
    pub fn new(params: &Params, commanded: Rpm, measured: TurnRate) -> Self {
        let reverse = if commanded == Rpm::STOPPED {
            measured.is_negative()
        } else {
            commanded.get() < 0
        };
        let nominal = TurnRate::of_rpm(commanded).abs().max(measured.abs());
        let margin = u64::from(params.spindle_variation_percent()).saturating_add(100);
        let limit = mul_div_up(nominal.raw() as u64, margin, 100);
        Self {
            nominal,
            margin,
            limit: TurnRate::from_raw(limit.min(i64::MAX as u64) as i64),
            reverse,
            shares: false,
        }
    }

    /// The pace of a stroke in a chain, which leaves some acceleration for a stop over a corner.
    pub fn in_chain(self) -> Self {
        Self {
            shares: true,
            ..self
        }
    }

    /// Checks that the spindle turns, and that no axis must exceed its feed.
    #[inline(never)]
    pub fn check(
        &self,
        shape: &Shape,
        params: &Params,
        commanded: Rpm,
        measured: TurnRate,
    ) -> Result<(), Alarm> {
        let nominal = self.nominal;
        if nominal == TurnRate::ZERO {
            return Err(shape.alarm(Code::SpindleStopped));
        }
        // In nm/min, exact if the command decides, so that a feed that just reaches the limit raises no alarm.
        let (nm, turns) = shape.largest.parts();
        let asked = if nominal > measured.abs() || measured == TurnRate::ZERO {
            mul_div(nm, u64::from(commanded.abs()), turns)
        } else {
            let per_second = mul_div(nm, nominal.raw() as u64, turns);
            mul_div(per_second, 60, 1 << 32)
        };
        let (long, short) = shape.axes();
        let along_taper = mul_div(asked, shape.taper.unsigned_abs(), DIAGONAL);
        let checks = [
            (long, asked, params.max_feed(long)),
            (long, mul_div(asked, self.margin, 100), params.rapid(long)),
            (short, along_taper, params.max_feed(short)),
        ];
        for (axis, feed, most) in checks {
            let feed = Feed::from_nm_per_min(feed.min(i64::MAX as u64) as i64);
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
        let rate = self.limit.raw() as u64;
        let speed = speed_of(shape.largest, rate);
        Taken::new(shape, rate, speed).check(shape, params, nominal.rpm())
    }

    /// The axes at `percent` of the nominal speed.
    pub fn machine(&self, shape: &Shape, params: &Params, percent: u64) -> Machine {
        let (long, short) = shape.axes();
        let rate = mul_div_up(self.nominal.raw() as u64, percent, 100);
        let speed = speed_of(shape.largest, rate);
        let taken = Taken::new(shape, rate, speed);
        let mut machine = Machine {
            speed,
            long: taken.of_long(bounds(params, long)),
            short: taken.of_short(bounds(params, short)),
            short_speed: params.max_feed(short).nm_per_min() as u64 / 60,
            taper: shape.taper.unsigned_abs(),
        };
        if params.learns_spindle() {
            beside_follower(&mut machine, shape);
        }
        if self.shares {
            machine.sharing()
        } else {
            machine
        }
    }

    /// Makes the join, and the run-in that brings the short axis onto the line from a point off its extension: a
    /// mirrored ramp.
    #[inline(never)]
    pub fn run_in(
        &self,
        shape: &Shape,
        machine: &Machine,
        join: &mut Ease,
        ramp: &mut Ramp,
    ) -> Result<(), Alarm> {
        if shape.run_in == 0 {
            *join = machine.plain();
            return Ok(());
        }
        let corner = machine.corner(shape.run_in_rise.unsigned_abs(), shape.run_in as u64);
        if !corner.whole {
            let needed = machine.way_needed(shape.run_in_rise.unsigned_abs());
            let alarm = shape.alarm(Code::RunInTooFast).word(b'E');
            return Err(alarm.with([
                Arg::Length(whole(needed as Fine)),
                Arg::Rpm(self.nominal.rpm()),
            ]));
        }
        corner.put(shape.run_in_rise, join, ramp);
        ramp.at = shape.run_in;
        Ok(())
    }

    /// Makes the brake and the run-out. If the short axis cannot finish inside K, returns the K in which it could. The
    /// plan reduces the margin on the speed step by step before it gives up the run-out.
    #[inline(never)]
    pub fn run_out(
        &self,
        shape: &Shape,
        machine: &Machine,
        params: &Params,
        brake: &mut Ease,
        ramp: &mut Ramp,
    ) -> Option<Fine> {
        if shape.run_out == 0 {
            *brake = machine.plain();
            return None;
        }
        let (rise, way) = (shape.run_out_rise.unsigned_abs(), shape.run_out as u64);
        let mut corner = machine.corner(rise, way);
        for percent in MARGINS {
            if corner.whole || percent >= self.margin {
                continue;
            }
            let slower = self.machine(shape, params, percent);
            let tried = slower.corner(rise, way);
            if tried.whole {
                corner = tried;
            }
        }
        corner.put(shape.run_out_rise, brake, ramp);
        ramp.at = shape.fine_length().wrapping_sub(shape.run_out);
        (!corner.whole).then(|| self.machine(shape, params, 100).way_needed(rise) as Fine)
    }

    /// A retract in mid-thread: with the run-out's slope, or 45° if there is no run-out.
    #[inline(never)]
    pub fn retract(&self, shape: &Shape, machine: &Machine, ramp: &mut Ramp) {
        let mean = if shape.run_out > 0 {
            slope(shape.run_out_rise, shape.run_out as u64).unsigned_abs()
        } else {
            DIAGONAL
        };
        let steep = mean.min(machine.steepest());
        ramp.slope = steep as Slope;
        ramp.ease = Ease::new(machine.speed, seen(machine.speed, steep), &machine.short);
    }
}

impl Corner {
    /// Writes the long axis' ease and the short axis' ramp. The ramp displaces the short axis towards the side of
    /// `rise`.
    #[inline(never)]
    fn put(&self, rise: Fine, long: &mut Ease, ramp: &mut Ramp) {
        *long = self.long;
        ramp.ease = self.ease;
        ramp.slope = directed(self.slope, rise);
    }
}
