//! What the strokes of an axis say about its drive, and run-ups about the spindle: samples in, figures or a refusal out.
//!
//! [`lag`] finds the total lag by regression, [`model`] an equivalent model that has this lag; [`spindle`] looks at
//! run-ups of a spindle. Lengths are micrometres of the slide, times are seconds. Knows nothing of buses, boards, files
//! and words.

mod lag;
mod model;
mod pace;
pub mod spindle;
#[cfg(test)]
mod tests;

pub use lag::{Lag, Value};
pub use model::Model;
pub use pace::Pace;

/// What the bus shows of an axis at one SYNC.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The setpoint that this SYNC latches.
    pub setpoint: f64,
    /// The actual position at this SYNC; not every SYNC has one.
    pub actual: Option<f64>,
    /// The following error that the drive tells (60F4h), where it was read.
    pub following: Option<f64>,
}

/// What is known before.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// SYNC period.
    pub tick: f64,
    /// How speeds of the setpoints are told apart.
    pub pace: Pace,
    /// A count of the encoder.
    pub quantum: f64,
    /// Time until a setpoint is the drive's own target: buffer and interpolation.
    pub dead_time: f64,
    /// Feed-forward of the speed that the drive is set to, 0 to 1.
    pub feed_forward: f64,
}

/// Why the data do not carry a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// Fewer than three speeds have a constant part with actual positions in this direction.
    Speeds {
        /// The direction.
        plus: bool,
    },
    /// The lag of a stroke still changes, or the constant part is too short for this drive.
    NotSettled {
        /// Of this stroke.
        speed: f64,
    },
    /// The samples are farther from the line than the encoder explains.
    Residual {
        /// Root of the mean square.
        rms: f64,
        /// The highest that is taken.
        limit: f64,
    },
    /// The lag depends on the direction.
    Directions {
        /// Towards plus.
        plus: f64,
        /// Towards minus.
        minus: f64,
    },
    /// Two runs say different things.
    Runs {
        /// The first.
        first: f64,
        /// The second.
        second: f64,
    },
    /// The following error that the drive tells is another one, by so many SYNC periods.
    Following {
        /// Periods.
        periods: f64,
    },
}

/// What has been found.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Total lag and what belongs to it.
    pub lag: Lag,
    /// An equivalent model of the drive.
    pub model: Model,
    /// Root of the mean square of the actual position around its mean, at rest.
    pub noise_at_rest: Option<f64>,
    /// The same around the line of the lag, at speed.
    pub noise_at_speed: f64,
}

/// Looks at two runs, each with strokes at three speeds in both directions. `rest`: samples with the axis at rest.
///
/// # Errors
/// The data do not carry a result.
pub fn look(
    runs: &[Vec<Vec<Sample>>; 2],
    rest: &[Sample],
    known: &Known,
) -> Result<Found, Refusal> {
    let [first, second] = runs;
    let (one, two) = (lag::find(first, known)?, lag::find(second, known)?);
    let sd = one.total.sd.hypot(two.total.sd);
    if (one.total.mean - two.total.mean).abs() > 3.0 * sd {
        return Err(Refusal::Runs {
            first: one.total.mean,
            second: two.total.mean,
        });
    }
    let all: Vec<Vec<Sample>> = first.iter().chain(second).cloned().collect();
    let found = lag::find(&all, known)?;
    lag::settled(&all, found.total.mean, known)?;
    let model = model::find(first, found.total.mean, known);
    Ok(Found {
        lag: found,
        model,
        noise_at_rest: noise(rest),
        noise_at_speed: found.rms,
    })
}

/// `None` without at least two samples.
fn noise(rest: &[Sample]) -> Option<f64> {
    let at: Vec<f64> = rest.iter().filter_map(|sample| sample.actual).collect();
    if at.len() < 2 {
        return None;
    }
    let mean = mean(&at);
    let squares: Vec<f64> = at.iter().map(|z| (z - mean).powi(2)).collect();
    Some(self::mean(&squares).sqrt())
}

fn mean(of: &[f64]) -> f64 {
    of.iter().sum::<f64>() / of.len().max(1) as f64
}
