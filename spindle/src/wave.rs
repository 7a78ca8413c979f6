//! Swings of a spindle's angle about its mean: one that returns with each turn, or with a frequency of its own.
//!
//! A swing is `a·cos φ + b·sin φ`. This module learns `a` and `b` from what surprises, and says what the swing is
//! worth at a phase and by how much it differs from its worth in the ticks before. It knows no encoder.

#[cfg(test)]
mod tests;

/// An angle of the swing, 2⁻³² of its period.
pub(crate) type Angle = u32;

/// Cosine and sine, 2⁻³⁰.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unit {
    pub cos: i32,
    pub sin: i32,
}

impl Unit {
    /// Of no angle.
    pub const ZERO: Self = Self {
        cos: 1 << 30,
        sin: 0,
    };

    /// Within 2⁻²².
    pub const fn of(angle: Angle) -> Self {
        // The nearest quarter, and the rest of at most an eighth to either side.
        let quarter = angle.wrapping_add(1 << 29) >> 30;
        let rest = angle.wrapping_sub(quarter << 30) as i32;
        // In radians, 2⁻³⁰: 2π·2⁻³² of a turn each.
        let d = ((rest as i64).wrapping_mul(1_686_629_713) >> 30) as i32;
        let square = times(d, d);
        // d·(1 − d²/6·(1 − d²/20·(1 − d²/42)))
        let one = 1_i32 << 30;
        let inner = one.wrapping_sub(times(square, 25_565_282));
        let inner = one.wrapping_sub(times(times(square, 53_687_091), inner));
        let inner = one.wrapping_sub(times(times(square, 178_956_971), inner));
        let sin = times(d, inner);
        // 1 − d²/2·(1 − d²/12·(1 − d²/30·(1 − d²/56)))
        let inner = one.wrapping_sub(times(square, 19_173_961));
        let inner = one.wrapping_sub(times(times(square, 35_791_394), inner));
        let inner = one.wrapping_sub(times(times(square, 89_478_485), inner));
        let cos = one.wrapping_sub(times(square >> 1, inner));
        let (cos, sin) = match quarter & 3 {
            0 => (cos, sin),
            1 => (sin.wrapping_neg(), cos),
            2 => (cos.wrapping_neg(), sin.wrapping_neg()),
            _ => (sin, cos.wrapping_neg()),
        };
        Self { cos, sin }
    }

    /// That of twice the angle.
    pub const fn doubled(self) -> Self {
        let one = 1_i32 << 30;
        Self {
            cos: one.wrapping_sub(times(self.sin, self.sin).wrapping_mul(2)),
            sin: times(self.sin, self.cos).wrapping_mul(2),
        }
    }
}

const fn times(a: i32, b: i32) -> i32 {
    ((a as i64).wrapping_mul(b as i64) >> 30) as i32
}

/// A value below half a turn (2⁻⁴⁸), rounded to 2⁻³² turns. Rounded down it would be wrong to one side in each tick, and
/// whoever adds it up would be far off.
#[inline(always)]
const fn short(value: i64) -> i32 {
    (value.wrapping_add(1 << 15) >> 16) as i32
}

/// `x` and `y` (turns, 2⁻³²), each times its share of 2⁻³⁰, 2⁻⁴⁸.
#[inline(always)]
const fn parts([x, y]: [i32; 2], [of_x, of_y]: [i32; 2]) -> i64 {
    let x = (x as i64).wrapping_mul(of_x as i64);
    let y = (y as i64).wrapping_mul(of_y as i64);
    x.wrapping_add(y) >> 14
}

/// The worth of something and its backward differences: turns, per tick, per tick², per tick³, all 2⁻⁴⁸.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Differences {
    /// The worth, modulo 2¹⁶ turns.
    pub value: i64,
    /// By how much it is more than a tick before.
    pub speed: i64,
    /// By how much the speed is more.
    pub acceleration: i64,
    /// By how much the acceleration is more.
    pub jerk: i64,
}

impl Differences {
    /// The sum of both.
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self {
            value: self.value.wrapping_add(other.value),
            speed: self.speed.wrapping_add(other.speed),
            acceleration: self.acceleration.wrapping_add(other.acceleration),
            jerk: self.jerk.wrapping_add(other.jerk),
        }
    }
}

/// The two parts of a swing in turns, 2⁻⁴⁸.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wave {
    pub a: i64,
    pub b: i64,
}

impl Wave {
    /// No swing.
    pub const NONE: Self = Self { a: 0, b: 0 };

    /// This swing, or none.
    pub const fn where_told(&self, is_told: bool) -> Self {
        if is_told { *self } else { Self::NONE }
    }

    /// How large it is, up to an eighth too large: turns, 2⁻⁴⁸.
    pub const fn size(&self) -> u64 {
        let (a, b) = (self.a.unsigned_abs(), self.b.unsigned_abs());
        let (most, least) = if a > b { (a, b) } else { (b, a) };
        most.saturating_add(least >> 1)
    }

