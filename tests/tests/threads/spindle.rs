//! A spindle written in floating point from the definition of an encoder, independently of the core and of the machine
//! simulation: an angle as a closed function of time, counts as its floor, edges where it crosses a count.

use leadscrew_core::spindle::EncoderSample;
use leadscrew_core::units::Turns;
use std::f64::consts::TAU;

/// Length of a tick in seconds.
pub const TICK_S: f64 = 1e-3;
const COUNTS: f64 = 4096.0;

/// A spindle at a speed with a sine on it, the counter started somewhere in a turn.
#[derive(Clone, Copy)]
pub struct Spindle {
    /// Negative for M04.
    pub turns_per_second: f64,
    /// Part of the speed.
    pub ripple: f64,
    /// Frequency of the ripple.
    pub hz: f64,
    /// Angle at time 0, in turns.
    pub first: f64,
}

impl Spindle {
    pub fn steady(rpm: f64, first: f64) -> Self {
        Self {
            turns_per_second: rpm / 60.0,
            ripple: 0.0,
            hz: 5.0,
            first,
        }
    }

    pub fn angle(&self, t: f64) -> f64 {
        let w = TAU * self.hz;
        self.first + self.turns_per_second * (t + self.ripple / w * (1.0 - (w * t).cos()))
    }

    fn speed(&self, t: f64) -> f64 {
        self.turns_per_second * (1.0 + self.ripple * (TAU * self.hz * t).sin())
    }

    /// What the encoder shows at `t`, with the age of the last edge or without.
    pub fn sample(&self, t: f64, edges: bool) -> EncoderSample {
        let angle = self.angle(t);
        let count = (angle * COUNTS).floor();
        let upper = f64::from(u8::from(self.turns_per_second < 0.0));
        let crossed = (count + upper) / COUNTS;
        let mut at = t;
        for _ in 0..8 {
            at -= (self.angle(at) - crossed) / self.speed(at);
        }
        // The index pulse is the first count of the turn: latched when the counter comes to it, from either side.
        let before = (self.angle(t - TICK_S) * COUNTS).floor();
        let index = if self.turns_per_second > 0.0 {
            let turn = (count / COUNTS).floor() * COUNTS;
            (before < turn).then_some(turn as i32)
        } else {
            let turn = (before / COUNTS).floor() * COUNTS;
            (before > turn && count <= turn).then_some(turn as i32)
        };
        EncoderSample {
            count: count as i32,
            edge_age_ns: edges.then(|| ((t - at) * 1e9).round() as u32),
            index,
        }
    }

    pub fn truth(&self, t: f64) -> Turns {
        Turns::from_raw((self.angle(t) * 2f64.powi(32)).round() as i64)
    }
}
