//! Limits of the axes per tick, and the limits that follow for a path.
//!
//! This module knows parameters and directions; it knows nothing of moves, profiles or time.

use super::arc::Bend;
use super::ease::Bounds;
use super::line::Line;
use super::rate::PathRate;
use super::rounding::{MEAN_MAX, Mean};
use crate::params::Params;
use crate::units::{
    Acceleration, Axis, Feed, Jerk, Length, div_wide, mul_div, mul_wide, narrow_div, product,
    root_wide,
};

/// Tells whether a move is a rapid or a cutting move; these have different top speeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// The speed limit is parameter 1420.
    Rapid,
    /// The speed limit is parameter 1430.
    Cutting,
}

/// The limits of one axis, or of a path, per tick.
///
/// Acceleration and jerk are in 2⁻³² nm (rotary: µ°) per tick² and per tick³. All limits are rounded down. They are
/// also reduced by the amount that the path's resolution of 2⁻¹⁶ nm can add to a difference of setpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathLimits {
    /// Top speed.
    pub speed: PathRate,
    /// Top acceleration, 2⁻³² nm/tick².
    pub acceleration: u64,
    /// Top jerk, 2⁻³² nm/tick³.
    pub jerk: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct AxisLimits {
    rapid: PathRate,
    cutting: PathRate,
    acceleration: u64,
    jerk: u64,
}

/// The limits of all axes for one tick length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    tick_us: u32,
    x: AxisLimits,
    z: AxisLimits,
    c: AxisLimits,
    corner: Option<Corner>,
}

/// How corners between joined cuts are rounded, on a machine and for its tolerance.
///
/// Two means of m ticks spread a step of the velocity, v·Δu, over 2·m ticks in the shape of a triangle. The acceleration is
/// then at most v·Δu/m, the jerk v·Δu/m², and the tool passes the corner at a distance of m·v·Δu/6. For several turns,
/// count Θ as all that turns within m ticks: the means make v·Θ/m and v·Θ/m² of it at most. The distance is at most 5/4 of
/// the one of a single corner: turns in the middle m ticks count in full, those in m/2 ticks before and after by an eighth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// m.
    pub mean: Mean,
    /// The largest v·Δu, in 1/256 nm per tick.
    pub turning: u64,
    /// What joined cuts leave for acceleration along the path, and for its jerk.
    pub along: PathLimits,
    /// The fewest ticks of the first mean of the profile: with them, the jerk of an acceleration that is turned in a corner
    /// is a quarter of the limit at most. (Where no input is above v, the acceleration is at most v/n1.)
    pub least_ramp: u64,
}

impl Limits {
    /// The limits of a parameter set: 1420 and 1430 of each axis, what backlash and errors of the pitch leave of 1620
    /// and 1622, and the tick. A top speed is limited to 16.7 mm (16.7°) a tick; at 1 ms this is 1000 m/min or 2796 rpm
    /// of C.
    #[must_use]
    pub fn from_params(params: &Params) -> Self {
        let tick_us = params.tick_us();
        let axis = |axis| {
            AxisLimits::new(
                params.rapid(axis),
                params.max_feed(axis),
                params.motion_acceleration(axis),
                params.motion_jerk(axis),
                tick_us,
            )
        };
        let (x, z, c) = (axis(Axis::X), axis(Axis::Z), axis(Axis::C));
        Self {
            tick_us,
            x,
            z,
            c,
            corner: Corner::new(&x, &z, params.corner_tolerance()),
        }
    }

    /// How corners are rounded; `None` where every cut ends in an exact stop.
    #[must_use]
    pub const fn corner(&self) -> Option<&Corner> {
        self.corner.as_ref()
    }

    /// The tick in microseconds.
    #[must_use]
    pub const fn tick_us(&self) -> u32 {
        self.tick_us
    }

