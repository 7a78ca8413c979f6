//! The total lag D: setpoint − actual = c± + D·v over the constant parts of strokes.

use super::{Known, Refusal, Sample, mean};

/// The end of each constant part that is used, in seconds.
const USED: f64 = 0.5;
/// Directions whose lags differ by more than this are refused, in seconds.
const DIRECTIONS: f64 = 50e-6;
/// A mean that still changes by more than this and half a count, from one half to the next, has not settled, in µm.
const DRIFT: f64 = 0.5;
/// Speeds a direction has to have.
const SPEEDS: usize = 3;

/// A figure with its standard deviation.
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// The figure.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// What the regression says.
#[derive(Clone, Copy, Debug)]
pub struct Lag {
    /// Of both directions.
    pub total: Value,
    /// Of strokes towards plus.
    pub plus: Value,
    /// Of strokes towards minus.
    pub minus: Value,
    /// c₊ − c₋: what does not depend on the speed, as friction with a speed loop without an integral.
    pub offset: f64,
    /// Root of the mean square of what is left.
    pub rms: f64,
}

/// The constant part of a stroke.
struct Part {
    speed: f64,
    /// How long it is.
    length: f64,
    /// Setpoint − actual at its end.
    errors: Vec<f64>,
    /// What the drive tells, less these.
    told: Vec<f64>,
}

impl Part {
    /// The longest one; `None` where the stroke has none with actual positions.
    fn of(stroke: &[Sample], known: &Known) -> Option<Self> {
        let span = known.pace.span();
        let mean = |to: usize| {
            known
                .pace
                .at_the_end(stroke[..=to].iter().rev().map(|of| of.setpoint))
        };
        let mut best = 0..0;
        let (mut from, mut speed) = (0, 0.0);
        for at in span..stroke.len() {
            let Some(now) = mean(at) else { continue };
            if at == span || !known.pace.is_one(now, speed) {
                (from, speed) = (at, now);
            }
            // The mean hears of another speed up to a span late.
            let part = from..(at + 1).saturating_sub(span);
            if !known.pace.rests(speed) && part.len() > best.len() {
                best = part;
            }
        }
        let part = &stroke[best];
        let syncs = part.len().checked_sub(1).filter(|syncs| *syncs > 0)?;
        let length = syncs as f64 * known.tick;
        let speed = (part[syncs].setpoint - part[0].setpoint) / length;
        let used = part.len().saturating_sub((USED / known.tick) as usize);
        let seen = part[used..].iter().filter_map(|sample| {
            let error = sample.setpoint - sample.actual?;
            Some((error, sample.following.map(|told| told - error)))
        });
        let (errors, told): (Vec<_>, Vec<_>) = seen.unzip();
        (errors.len() >= 8).then_some(Self {
            speed,
            length,
            errors,
            told: told.into_iter().flatten().collect(),
        })
    }

    /// Root of the mean square around the means of both halves.
    fn ripple(&self) -> f64 {
        let (first, second) = self.errors.split_at(self.errors.len() / 2);
        let squares = |half: &[f64]| {
            let middle = mean(half);
            half.iter()
                .map(|error| (error - middle).powi(2))
                .sum::<f64>()
        };
        ((squares(first) + squares(second)) / self.errors.len() as f64).sqrt()
    }

    /// By how much the mean of the second half is above the one of the first.
    fn drift(&self) -> f64 {
        let (first, second) = self.errors.split_at(self.errors.len() / 2);
        mean(second) - mean(first)
    }
}

/// Sums of a regression with an offset: of one direction, or the deviations of both together.
#[derive(Clone, Copy, Default)]
struct Sums {
    vv: f64,
    ve: f64,
    ee: f64,
    count: f64,
    /// Offsets that were taken off.
    offsets: f64,
}

impl Sums {
    /// Of deviations from the means, which are given too.
    fn of(parts: &[&Part]) -> (Self, f64, f64) {
        let all = || {
            let of = parts.iter();
            of.flat_map(|part| part.errors.iter().map(|error| (part.speed, *error)))
        };
        let count = all().count() as f64;
        let v = all().map(|(v, _)| v).sum::<f64>() / count;
        let e = all().map(|(_, e)| e).sum::<f64>() / count;
        let mut sums = Self {
            count,
            offsets: 1.0,
            ..Self::default()
        };
        for (speed, error) in all() {
            sums.vv += (speed - v).powi(2);
            sums.ve += (speed - v) * (error - e);
            sums.ee += (error - e).powi(2);
        }
        (sums, v, e)
    }

