//! Whether targets go on at one speed.
//!
//! Single steps do not tell: targets are whole increments, and where the board takes the lag of a drive off (9070) it
//! leads by 1/(2·T·Kv) times as much as its setpoints, whole nanometres, are off. So speeds are means over a span.

/// Length of the span, in seconds.
const SPAN: f64 = 0.02;
/// Means that differ by less than this share of the speed are the same: what is known beforehand (9071) comes near to its
/// speed for ever.
const SHARE: f64 = 0.005;
/// A nanometre, in µm.
const NM: f64 = 0.001;

/// How speeds are told apart.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Targets from the first to the last of a mean.
    span: usize,
    /// Means that are apart by less than this are the same, in µm a tick.
    apart: f64,
}

impl Pace {
    /// By an increment in µm, the tick in seconds, and the gain that the board takes off in 1/s, if it does.
    #[must_use]
    pub fn of(increment: f64, tick: f64, gain: Option<f64>) -> Self {
        let span = (SPAN / tick).round().max(4.0);
        let lead = gain.map_or(0.0, |kv| 0.5 / (tick * kv));
        // A setpoint is off by half a nanometre; three of them lead, with weights of 3, 4 and 1.
        let off = increment / 2.0 + 4.0 * NM * lead;
        Self {
            span: span as usize,
            // Two means, with two ends each.
            apart: 4.0 * off / span,
        }
    }

    /// Targets from the first to the last of a mean.
    #[must_use]
    pub const fn span(&self) -> usize {
        self.span
    }

    /// The mean step up to the last target; `None` where there are too few.
    #[must_use]
    pub fn at_the_end(&self, mut newest_first: impl Iterator<Item = f64>) -> Option<f64> {
        let last = newest_first.next()?;
        let first = newest_first.nth(self.span - 1)?;
        Some((last - first) / self.span as f64)
    }

    /// Whether two mean steps are of one speed.
    #[must_use]
    pub fn is_one(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= self.apart + SHARE * a.abs().max(b.abs())
    }

    /// Whether this mean step is none.
    #[must_use]
    pub fn rests(&self, step: f64) -> bool {
        step.abs() <= self.apart
    }
}
