//! From where on an axis is on the helix behind the inverse of its drive's lag (9070) and the reversal of its screw (1851).
//!
//! The inverse takes off the lag of the position loop. What it leaves is the speed loop's: while the axis joins the helix
//! it falls behind, and gets over that as slowly as the position loop is weak. So the drive is stepped through the join,
//! until it stays within [`WITHIN`]:
//!
//! ```text
//! w = Kv·e + r' − v      e = r − z; the target r + r'/Kv, so Kv is the only trace of the position loop
//! I += ωv/Ti·w           the speed loop
//! a → ωv·w + I           the current loop
//! v' = a − friction      the axis
//! ```
//!
//! Feed-forward (9071) does not come in: whatever share the drive has, the inverse has taken account of. Loop and friction
//! are no parameters: they are those that a small lathe has, and a speed loop is four times as quick as the position loop
//! around it, at least. What force the drive held its axis with before is not known either, so the worst counts [D490].

use crate::motion::ThreadPlan;
use crate::params::Params;
use crate::units::{Axis, Lead, Length, Rpm, mul_div, signed};

/// An axis this close to its line is on it.
const WITHIN: i64 = 1000 * FINE;

/// Steps in a second.
const STEPS: i64 = 8000;

/// Microseconds of a step.
const PERIOD_US: i64 = 1_000_000 / STEPS;

/// Places and speeds are in this part of a nanometre, per step and step².
const FINE: i64 = 1 << 16;

/// The speed loop: its gain in 1/s, and the time of its integral in steps.
const SPEED_LOOP: i64 = 400;
const INTEGRAL: i64 = STEPS / 100;

/// How much of what is missing the current makes up for in a step, of 100: 800 Hz.
const CURRENT: i64 = 47;

/// Friction in motion, of X and of the other axes, and that of 1/s of the speed; at rest it is that in motion.
const SLIDING_X: i64 = 400_000_000;
const SLIDING: i64 = 250_000_000;
const VISCOUS: i64 = 2;

/// An axis and its drive. `e` is behind, `r` the speed that it should have.
#[derive(Clone, Copy, Debug, Default)]
struct Driven {
    /// Gains of position loop and speed loop, 1/s; the first in tenths.
    kv: i64,
    speed_loop: i64,
    sliding: i64,
    e: i64,
    v: i64,
    a: i64,
    integral: i64,
}

impl Driven {
    fn new(tenths: i64, axis: Axis) -> Self {
        let sliding = if axis == Axis::X { SLIDING_X } else { SLIDING };
        Self {
            kv: tenths,
            speed_loop: SPEED_LOOP.max(part(tenths.saturating_mul(4), 1, 10)),
            sliding: per_step2(sliding),
            ..Self::default()
        }
    }

    /// A step in which the setpoint moves at `r`.
    fn step(&mut self, r: i64) {
        let by_position = part(self.e, self.kv, STEPS * 10);
        let missing = by_position.saturating_add(r).saturating_sub(self.v);
        let direct = part(missing, self.speed_loop, STEPS);
        self.integral =
            self.integral
                .saturating_add(part(missing, self.speed_loop, STEPS * INTEGRAL));
        let asked = direct.saturating_add(self.integral);
        self.a = self
            .a
            .saturating_add(part(asked.saturating_sub(self.a), CURRENT, 100));
        if self.v != 0 || self.a.saturating_abs() > self.sliding {
            let way = if self.v == 0 { self.a } else { self.v }.signum();
            let friction = self
                .sliding
                .saturating_mul(way)
                .saturating_add(part(self.v, VISCOUS, STEPS));
            let next = self.v.saturating_add(self.a).saturating_sub(friction);
            self.v = if next.signum() == way.saturating_neg() {
                0
            } else {
                next
            };
        }
        self.e = self.e.saturating_add(r).saturating_sub(self.v);
    }
}

/// Steps after which a drive of this gain (tenths) has forgotten its join by a factor of 10⁶.
fn patience(tenths: i64) -> i64 {
    (STEPS * 200).checked_div(tenths).unwrap_or(0)
}

/// `of` · `n` / `d`.
fn part(of: i64, n: i64, d: i64) -> i64 {
    of.saturating_mul(n).checked_div(d).unwrap_or(0)
}

