//! A spindle that swings, and its encoder.

extern crate std;

use std::f64::consts::TAU;

use super::super::EncoderSample;

/// A micrometre is this part of a lead of 6 mm.
pub(super) const LEAD_UM: f64 = 6000.0;
/// A turn in the units of an angle.
pub(super) const UNIT: f64 = (1_u64 << 32) as f64;

/// The true angle of a spindle with one swing, on an encoder that begins at its zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swinging {
    counts: u32,
    /// Turns per second.
    turns: f64,
    omega: f64,
    /// Turns.
    size: f64,
    last: i64,
}

impl Swinging {
    /// `swing`: share of the speed, and frequency in Hz.
    pub fn new(counts: u32, rpm: f64, swing: (f64, f64)) -> Self {
        let (part, hz) = swing;
        let (turns, omega) = (rpm / 60.0, TAU * hz);
        Self {
            counts,
            turns,
            omega,
            size: part * turns / omega,
            last: 0,
        }
    }

    /// Turns at the time `t`, in seconds.
    pub fn at(&self, t: f64) -> f64 {
        self.turns * t + self.size * (1.0 - (self.omega * t).cos())
    }

    /// Turns per second.
    pub fn speed(&self, t: f64) -> f64 {
        self.turns + self.size * self.omega * (self.omega * t).sin()
    }

    /// What the encoder shows; the edge is the boundary that was passed last.
    pub fn sample(&mut self, t: f64, timed: bool) -> EncoderSample {
        let counts = f64::from(self.counts);
        let count = (self.at(t) * counts).floor() as i64;
        let boundary = if self.turns > 0.0 { count } else { count + 1 };
        let mut edge = t;
        for _ in 0..8 {
            edge -= (self.at(edge) - boundary as f64 / counts) / self.speed(edge);
        }
        let turn = |count: i64| count.div_euclid(self.counts.into());
        let passed = turn(count) != turn(self.last);
        let zero = turn(count.max(self.last)) * i64::from(self.counts);
        self.last = count;
        EncoderSample {
            count: count as i32,
            edge_age_ns: timed.then_some(((t - edge) * 1e9) as u32),
            index: passed.then_some(zero as i32),
        }
    }
}