    fn and(self, other: Self) -> Self {
        Self {
            vv: self.vv + other.vv,
            ve: self.ve + other.ve,
            ee: self.ee + other.ee,
            count: self.count + other.count,
            offsets: self.offsets + other.offsets,
        }
    }

    fn slope(&self) -> f64 {
        self.ve / self.vv
    }

    fn rms(&self) -> f64 {
        ((self.ee - self.slope() * self.ve).max(0.0) / self.count).sqrt()
    }

    /// A count of the encoder repeats itself at constant speed, so that samples of one stroke are not independent: no sd is
    /// below that of a count between the speeds.
    fn value(&self, quantum: f64) -> Value {
        let free = self.count - self.offsets - 1.0;
        let by_samples = self.rms() * (self.count / free / self.vv).sqrt();
        let spread = (self.vv / self.count).sqrt();
        let by_count = quantum / 12_f64.sqrt() / spread / 3_f64.sqrt();
        Value {
            mean: self.slope(),
            sd: by_samples.max(by_count),
        }
    }
}

/// The lag by all strokes.
pub(super) fn find(strokes: &[Vec<Sample>], known: &Known) -> Result<Lag, Refusal> {
    let parts: Vec<Part> = strokes
        .iter()
        .filter_map(|stroke| Part::of(stroke, known))
        .collect();
    let limit = 3.0 * known.quantum + 3.0;
    let towards = |plus: bool| {
        let of: Vec<&Part> = parts.iter().filter(|p| (p.speed > 0.0) == plus).collect();
        let mut speeds: Vec<f64> = of.iter().map(|part| part.speed.abs()).collect();
        speeds.sort_by(f64::total_cmp);
        // Speeds are different ones where they are a tenth apart.
        speeds.dedup_by(|next, before| *next < *before * 1.1);
        if speeds.len() < SPEEDS {
            return Err(Refusal::Speeds { plus });
        }
        Ok(of)
    };
    let (plus, minus) = (towards(true)?, towards(false)?);
    for part in &parts {
        let rms = part.ripple();
        if rms > limit {
            return Err(Refusal::Residual { rms, limit });
        }
        if part.drift().abs() > DRIFT + known.quantum / 2.0 {
            return Err(Refusal::NotSettled { speed: part.speed });
        }
    }
    let (up, up_speed, up_error) = Sums::of(&plus);
    let (down, down_speed, down_error) = Sums::of(&minus);
    let both = up.and(down);
    // Each direction by its own line first: what differs between them is no noise.
    let rms = up.rms().max(down.rms());
    if rms > limit {
        return Err(Refusal::Residual { rms, limit });
    }
    if (up.slope() - down.slope()).abs() > DIRECTIONS {
        return Err(Refusal::Directions {
            plus: up.slope(),
            minus: down.slope(),
        });
    }
    let total = both.value(known.quantum);
    told(&parts, known)?;
    let offset = |speed: f64, error: f64| error - total.mean * speed;
    Ok(Lag {
        total,
        plus: up.value(known.quantum),
        minus: down.value(known.quantum),
        offset: offset(up_speed, up_error) - offset(down_speed, down_error),
        rms: both.rms(),
    })
}

/// Whether the following error of the drive is the one on the bus.
fn told(parts: &[Part], known: &Known) -> Result<(), Refusal> {
    for part in parts.iter().filter(|part| !part.told.is_empty()) {
        let periods = mean(&part.told) / (part.speed * known.tick);
        // What the drive has not begun to interpolate, it does not count: that is its dead time.
        let periods = periods + known.dead_time / known.tick;
        if periods.abs() > 0.5 {
            return Err(Refusal::Following { periods });
        }
    }
    Ok(())
}

/// Whether all strokes were constant for long enough. Where the drive has no feed-forward, the lag behind the dead time is
/// 1/Kv; where it has some, what has not settled is seen by its drift.
pub(super) fn settled(strokes: &[Vec<Sample>], lag: f64, known: &Known) -> Result<(), Refusal> {
    let needed = 8.0 * (lag - known.dead_time) + USED;
    let parts = strokes.iter().filter_map(|of| Part::of(of, known));
    for part in parts {
        if part.length < needed {
            return Err(Refusal::NotSettled { speed: part.speed });
        }
    }
    Ok(())
}
