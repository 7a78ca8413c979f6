//! What backlash (1851) leaves of the limits of an axis, and how it is put in within the rest of them.

use super::Params;
use super::pitch::PITCH_PART;
use crate::units::{Acceleration, Axis, Jerk, mul_div, signed};

/// Where an axis has backlash, putting it in may use one part in so many of the axis' acceleration and jerk, and the
/// motion of the axis uses the others.
pub(crate) const TAKE_UP_PART: u64 = 4;

/// The speed of putting it in is at most one part in so many of the rapid rate.
pub(super) const SPEED_PART: u64 = 16;

/// The largest τ, as a power of two, in ticks.
const LONGEST: u32 = 6;

/// So many τ after the ramp an eighth of a per cent is left: 25 nm of 20 µm, 1.2 µm of 1 mm.
const SETTLED: u64 = 9;

/// What is left of an earlier parameter is put in like this, with the places of a shape: 20 µm.
const LEAST: u64 = 20_000 << TakeUpShape::PLACES;

/// How the backlash of an axis is put in: a ramp of r a tick, and two lags of τ ticks behind it.
///
/// From |ramp| ≤ r follow: speed within r, acceleration within 2·r/τ, jerk within 4·r/τ². r and τ are those of which these
/// are within the [part](TAKE_UP_PART) of the axis' limits that its motion [leaves](Params::motion_acceleration), and the
/// way is made soonest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TakeUpShape {
    /// The backlash in nanometres, with [`PLACES`](Self::PLACES).
    pub way: i32,
    /// r, with the same places.
    pub ramp: i32,
    /// τ as a power of two.
    pub lag: u32,
}

impl TakeUpShape {
    /// Binary places: the lags end within a quarter of a nanometre.
    pub const PLACES: u32 = 10;

    /// Of X or Z. The backlash may be zero.
    pub fn of(params: &Params, axis: Axis) -> Self {
        // The range ends at 1 mm.
        let way = params.backlash(axis).unwrap_or(0) << Self::PLACES;
        let tick = u64::from(params.tick_us());
        let highest = params.highest(axis);
        let acceleration = highest.acceleration / TAKE_UP_PART;
        let jerk = highest.jerk / TAKE_UP_PART;
        let rapid = params.rapid(axis).nm_per_min().unsigned_abs() / SPEED_PART;
        let by_speed = mul_div(rapid, tick << Self::PLACES, 60_000_000);
        let mut best = (u64::MAX, 1, 0);
        for lag in 0..=LONGEST {
            let ticks = 1_u64.wrapping_shl(lag);
            // 2·r/τ ≤ a and 4·r/τ² ≤ j, per tick.
            let square = tick
                .saturating_mul(tick)
                .saturating_mul(ticks << Self::PLACES);
            let cube = square.saturating_mul(tick).saturating_mul(ticks);
            let by_acceleration = mul_div(acceleration, square, 2_000_000_000_000);
            let by_jerk = mul_div(jerk, cube, 4_000_000_000_000_000_000);
            let ramp = by_acceleration.min(by_jerk).min(by_speed).clamp(1, 1 << 30);
            let time = time(way.unsigned_abs().max(LEAST), ramp, ticks);
            if time < best.0 {
                best = (time, ramp, lag);
            }
        }
        let (_, ramp, lag) = best;
        Self {
            way: i32::try_from(way).unwrap_or(0),
            ramp: i32::try_from(ramp).unwrap_or(1),
            lag,
        }
    }
}

/// Ticks of putting in a way.
fn time(way: u64, ramp: u64, ticks: u64) -> u64 {
    let ramped = way.checked_div(ramp).unwrap_or(0);
    ramped.saturating_add(SETTLED.wrapping_mul(ticks))
}

impl Params {
    pub(super) fn has_backlash(&self, axis: Axis) -> bool {
        self.backlash(axis).is_some_and(|way| way != 0)
    }

    /// Time in microseconds from a reversal of an axis until its backlash is put in, to an eighth of a per cent.
    #[must_use]
    pub fn take_up_us(&self, axis: Axis) -> u64 {
        if !self.has_backlash(axis) {
            return 0;
        }
        let shape = TakeUpShape::of(self, axis);
        let [way, ramp] = [shape.way, shape.ramp].map(|of| u64::from(of.unsigned_abs()));
        let ticks = time(way, ramp, 1_u64.wrapping_shl(shape.lag));
        ticks
            .saturating_add(1)
            .saturating_mul(self.tick_us().into())
    }

    /// The largest acceleration of the motion of an axis: 1620, or what the targets of its drive leave of it, less what is
    /// kept for its backlash and its pitch errors.
    #[must_use]
    pub fn motion_acceleration(&self, axis: Axis) -> Acceleration {
        let left = self.left_of(axis, self.highest(axis).acceleration);
        Acceleration::from_nm_per_s2(signed(left))
    }

    /// The largest jerk of the motion of an axis: 1622, or what the targets of its drive leave of it, less what is kept for
    /// its backlash and its pitch errors.
    #[must_use]
    pub fn motion_jerk(&self, axis: Axis) -> Jerk {
        let left = self.left_of(axis, self.highest(axis).jerk);
        Jerk::from_nm_per_s3(signed(left))
    }

    fn left_of(&self, axis: Axis, limit: u64) -> u64 {
        let part = |has, of| match has {
            true => limit.checked_div(of).unwrap_or(0),
            false => 0,
        };
        limit
            .saturating_sub(part(self.has_backlash(axis), TAKE_UP_PART))
            .saturating_sub(part(self.has_pitch_errors(axis), PITCH_PART))
    }
}
