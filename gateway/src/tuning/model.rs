//! An equivalent model of a drive: dead time, Kv, feed-forward and speed loop that move as the drive does.
//!
//! Dead time is given, and Kv follows from the lag and the feed-forward, so the grid has two figures only. The parts cannot
//! be told apart on the bus: other figures fit as well, and none of these is a setting of the drive.

use super::{Known, Sample};

/// Steps of a SYNC period.
const STEPS: u32 = 8;
/// Steps of the feed-forward from 0 to 1.
const GRID: u32 = 10;
/// Speed loops that are tried, in rad/s.
const LOOPS: [f64; 5] = [60.0, 120.0, 200.0, 400.0, 800.0];
/// The highest Kv that is looked for, in 1/s; what lags less than this says nothing about Kv.
const HIGHEST: f64 = 500.0;

/// The model.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Position gain in 1/s; `None` where the lag is dead time alone.
    pub kv: Option<f64>,
    /// Feed-forward of the speed, 0 to 1.
    pub feed_forward: f64,
    /// Speed loop in rad/s.
    pub speed_loop: f64,
    /// Root of the mean square between model and drive over whole strokes.
    pub rms: f64,
}

/// The best of the grid for strokes with this total lag.
pub(super) fn find(strokes: &[Vec<Sample>], lag: f64, known: &Known) -> Model {
    let rest = lag - known.dead_time;
    let mut best = Model {
        kv: None,
        feed_forward: 1.0,
        speed_loop: 0.0,
        rms: f64::INFINITY,
    };
    for part in 0..GRID {
        let feed_forward = f64::from(part) / f64::from(GRID);
        let kv = (1.0 - feed_forward) / rest;
        if !(kv > 0.0 && kv <= HIGHEST) {
            continue;
        }
        for speed_loop in LOOPS {
            let mut model = Model {
                kv: Some(kv),
                feed_forward,
                speed_loop,
                rms: 0.0,
            };
            model.rms = model.distance(strokes, known);
            if model.rms < best.rms {
                best = model;
            }
        }
    }
    best
}

impl Model {
    /// Setpoint − position of the model at each SYNC of a stroke that begins at rest.
    #[must_use]
    pub fn errors(&self, stroke: &[Sample], known: &Known) -> Vec<f64> {
        let Some(kv) = self.kv else {
            return vec![0.0; stroke.len()];
        };
        let target = |syncs: f64| {
            let low = syncs.floor().max(0.0);
            let at = |index: usize| stroke[index.min(stroke.len() - 1)].setpoint;
            let (before, after) = (at(low as usize), at(low as usize + 1));
            before + (after - before) * (syncs - low).clamp(0.0, 1.0)
        };
        let step = known.tick / f64::from(STEPS);
        let Some(mut z) = stroke.first().map(|sample| sample.setpoint) else {
            return Vec::new();
        };
        let mut v = 0.0;
        let mut errors = Vec::with_capacity(stroke.len());
        for (sync, sample) in stroke.iter().enumerate() {
            errors.push(sample.setpoint - z);
            for part in 1..=STEPS {
                let at = sync as f64 + f64::from(part) / f64::from(STEPS);
                let at = at - known.dead_time / known.tick;
                let wanted = target(at);
                let speed = (wanted - target(at - 1.0 / f64::from(STEPS))) / step;
                let asked = kv * (wanted - z) + self.feed_forward * speed;
                v += self.speed_loop * (asked - v) * step;
                z += v * step;
            }
        }
        errors
    }

    fn distance(&self, strokes: &[Vec<Sample>], known: &Known) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0);
        for stroke in strokes {
            for (error, sample) in self.errors(stroke, known).iter().zip(stroke) {
                if let Some(actual) = sample.actual {
                    squares += (sample.setpoint - actual - error).powi(2);
                    count += 1.0;
                }
            }
        }
        (squares / f64::max(count, 1.0)).sqrt()
    }
}
