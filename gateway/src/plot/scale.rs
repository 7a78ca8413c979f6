//! Numbers to pixels, and the round numbers worth a grid line.

/// A linear scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    /// `low`…`high` onto pixels `from`…`to`. An empty range is opened a little, so that it has an inside.
    pub(super) fn new(low: f64, high: f64, from: f64, to: f64) -> Self {
        let (low, high) = if high - low > 1e-9 {
            (low, high)
        } else {
            (low - 0.5, high + 0.5)
        };
        Self {
            low,
            high,
            from,
            to,
        }
    }

    /// The pixel of a value.
    pub(super) fn px(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// The value at a pixel.
    pub(super) fn value(&self, px: f64) -> f64 {
        self.low + (px - self.from) / (self.to - self.from) * (self.high - self.low)
    }

    /// Round values at most `most` steps apart, and their number of decimals.
    pub(super) fn ticks(&self, most: f64) -> (Vec<f64>, usize) {
        let (step, decimals) = round_step((self.high - self.low) / most);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        ((first..=last).map(|n| n as f64 * step).collect(), decimals)
    }
}

/// The smallest of 1, 2, 5 · 10ⁿ that is not below `least`, with the decimals it needs.
fn round_step(least: f64) -> (f64, usize) {
    let exponent = least.log10().floor() as i32;
    let power = 10f64.powi(exponent);
    let factor = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|factor| factor * power >= least * (1.0 - 1e-9))
        .unwrap_or(10.0);
    let carried = if factor >= 10.0 {
        exponent + 1
    } else {
        exponent
    };
    (factor * power, usize::try_from(-carried).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let (ticks, decimals) = Scale::new(-63.0, 52.0, 0.0, 1.0).ticks(8.0);
        assert_eq!(
            (ticks, decimals),
            (vec![-60.0, -40.0, -20.0, 0.0, 20.0, 40.0], 0)
        );
        let (ticks, decimals) = Scale::new(-0.8, 0.9, 0.0, 1.0).ticks(5.0);
        assert_eq!((ticks, decimals), (vec![-0.5, 0.0, 0.5], 1));
    }

    #[test]
    fn a_point_gets_room() {
        let scale = Scale::new(3.0, 3.0, 0.0, 10.0);
        assert!((scale.px(3.0) - 5.0).abs() < 1e-9);
        assert!((scale.value(5.0) - 3.0).abs() < 1e-9);
    }
}
