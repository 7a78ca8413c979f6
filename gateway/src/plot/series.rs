//! Long time series made short without losing extremes.

/// One instant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// Speed of X on the radius, mm/min.
    pub x: f64,
    /// Speed of Z, mm/min.
    pub z: f64,
    /// Spindle, turns per minute.
    pub rpm: f64,
    /// Synchronism error in micrometres, while locked.
    pub error: Option<f64>,
    /// Depth of a tap below R in millimetres, while in a hole.
    pub depth: Option<f64>,
    /// Turns of the spindle since R, while in a hole.
    pub turned: Option<f64>,
}

/// Which value of a [`Sample`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    X,
    Z,
    Rpm,
    Error,
    Depth,
    Turned,
}

/// Buckets kept; twice this many pixels would show no more.
const BUCKETS: usize = 2048;

/// What a channel did inside a bucket.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: f64,
    low: f64,
    high: f64,
    last: f64,
    /// The lowest value came before the highest.
    rising: bool,
}

impl Span {
    fn of(value: f64) -> Self {
        Self {
            first: value,
            low: value,
            high: value,
            last: value,
            rising: true,
        }
    }

    fn then(self, later: Self) -> Self {
        let low_is_later = later.low < self.low;
        let high_is_later = later.high > self.high;
        Self {
            first: self.first,
            low: self.low.min(later.low),
            high: self.high.max(later.high),
            last: later.last,
            rising: match (low_is_later, high_is_later) {
                (false, false) => self.rising,
                (true, true) => later.rising,
                (low_is_later, _) => !low_is_later,
            },
        }
    }
}

type Bucket = [Option<Span>; 6];

/// A time series of any length in bounded memory: equal buckets, each with what every channel did in it. When they are
/// full, neighbours merge.
#[derive(Debug)]
pub struct Envelope {
    tick_s: f64,
    per_bucket: usize,
    in_last: usize,
    buckets: Vec<Bucket>,
}

impl Envelope {
    /// No samples yet, `tick_s` seconds apart.
    pub fn new(tick_s: f64) -> Self {
        Self {
            tick_s,
            per_bucket: 1,
            in_last: 0,
            buckets: Vec::with_capacity(BUCKETS),
        }
    }

    /// Appends the next tick.
    pub fn push(&mut self, sample: &Sample) {
        let new = [
            Some(Span::of(sample.x)),
            Some(Span::of(sample.z)),
            Some(Span::of(sample.rpm)),
            sample.error.map(Span::of),
            sample.depth.map(Span::of),
            sample.turned.map(Span::of),
        ];
        match self.buckets.last_mut() {
            Some(bucket) if self.in_last < self.per_bucket => {
                merge(bucket, &new);
                self.in_last += 1;
            }
            _ => {
                if self.buckets.len() == BUCKETS {
                    self.halve();
                }
                self.buckets.push(new);
                self.in_last = 1;
            }
        }
    }

    fn halve(&mut self) {
        self.buckets = self
            .buckets
            .chunks(2)
            .map(|pair| {
                let mut bucket = pair[0];
                if let Some(second) = pair.get(1) {
                    merge(&mut bucket, second);
                }
                bucket
            })
            .collect();
        self.per_bucket *= 2;
    }

    /// Seconds from the first to the last sample.
    pub fn duration(&self) -> f64 {
        self.buckets.len() as f64 * self.bucket_s()
    }

    fn bucket_s(&self) -> f64 {
        self.per_bucket as f64 * self.tick_s
    }

    /// Lowest and highest value of a channel; `None` where it never had one.
    pub(super) fn range(&self, channel: Channel) -> Option<(f64, f64)> {
        self.buckets
            .iter()
            .filter_map(|bucket| bucket[channel as usize])
            .map(|span| (span.low, span.high))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// The curves of a channel: unbroken runs of (seconds, value).
    pub(super) fn curves(&self, channel: Channel) -> Vec<Vec<(f64, f64)>> {
        let mut curves = Vec::new();
        let mut curve: Vec<(f64, f64)> = Vec::new();
        let width = self.bucket_s();
        for (n, bucket) in self.buckets.iter().enumerate() {
            let Some(span) = bucket[channel as usize] else {
                if !curve.is_empty() {
                    curves.push(std::mem::take(&mut curve));
                }
                continue;
            };
            let start = n as f64 * width;
            let (second, third) = if span.rising {
                (span.low, span.high)
            } else {
                (span.high, span.low)
            };
            for (part, value) in [
                (0.0, span.first),
                (0.35, second),
                (0.65, third),
                (1.0, span.last),
            ] {
                let at = start + part * width;
                match curve.last() {
                    // A level stretch needs its two ends only.
                    Some(&(_, last))
                        if last == value
                            && curve.len() > 1
                            && curve[curve.len() - 2].1 == value =>
                    {
                        let end = curve.len() - 1;
                        curve[end].0 = at;
                    }
                    _ => curve.push((at, value)),
                }
            }
        }
        if !curve.is_empty() {
            curves.push(curve);
        }
        curves
    }
}

fn merge(bucket: &mut Bucket, later: &Bucket) {
    for (span, later) in bucket.iter_mut().zip(later) {
        *span = match (*span, *later) {
            (Some(a), Some(b)) => Some(a.then(b)),
            (a, b) => a.or(b),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_spike_survives_any_length() {
        let mut envelope = Envelope::new(0.001);
        for tick in 0..100_000 {
            let x = if tick == 77_777 { 9.0 } else { 1.0 };
            let error = (tick == 50_000).then_some(-0.5);
            envelope.push(&Sample {
                x,
                error,
                ..Sample::default()
            });
        }
        assert!(envelope.buckets.len() <= BUCKETS);
        assert_eq!(envelope.range(Channel::X), Some((1.0, 9.0)));
        assert_eq!(envelope.range(Channel::Error), Some((-0.5, -0.5)));
        assert!((envelope.duration() - 100.0).abs() < 0.1);
        let curves = envelope.curves(Channel::X);
        assert_eq!(curves.len(), 1);
        assert!(
            curves[0].len() < 10,
            "a level line is two points, a spike a few: {:?}",
            curves[0]
        );
        assert_eq!(envelope.curves(Channel::Error).len(), 1);
    }

    #[test]
    fn order_inside_a_bucket_is_kept() {
        let down = Span::of(2.0).then(Span::of(1.0));
        assert!(!down.rising);
        assert!(down.then(Span::of(3.0)).rising);
        assert!(!Span::of(1.0).then(Span::of(4.0)).then(Span::of(0.0)).rising);
    }
}