    /// The angle by which `after` is turned against this swing, radians in 2⁻³²; 0 where it is hardly there. A change
    /// of more than an eighth counts as an eighth.
    pub fn turned(self, after: &Self) -> i64 {
        let most = after.a.unsigned_abs() | after.b.unsigned_abs();
        if most < 1 << 20 {
            return 0;
        }
        // The larger part in 15 bits, and what it has changed by in up to 15 more.
        let shift = 49_u32.wrapping_sub(most.leading_zeros());
        let more = shift.min(15);
        let eighth = 1_i64 << more.wrapping_add(12);
        let change = |from: i64, to: i64| {
            let change = to.wrapping_sub(from) >> shift.wrapping_sub(more);
            change.min(eighth).max(eighth.wrapping_neg())
        };
        let (a, b) = (after.a >> shift, after.b >> shift);
        let cross = a
            .wrapping_mul(change(self.b, after.b))
            .wrapping_sub(b.wrapping_mul(change(self.a, after.a)));
        // Of 28 to 31 bits, the upper ones carry the quotient: 2⁴⁶ through the size.
        let size = a.wrapping_mul(a).wrapping_add(b.wrapping_mul(b));
        let inverse = u32::MAX.checked_div((size >> 14) as u32).unwrap_or(0);
        cross.wrapping_mul(inverse.into()) >> more.wrapping_add(14)
    }

    /// At `at`, and a quarter of its period after.
    #[inline(always)]
    const fn worth(self, at: Unit) -> Around {
        Around::turned([short(self.a), short(self.b)], [at.cos, at.sin])
    }

    /// At `at`, and a tick before, where each tick adds the angle `step`.
    pub const fn pair(self, at: Unit, step: Unit) -> [i64; 2] {
        let now = self.worth(at);
        [
            now.value,
            now.value.wrapping_sub(now.difference(step).value),
        ]
    }

    /// At `at`, where each tick adds the angle `step`.
    #[inline(never)]
    pub const fn differences(self, at: Unit, step: Unit) -> Differences {
        let now = self.worth(at);
        let speed = now.difference(step);
        let acceleration = speed.difference(step);
        Differences {
            value: now.value,
            speed: speed.value,
            acceleration: acceleration.value,
            jerk: acceleration.difference(step).value,
        }
    }
}

/// Something that swings, and what it is worth a quarter of its period after: turns, 2⁻⁴⁸.
#[derive(Clone, Copy, Debug)]
struct Around {
    value: i64,
    aside: i64,
}

impl Around {
    /// `x` and `y` (turns, 2⁻³²), turned back by an angle with this cosine and sine (2⁻³⁰), or that times a size.
    #[inline(always)]
    const fn turned([x, y]: [i32; 2], [cos, sin]: [i32; 2]) -> Self {
        Self {
            value: parts([x, y], [cos, sin]),
            aside: parts([y, x], [cos, sin.wrapping_neg()]),
        }
    }

    /// By how much it is more than a tick before, where each tick adds the angle `step`. It is worked out of the step and
    /// not of two values: where the spindle is slow, what two values differ by is lost in their rounding.
    #[inline(always)]
    const fn difference(self, step: Unit) -> Self {
        // Two at half a period, which does not fit.
        let less = (1_i32 << 30).saturating_sub(step.cos);
        Self::turned([short(self.value), short(self.aside)], [less, step.sin])
    }
}

/// Turns a swing of `omega` radians a tick (2⁻³², negative where its angle falls) by a `step` (2⁻⁴⁸ turns) towards a
/// surprise at `at`. The poles of the observer, which has let only a part of the swing through, turn by `pole` (2⁻³²).
pub(crate) fn learn(wave: &mut Wave, at: Unit, step: i64, pole: u32, omega: i64) {
    // w = p/ω, 2⁻¹⁶.
    let w = pole
        .checked_div((omega.unsigned_abs() >> 16) as u32)
        .unwrap_or(u32::MAX);
    // A surprise of less than a twentieth of the swing teaches nothing, and one of less than a fifth is not made larger.
    if w > SLOWEST {
        return;
    }
    let w = i64::from(w.min(LARGEST)).wrapping_mul(omega.signum());
    // (1 + i·w)³
    let square = w.wrapping_mul(w) >> 16;
    let real = (1_i64 << 16).wrapping_sub(square.wrapping_mul(3));
    let imaginary = w.wrapping_mul(3).wrapping_sub(square.wrapping_mul(w) >> 16);
    let (cos, sin) = (i64::from(at.cos), i64::from(at.sin));
    let along = cos
        .wrapping_mul(real)
        .wrapping_sub(sin.wrapping_mul(imaginary))
        >> 16;
    let across = sin
        .wrapping_mul(real)
        .wrapping_add(cos.wrapping_mul(imaginary))
        >> 16;
    // A step has at most 44 bits.
    let by = |part: i64| step.wrapping_mul(part >> 14) >> 16;
    wave.a = wave.a.wrapping_add(by(along));
    wave.b = wave.b.wrapping_add(by(across));
}

/// 2.5 and 1.4, 2⁻¹⁶: `|1 + i·w|³` is 20 and 5 there. Beyond 1.4 the phase is up to 41° wrong, which still settles.
const SLOWEST: u32 = 5 << 15;
const LARGEST: u32 = 91_750;
