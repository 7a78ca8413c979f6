//! An equivalent model of a drive: dead time, Kv, feed-forward and speed loop that move as the drive does.
//!
//! Dead time and feed-forward are given, and Kv follows from the lag; what is looked for is the speed loop. The parts of
//! a lag cannot be told apart on the bus, so with other figures given another Kv fits as well.

use super::{Known, Sample};

/// Steps of a SYNC period.
const STEPS: u32 = 8;
/// Speed loops that are tried, in rad/s.
const LOOPS: [f64; 5] = [60.0, 120.0, 200.0, 400.0, 800.0];
/// The highest Kv that is looked for, in 1/s; what lags less than this says nothing about Kv.
const HIGHEST: f64 = 500.0;

/// The model.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// Position gain in 1/s; `None` where the lag is dead time alone.
    pub kv: Option<f64>,
    /// Speed loop in rad/s.
    pub speed_loop: f64,
    /// Root of the mean square between model and drive over whole strokes; `None` without a gain.
    pub rms: Option<f64>,
}

/// The best model of strokes with this total lag.
pub(super) fn find(strokes: &[Vec<Sample>], lag: f64, known: &Known) -> Model {
    let mut best = Model {
        kv: None,
        speed_loop: 0.0,
        rms: None,
    };
    let kv = (1.0 - known.feed_forward) / (lag - known.dead_time);
    if !(kv > 0.0 && kv <= HIGHEST) {
        return best;
    }
    for speed_loop in LOOPS {
        let mut model = Model {
            kv: Some(kv),
            speed_loop,
            rms: None,
        };
        let rms = model.distance(strokes, known);
        if best.rms.is_none_or(|least| rms < least) {
            model.rms = Some(rms);
            best = model;
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
                let asked = kv * (wanted - z) + known.feed_forward * speed;
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
