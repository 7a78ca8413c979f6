//! Commands for the spindle from one turning point to the next: speeds that the spindle can follow, and from which it
//! stops at the turning point. Speeds are in 2⁻³² turns per tick, inwards positive; angles are in 2⁻³² turns.

use crate::motion::wide::mul_div_up;
use crate::params::Params;
use crate::units::{CentiRpm, Lead, TurnRate, mul_div, root, signed};

/// The spindle's speed and ramps in a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turner {
    /// S.
    top: i64,
    top_rate: TurnRate,
    /// The ramp for planning, in 2⁻³² turns per tick².
    gentle: u64,
    /// The quickest ramp.
    full: u64,
    /// Angles to a turning point are limited to this, 2⁻³² turns, so that no square of a speed overflows. Within this
    /// angle the spindle stops from any speed.
    furthest: u64,
    /// In 2⁻¹⁶.
    ticks_per_second: i64,
}

impl Turner {
    /// A spindle at `speed`. Two limits hold for its acceleration: parameter 9004, and at this lead the acceleration
    /// `axis` (nm/s²) of the axis. The ramp for planning keeps an eighth in reserve, for a spindle that does not follow
    /// its command exactly.
    #[inline(never)]
    pub(super) fn new(speed: CentiRpm, lead: Lead, axis: u64, params: &Params) -> Self {
        let tick_us = u64::from(params.tick_us());
        let ticks_per_second = mul_div(1_000_000, 1 << 16, tick_us);
        let top_rate = mul_div(u64::from(speed.get().unsigned_abs()), 1 << 32, 6_000);
        // 1000/60 turns a second within the milliseconds of the parameter.
        let ramp = mul_div(
            1 << 32,
            1_000_000,
            u64::from(params.spindle_ramp_ms()).wrapping_mul(60),
        );
        let (nm, turns) = (lead.numerator(), lead.denominator());
        let by_axis = mul_div(
            axis.saturating_mul(turns.unsigned_abs()),
            1 << 32,
            nm.unsigned_abs(),
        );
        let per_second2 = ramp.min(by_axis);
        let per_tick = mul_div(
            per_second2,
            tick_us.saturating_mul(tick_us),
            1_000_000_000_000,
        );
        // The upper limit, one turn per tick², keeps the squares within 64 bits.
        let full = per_tick.clamp(8, 1 << 32);
        let gentle = full.wrapping_sub(full >> 3);
        // (g/2)² is at most a quarter of what fits.
        let furthest = mul_div(u64::MAX >> 2, 3, gentle << 1);
        Self {
            top: mul_div(top_rate, tick_us, 1_000_000) as i64,
            top_rate: TurnRate::from_raw(signed(top_rate)),
            gentle,
            full,
            furthest,
            ticks_per_second: signed(ticks_per_second),
        }
    }

    /// S.
    pub(super) const fn top(&self) -> i64 {
        self.top
    }

    /// The planned ramp in 2⁻³² turns per tick².
    pub(super) const fn gentle(&self) -> i64 {
        self.gentle as i64
    }

    /// The greatest speed from which the spindle stops within the angle `left`; 0 if no angle is left.
    pub(super) fn stopping(&self, left: i64) -> i64 {
        if left <= 0 {
            return 0;
        }
        self.speed_of(self.square(left))
    }

    /// Like [`stopping`](Self::stopping), but returns `enough` if the speed is at least that much. This saves the
    /// square root.
    pub(super) fn stopping_or(&self, left: i64, enough: i64) -> i64 {
        if left <= 0 {
            return 0;
        }
        let square = self.square(left);
        let root = enough.unsigned_abs().wrapping_add(self.gentle >> 1);
        match u32::try_from(root) {
            Ok(root) if u64::from(root).wrapping_mul(u64::from(root)) <= square => enough,
            _ => self.speed_of(square),
        }
    }

    /// The speed of a [`square`](Self::square).
    fn speed_of(&self, square: u64) -> i64 {
        (root(square) as i64)
            .wrapping_sub((self.gentle >> 1) as i64)
            .max(0)
    }

    /// v² / 2g for whole ticks, with the last step of a tick included: (v + g/2)² = 2·g·left + (g/2)².
    fn square(&self, left: i64) -> u64 {
        let half = self.gentle >> 1;
        (self.gentle << 1)
            .wrapping_mul(left.unsigned_abs().min(self.furthest))
            .wrapping_add(half.wrapping_mul(half))
    }

    /// The greatest speed in a stroke over an angle from rest to rest.
    pub(super) fn peak(&self, way: i64) -> i64 {
        self.stopping(way >> 1).min(self.top)
    }

    /// The next command: from `speed` towards `wanted`, within the ramps.
    pub(super) fn towards(&self, speed: i64, wanted: i64) -> i64 {
        let faster = wanted.unsigned_abs() > speed.unsigned_abs();
        let step = if faster { self.gentle } else { self.full } as i64;
        let change = wanted.wrapping_sub(speed);
        speed.wrapping_add(change.max(step.wrapping_neg()).min(step))
    }

    /// A command as a speed.
    pub(super) fn rate(&self, speed: i64) -> TurnRate {
        let size = speed.unsigned_abs() as i64;
        let magnitude = if size >= self.top {
            // Use the programmed speed itself, not its rounded value.
            self.top_rate.raw()
        } else {
            size.wrapping_mul(self.ticks_per_second) >> 16
        };
        TurnRate::from_raw(magnitude.wrapping_mul(speed.signum()))
    }

    /// A commanded speed in hundredths of a turn a minute, to the nearest.
    pub(super) fn centi_rpm(&self, speed: i64) -> CentiRpm {
        let rate = self.rate(speed).raw().unsigned_abs();
        let centi = mul_div(rate.saturating_add(1), 6_000, 1 << 32);
        CentiRpm::new(i32::try_from(centi).unwrap_or(i32::MAX))
    }

    /// Ticks for an angle, with `top` as the highest speed. `starts`: from rest; `stops`: to rest. Background work.
    pub(super) fn ticks(&self, way: i64, starts: bool, stops: bool) -> u64 {
        let way = way.max(0).unsigned_abs();
        let ends = u64::from(starts).wrapping_add(u64::from(stops));
        let rest = match (starts, stops) {
            (true, true) => way >> 1,
            _ => way,
        };
        let peak = self
            .stopping(signed(rest))
            .min(self.top)
            .max(1)
            .unsigned_abs();
        let ramps = mul_div_up(peak, ends, self.gentle.saturating_mul(2));
        mul_div_up(way, 1, peak).saturating_add(ramps)
    }
}