/// Of nm/s².
const fn per_step2(nm: i64) -> i64 {
    nm.saturating_mul(FINE) / (STEPS * STEPS)
}

/// The way from the start point to where both axes are on the line of the thread for good, at the commanded speed and at
/// the highest one that the plan is for. Never shorter than the lead-in of the setpoints; that one where no lag is taken
/// off.
pub(super) fn lead_in(plan: &ThreadPlan, params: &Params, lead: Lead, rpm: Rpm) -> Length {
    let (nm, turns) = lead.parts();
    let commanded = mul_div(nm, u64::from(rpm.abs()), turns.saturating_mul(60));
    let highest = mul_div(nm, plan.speed_limit().raw().unsigned_abs(), 1 << 32);
    let highest = highest.checked_div(turns).unwrap_or(0);
    at_speed(plan, params, commanded).max(at_speed(plan, params, highest))
}

/// The same at a speed of the helix (nm/s).
fn at_speed(plan: &ThreadPlan, params: &Params, speed: u64) -> Length {
    let (long, short) = if plan.long_x() {
        (Axis::X, Axis::Z)
    } else {
        (Axis::Z, Axis::X)
    };
    let straight = 1_i64 << 40;
    [(long, straight), (short, plan.taper())]
        .into_iter()
        .filter(|(_, slope)| *slope != 0)
        .map(|(axis, slope)| {
            let settled = settled(plan, params, speed, axis, slope);
            settled.max(taken_up(params, speed, axis))
        })
        .fold(plan.lead_in(), Length::max)
}

/// The way of the helix while the backlash of an axis is put in: a stroke begins with a reversal where the axis has come
/// back from the one before.
fn taken_up(params: &Params, speed: u64, axis: Axis) -> Length {
    let way = mul_div(speed, params.take_up_us(axis), 1_000_000);
    Length::from_nm(signed(way))
}

/// The same of one axis, which moves by `slope` (2⁻⁴⁰) for each way of the long one.
fn settled(plan: &ThreadPlan, params: &Params, speed: u64, axis: Axis, slope: i64) -> Length {
    let lead_in = plan.lead_in();
    let tenths = i64::from(params.drive_gain(axis));
    // A way of the helix in a step, and the ways of the whole join and of its rise, all fine.
    let step = signed(mul_div(speed, FINE.unsigned_abs(), STEPS.unsigned_abs()));
    let whole = lead_in.nm().saturating_mul(2 * FINE);
    let rise = plan.join_rise().nm().saturating_mul(FINE).max(1);
    if tenths == 0 || step == 0 || whole <= rise {
        return lead_in;
    }
    // The axis' own speed, and the acceleration at its highest.
    let share = |of: u64| mul_div(of, slope.unsigned_abs(), 1 << 40);
    let full = signed(share(step.unsigned_abs()));
    let length = whole.saturating_sub(rise).unsigned_abs();
    let top = share(mul_div(step.unsigned_abs(), step.unsigned_abs(), length));
    // Where it came to rest, friction held whatever force was left.
    let drive = |held| {
        let mut driven = Driven::new(tenths, axis);
        driven.a = driven.sliding.saturating_mul(held);
        driven.integral = driven.a;
        driven
    };
    let mut drives = [-1, 0, 1].map(drive);
    let (mut way, mut r, mut last) = (0_i64, 0_i64, 0_i64);
    let end = whole.saturating_add(step.saturating_mul(patience(tenths)));
    while way < end {
        way = way.saturating_add(step);
        r = if way >= whole {
            full
        } else {
            let risen = way.min(whole.saturating_sub(way)).min(rise);
            let more = mul_div(top, risen.unsigned_abs(), rise.unsigned_abs());
            r.saturating_add(signed(more)).min(full)
        };
        for driven in &mut drives {
            driven.step(r);
            if driven.e.saturating_abs() > WITHIN {
                last = way;
            }
        }
    }
    // The drive gets a target in a period.
    let period = part(step, i64::from(params.tick_us()), PERIOD_US);
    let from_start = last.saturating_add(period).checked_div(FINE).unwrap_or(0);
    Length::from_nm(from_start).max(lead_in.times(2)) - lead_in
}