    const fn axis(&self, axis: Axis) -> &AxisLimits {
        match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
            Axis::C => &self.c,
        }
    }

    /// Limits of one axis alone.
    pub(super) fn of_axis(&self, axis: Axis, pace: Pace) -> PathLimits {
        PathLimits::of(self.figures(axis, pace))
    }

    /// Speed, acceleration and jerk of one axis.
    #[inline(never)]
    const fn figures(&self, axis: Axis, pace: Pace) -> [u64; 3] {
        let limits = self.axis(axis);
        let speed = match pace {
            Pace::Rapid => limits.rapid,
            Pace::Cutting => limits.cutting,
        };
        [speed.raw() as u64, limits.acceleration, limits.jerk]
    }

    /// Limits along a straight path. Each axis allows its own limit, times the path's length over the axis' own
    /// distance; the smallest of these values counts.
    pub(super) fn line(&self, line: &Line, pace: Pace) -> PathLimits {
        let length = line.length().nm() as u64;
        let mut least = [u64::from(u32::MAX), u64::MAX, u64::MAX];
        // One division per axis: length / distance in 2^-shift. This is as fine as 64 bits allow, at least 2⁻²⁰ at
        // 4 km.
        let shift = length.leading_zeros().min(63);
        for (axis, distance) in Axis::ALL.into_iter().zip(line.distances()) {
            let Some(ratio) = (length << shift).checked_div(distance) else {
                continue;
            };
            for (least, own) in least.iter_mut().zip(self.figures(axis, pace)) {
                *least = stretched(own, ratio, shift).min(*least);
            }
        }
        PathLimits::of(least)
    }

    /// Limits along a circular path in X–Z that is never driven faster than `top`.
    ///
    /// On a circle of radius R at speed V, acceleration A and jerk J, the tool has the accelerations A along the path
    /// and V²/R across it, and the jerks J, 3·V·A/R and V³/R². Half of the weaker axis' acceleration is reserved for A,
    /// half of its jerk for J. If V needs less than its part, A and J get the rest.
    pub(super) fn arc(&self, bend: &Bend, top: PathRate) -> PathLimits {
        // The bends between two ticks differ from those at the ticks. The speed limit of an eighth of a radian a tick
        // keeps this small. So 15/16 of the acceleration counts, and 14/16 of the jerk.
        let mut axes = self.figures(Axis::X, Pace::Cutting);
        let mut keep = 1_u64 << 32;
        for (least, z) in axes.iter_mut().zip(self.figures(Axis::Z, Pace::Cutting)) {
            *least = mul_div(z.min(*least), keep, bend.stretch);
            keep = keep.wrapping_sub(1 << 28);
        }
        let [speed, acceleration, jerk] = axes;
        let radius = bend.radius;

        // V² ≤ a·R/2 and V³ ≤ j·R²/4, in 1/256 nm per tick. Beyond a radius of 2³⁶ nm the second limit has no effect.
        let by_acceleration = root_wide(product(acceleration, radius) >> 17);
        let near = radius.min(1 << 36);
        let by_jerk = cube_root(mul_wide(product(near, near), jerk) >> 10);
        let slowest = u64::from(top.raw().min(by_jerk));
        let speed = speed
            .min(slowest)
            .min(by_acceleration)
            .min(radius.saturating_mul(32))
            .max(2);

        // V fits 32 bits and is at most 32·R, or 2.
        let square = speed.wrapping_mul(speed);
        let across = mul_div(square, 1 << 16, radius);
        // A ≤ j·R / (12·V).
        let by_cross = narrow_div(product(jerk, radius) << 8, speed.wrapping_mul(12));
        let along = acceleration.saturating_sub(across).min(by_cross);
        let turning = narrow_div(div_wide(product(square, speed) << 8, radius), radius);
        let crossing = narrow_div(product(along, speed.wrapping_mul(3)) >> 8, radius);
        PathLimits {
            speed: PathRate::from_raw(speed as u32),
            acceleration: along,
            jerk: jerk.saturating_sub(turning).saturating_sub(crossing),
        }
    }
}

impl Corner {
    /// For the weaker of the two axes in everything. A corner has half of the jerk and half of the acceleration.
    fn new(x: &AxisLimits, z: &AxisLimits, tolerance: Length) -> Option<Self> {
        let tolerance = u64::try_from(tolerance.nm()).ok().filter(|nm| *nm > 0)?;
        let acceleration = x.acceleration.min(z.acceleration);
        let jerk = x.jerk.min(z.jerk);
        let quarter = jerk / 4;
        // 2⁻³² nm to 1/256 nm.
        let turning = |m: u64| {
            let by_jerk = mul_div(quarter.saturating_mul(2), m.saturating_mul(m), 1 << 24);
            let by_acceleration = mul_div(acceleration / 2, m, 1 << 24);
            // Six, over 5/4.
            let by_tolerance = mul_div(tolerance << 8, 24, m.saturating_mul(5));
            by_jerk.min(by_acceleration).min(by_tolerance)
        };
        let (mut mean, mut most) = (1, 0);
        for m in 1..=MEAN_MAX {
            let turning = turning(u64::from(m));
            if turning > most {
                (mean, most) = (m, turning);
            }
        }
        // Jerk of a turned acceleration: v/n1 · Δu/m.
        let across = mul_div(quarter, u64::from(mean), 1 << 24).max(1);
        (most > 0).then(|| Self {
            mean: Mean::new(mean),
            turning: most,
            along: PathLimits {
                speed: x.cutting.min(z.cutting),
                acceleration: acceleration / 2,
                jerk: quarter,
            },
            least_ramp: most.div_ceil(across),
        })
    }
}

