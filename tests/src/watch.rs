//! An axis watched for its limits.

use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

/// Checks a tick's differences against an axis' limits; remembers the last positions.
pub struct Watch {
    last: Vec<i64>,
    speed: f64,
    acceleration: f64,
    /// The limit of the jerk, in nanometres per tick³.
    pub jerk: f64,
    /// Largest share of speed, acceleration and jerk so far.
    pub worst: [f64; 3],
}

impl Watch {
    /// Watches an axis that stands at `at`, in nanometres.
    #[must_use]
    pub fn new(params: &Params, axis: Axis, at: i64) -> Self {
        let tick = f64::from(params.tick_us()) * 1e-6;
        Self {
            last: vec![at; 4],
            speed: params.max_feed(axis).nm_per_min() as f64 / 60.0 * tick,
            acceleration: params.acceleration(axis).nm_per_s2() as f64 * tick.powi(2),
            jerk: params.jerk(axis).nm_per_s3() as f64 * tick.powi(3),
            worst: [0.0; 3],
        }
    }

    /// The axis is there a tick later.
    pub fn see(&mut self, at: i64) {
        self.last.rotate_left(1);
        self.last[3] = at;
        let p = &self.last;
        // Rounding to nanometres may add half of one per position.
        let over = [
            ((p[3] - p[2]).abs() as f64 - 1.0) / self.speed,
            ((p[3] - 2 * p[2] + p[1]).abs() as f64 - 2.0) / self.acceleration,
            ((p[3] - 3 * p[2] + 3 * p[1] - p[0]).abs() as f64 - 4.0) / self.jerk,
        ];
        for (worst, now) in self.worst.iter_mut().zip(over) {
            *worst = worst.max(now);
        }
    }
}
