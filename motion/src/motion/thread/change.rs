//! What a changing lead takes of the axes' limits: at a steady spindle the axis accelerates all the way.
//!
//! On the helix `q(t)` the long axis has the acceleration `K·ω²`. While it joins or brakes, with the ease `w(q)` made for
//! the greatest speed `v` and the acceleration `a`, it has `w″·q′² + w′·q″`, at most `a + K·ω²`, and the jerk has
//! `3·w″·q′·q″` more, at most `3·a·K·ω²/v`. So both are taken from the limits before anything is made with them. Where
//! the lead begins and ends to change, in the middle of join and brake, the acceleration steps by `K·ω²/2` in a tick.

use super::ramp::{DIAGONAL, seen};
use super::shape::Shape;
use crate::alarm::{Alarm, Arg, Code};
use crate::motion::ease::Bounds;
use crate::motion::limits::bounds;
use crate::motion::wide::mul_div_up;
use crate::params::{Params, metres};
use crate::units::{Acceleration, Axis, Rpm, mul_div, signed};

/// The acceleration of the long axis by the change of its lead, nm/s², and the greatest speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Taken {
    acceleration: u64,
    speed: u64,
    /// The steepest that the short axis follows: the taper, and the way out in mid-thread.
    steepest: u64,
}

impl Taken {
    /// At `rate` (2⁻³² turns a second), at which the long axis reaches `speed` (nm/s).
    #[inline(never)]
    pub fn new(shape: &Shape, rate: u64, speed: u64) -> Self {
        let pm = shape.thread.change.pm().unsigned_abs();
        let per_turn = mul_div_up(pm, rate, 1 << 32);
        Self {
            acceleration: mul_div_up(per_turn, rate, 1000 << 32),
            speed,
            steepest: shape.taper.unsigned_abs().saturating_add(DIAGONAL),
        }
    }

    /// What is left of the long axis' limits.
    pub fn of_long(&self, bounds: Bounds) -> Bounds {
        self.of(bounds, self.acceleration)
    }

    /// What is left of the short axis' limits.
    pub fn of_short(&self, bounds: Bounds) -> Bounds {
        self.of(bounds, seen(self.acceleration, self.steepest))
    }

    fn of(&self, bounds: Bounds, acceleration: u64) -> Bounds {
        if self.acceleration == 0 {
            return bounds;
        }
        let jerk = mul_div_up(
            bounds.acceleration.saturating_mul(3),
            self.acceleration,
            self.speed.max(1),
        );
        Bounds {
            acceleration: bounds.acceleration.saturating_sub(acceleration).max(1),
            jerk: bounds.jerk.saturating_sub(jerk).max(1),
        }
    }

    /// Refuses a change that takes more than half of an axis' limits, or steps by more than its jerk allows in a tick.
    #[inline(never)]
    pub fn check(&self, shape: &Shape, params: &Params, rpm: Rpm) -> Result<(), Alarm> {
        if self.acceleration == 0 {
            return Ok(());
        }
        let (long, short) = shape.axes();
        let axes = [(long, DIAGONAL), (short, self.steepest)];
        for (axis, slope) in axes {
            let Bounds { acceleration, jerk } = bounds(params, axis);
            let tick = mul_div(jerk, u64::from(params.tick_us()), 1_000_000);
            let shared = mul_div(jerk, self.speed, acceleration.saturating_mul(6).max(1));
            let most = (acceleration >> 1)
                .min(tick.saturating_mul(2))
                .min(seen(shared, slope));
            let asked = seen(self.acceleration, slope);
            if asked > most {
                return Err(refused(shape, axis, asked, most, rpm));
            }
        }
        Ok(())
    }
}

#[cold]
fn refused(shape: &Shape, axis: Axis, asked: u64, most: u64, rpm: Rpm) -> Alarm {
    let figure = |size: u64| metres(Acceleration::from_nm_per_s2(signed(size)));
    let alarm = shape.alarm(Code::LeadChangeTooFast).word(b'K');
    alarm.with([
        Arg::Letter(axis.letter()),
        figure(asked),
        figure(most),
        Arg::Rpm(rpm),
    ])
}