impl PathLimits {
    /// From speed (below 2³²), acceleration and jerk.
    const fn of([speed, acceleration, jerk]: [u64; 3]) -> Self {
        Self {
            speed: PathRate::from_raw(speed as u32),
            acceleration,
            jerk,
        }
    }
}

impl AxisLimits {
    #[inline(never)]
    fn new(
        rapid: Feed,
        cutting: Feed,
        acceleration: Acceleration,
        jerk: Jerk,
        tick_us: u32,
    ) -> Self {
        // Two positions are each wrong by less than 2⁻¹⁶ nm: together less than one unit of 1/256 nm.
        let speed =
            |feed| PathRate::from_raw(PathRate::of_feed(feed, tick_us).raw().saturating_sub(1));
        Self {
            rapid: speed(rapid),
            cutting: speed(cutting),
            acceleration: per_tick(acceleration.nm_per_s2(), tick_us, 2).saturating_sub(4 << 16),
            jerk: per_tick(jerk.nm_per_s3(), tick_us, 3).saturating_sub(8 << 16),
        }
    }
}

/// Acceleration and jerk limits of an axis, per second.
#[inline(never)]
pub(super) fn bounds(params: &Params, axis: Axis) -> Bounds {
    // Neither limit is negative.
    Bounds {
        acceleration: params.motion_acceleration(axis).nm_per_s2() as u64,
        jerk: params.motion_jerk(axis).nm_per_s3() as u64,
    }
}

/// `limit` · `ratio` / 2^`shift`, saturating; `shift` ≤ 63.
fn stretched(limit: u64, ratio: u64, shift: u32) -> u64 {
    mul_div(limit, ratio, 1_u64.wrapping_shl(shift))
}

/// The largest integer whose cube is at most `value`, limited to `u32::MAX`.
fn cube_root(value: u128) -> u32 {
    let mut root = 0_u32;
    for bit in (0..32).rev() {
        let next = root | 1 << bit;
        let wide = u64::from(next);
        if product(wide.wrapping_mul(wide), wide) <= value {
            root = next;
        }
    }
    root
}

/// `value` nm per s^power as 2⁻³² nm per tick^power, rounded down.
fn per_tick(value: i64, tick_us: u32, power: u32) -> u64 {
    let mut scaled = u128::from(u64::try_from(value).unwrap_or(0)) << 32;
    for _ in 0..power {
        scaled = div_wide(mul_wide(scaled, u64::from(tick_us)), 1_000_000);
    }
    u64::try_from(scaled).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::call::Position;
    use crate::units::{Angle, Length};

    #[test]
    fn per_tick_figures_of_the_built_in_machine() {
        let limits = Limits::from_params(&Params::default());
        let x = limits.of_axis(Axis::X, Pace::Rapid);
        // 12 m/min = 200 mm/s = 200 000 nm per ms; 2 m/s² = 2000 nm/ms²; 60 m/s³ = 60 nm/ms³.
        assert_eq!(x.speed.raw(), 200_000 * 256 - 1);
        assert_eq!(x.acceleration, (2_000 << 32) - (4 << 16));
        assert_eq!(x.jerk, (60 << 32) - (8 << 16));
    }

    #[test]
    fn the_slower_axis_of_a_diagonal_counts_by_its_share() {
        let limits = Limits::from_params(&Params::default());
        // A 3-4-5 triangle: X moves 3 of 5.
        let to = Position {
            x: Length::from_nm(3_000),
            z: Length::from_nm(-4_000),
            c: Angle::ZERO,
        };
        let path = limits.line(&Line::new(Position::default(), to), Pace::Cutting);
        let x = limits.of_axis(Axis::X, Pace::Cutting);
        let z = limits.of_axis(Axis::Z, Pace::Cutting);
        assert_eq!(path.speed.raw(), (z.speed.raw() as u64 * 5 / 4) as u32);
        assert_eq!(
            path.acceleration,
            x.acceleration / 3 * 5 + (x.acceleration % 3) * 5 / 3
        );
        assert_eq!(path.jerk, (u128::from(z.jerk) * 5 / 4) as u64);
    }
}
