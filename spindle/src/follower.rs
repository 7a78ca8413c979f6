//! The follower: an angle that keeps to a speed, an acceleration and a jerk, whatever it follows.
//!
//! What a [`Tracker`](crate::Tracker) says of the spindle moves in steps, by the surprise of each look. An axis on the
//! lead has limits. The follower goes after the tracker's angle as fast as the limits allow, and without any lag where they
//! are kept: it knows speed, acceleration and jerk of what it follows.
//!
//! Everything is exact: `v` changes by `a`, and the angle by `v`, to the last bit. So the limits hold for every difference
//! of the angle that comes out. Turns, per tick, per tick² and per tick³, all 2⁻⁴⁸; the angle modulo 2¹⁶ turns.

use crate::looks::exp_of_minus;
use crate::wave::Differences;

/// What the follower may do; none is negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// Turns per tick, 2⁻⁴⁸.
    pub speed: i64,
    /// Turns per tick², 2⁻⁴⁸.
    pub acceleration: i64,
    /// Turns per tick³, 2⁻⁴⁸.
    pub jerk: i64,
    /// Turns by which the angle may be beside what it follows, 2⁻⁴⁸.
    pub beside: i64,
}

/// Half a turn, 2⁻⁴⁸.
const LARGEST: i64 = 1 << 47;

/// The follower's state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follower {
    limits: Limits,
    /// Jerk through acceleration, 2⁻³⁰.
    kappa: i32,
    /// The shares of the differences in angle, speed and acceleration that a tick takes off, 2⁻³⁰.
    kz: i32,
    kv: i32,
    ka: i32,
    /// The most that a difference in angle adds to the speed, and one in speed to the acceleration.
    dv: i64,
    da: i64,
    z: i64,
    v: i64,
    a: i64,
    /// The angle, seen from what it follows.
    beside: i64,
}

#[inline(always)]
fn within(value: i64, most: i64) -> i64 {
    value.min(most).max(most.wrapping_neg())
}

/// A gain (2⁻³⁰) times a value below half a turn, to the last bit: what is too small to be taken in would swing to and fro.
#[inline(always)]
fn times(gain: i32, value: i64) -> i64 {
    let (value, gain) = (within(value, LARGEST), i64::from(gain));
    let below = (value & 0xFFFF).wrapping_mul(gain) >> 16;
    let product = (value >> 16).wrapping_mul(gain).wrapping_add(below);
    product.wrapping_add(1 << 13) >> 14
}

impl Follower {
    /// A follower of nothing yet. `pole` is its bandwidth as an angle per tick, 2π·f·T, 2⁻³², at most 0.5.
    #[must_use]
    #[inline(never)]
    pub fn new(limits: Limits, pole: u32) -> Self {
        let one = 1_i64 << 30;
        let theta = (exp_of_minus(pole.min(1 << 31)).to_bits() >> 2) as i64;
        let square = theta.wrapping_mul(theta) >> 30;
        // Three poles at θ. As differences of what is nearly equal, the gains of a slow pole would be all rounding.
        let rest = one.wrapping_sub(theta);
        let twice = one.wrapping_add(theta.wrapping_mul(2));
        let sum = one.wrapping_add(theta).wrapping_add(square);
        let ka = rest.wrapping_mul(sum) >> 30;
        let kv = rest.wrapping_mul(twice).checked_div(sum).unwrap_or(0);
        let kz = rest.wrapping_shl(30).checked_div(twice).unwrap_or(0);
        // What the pole takes off in a tick; a value has at most 45 bits.
        let over_pole = |value: i64, tenths: i64| {
            let pole = i64::from(pole >> 12).max(1).wrapping_mul(10);
            let value = value.min(1 << 38).wrapping_mul(tenths) << 20;
            value.checked_div(pole).unwrap_or(0)
        };
        // Rounded down: with more, a jerk could be needed that is not allowed.
        let kappa = (limits.jerk << 14)
            .checked_div((limits.acceleration >> 16).wrapping_add(1))
            .unwrap_or(0);
        let kappa = i32::try_from(kappa.min(1 << 29)).unwrap_or(0);
        let short = |value: i64| i32::try_from(value).unwrap_or(i32::MAX);
        let da = over_pole(limits.jerk, 8);
        Self {
            limits,
            kappa,
            kz: short(kz),
            kv: short(kv),
            ka: short(ka),
            dv: over_pole(da, 27),
            da,
            z: 0,
            v: 0,
            a: 0,
            beside: 0,
        }
    }

    /// Begins on what it is to follow, with its speed and its acceleration: an acceleration that came with the pole
    /// would leave the angle behind a spindle that swings, for as long as a second.
    pub fn begin(&mut self, on: &Differences) {
        let most = self.limits.speed;
        self.z = on.value;
        self.v = on.speed.min(most).max(most.wrapping_neg());
        let [least, most] = self.accelerations();
        self.a = on.acceleration.min(most).max(least);
        self.beside = 0;
    }

    /// The accelerations that keep the speed to its limit.
    fn accelerations(&self) -> [i64; 2] {
        let Limits {
            speed,
            acceleration,
            ..
        } = self.limits;
        let room = |left: i64| (left >> 16).wrapping_mul(self.kappa.into()) >> 14;
        let most = room(speed.wrapping_sub(self.v)).min(acceleration);
        let least = room(speed.wrapping_add(self.v)).min(acceleration);
        [least.wrapping_neg(), most]
    }

    /// Goes after `to`; the angle that comes out, seen from it.
    #[inline(never)]
    pub fn tick(&mut self, to: &Differences) -> i64 {
        // Where it was a tick ago, by what is known of it now.
        let acceleration = to.acceleration.wrapping_sub(to.jerk);
        let speed = to.speed.wrapping_sub(to.acceleration);
        let value = to.value.wrapping_sub(to.speed);
        let x = within(times(self.kz, value.wrapping_sub(self.z)), self.dv);
        let y = times(self.kv, speed.wrapping_sub(self.v).wrapping_add(x));
        let y = within(y, self.da);
        let wanted = acceleration.wrapping_sub(self.a).wrapping_add(y);
        let wanted = self
            .a
            .wrapping_add(to.jerk)
            .wrapping_add(times(self.ka, wanted));
        let jerk = self.limits.jerk;
        let [least, most] = self.accelerations();
        let most = most.min(self.a.wrapping_add(jerk));
        let least = least.max(self.a.wrapping_sub(jerk));
        self.a = wanted.min(most).max(least);
        self.v = self.v.wrapping_add(self.a);
        self.z = self.z.wrapping_add(self.v);
        self.beside = self.z.wrapping_sub(to.value);
        self.beside
    }

    /// True where the angle is farther from what it follows than it may be: the limits are too low for that.
    #[must_use]
    pub const fn is_lost(&self) -> bool {
        self.beside.unsigned_abs() > self.limits.beside.unsigned_abs()
    }
}
