//! What run-ups of the spindle say about it: its ramp, and how its speed varies.
//!
//! A line of the spectrum that keeps its order, cycles in a turn, over several speeds belongs to what turns with the
//! spindle; one that keeps its frequency swings by itself. Times are seconds, angles turns, speeds turns a minute unless
//! told otherwise. Knows nothing of buses, boards, files and words.

use std::f64::consts::TAU;

/// What the bus shows of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Time, counted in SYNC periods.
    pub time: f64,
    /// Angle within the turn.
    pub angle: f64,
    /// Measured speed.
    pub speed: f64,
}

/// What is known before.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// The speed is looked at for so long at each run-up.
    pub seconds: f64,
    /// What changes faster than this is not seen whole, in Hz.
    pub band: f64,
}

/// Why the looks do not carry a result. The speed is the one that was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The spindle turned before it was told to.
    Turning {
        /// The speed.
        asked: f64,
    },
    /// It has not come to this speed.
    NotReached {
        /// The speed.
        asked: f64,
    },
    /// At this speed it did not keep its speed: the halves of the time have different means.
    NotSettled {
        /// The speed.
        asked: f64,
        /// Their difference as a share of the mean.
        share: f64,
    },
    /// It has not come to rest.
    NotAtRest {
        /// The speed.
        asked: f64,
    },
}

/// One run-up, the time at speed, and the way to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct RunUp {
    /// The speed that was asked for.
    pub asked: f64,
    /// The mean speed.
    pub mean: f64,
    /// Seconds for each 1000 turns a minute, from a tenth to nine tenths of the speed.
    pub up: f64,
    /// The same towards rest.
    pub down: f64,
    /// The largest distance from the mean, as a share of it.
    pub variation: f64,
    /// Lines of the spectrum, the largest first.
    pub lines: Vec<Line>,
}

/// A line of the spectrum of the speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Frequency.
    pub hertz: f64,
    /// Amplitude as a share of the mean speed.
    pub share: f64,
}

/// What a line does when the speed changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// It stays at so many cycles in a turn.
    Order(u32),
    /// It stays at this frequency.
    Hertz(f64),
    /// It was seen at one speed alone, or the speeds do not tell both apart: at this frequency.
    Unknown(f64),
}

/// A line over all speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// What it does.
    pub kind: Kind,
    /// Its largest amplitude, as a share of the speed.
    pub share: f64,
    /// Speeds at which it was seen.
    pub seen: usize,
}

/// What has been found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The run-ups in their order.
    pub run_ups: Vec<RunUp>,
    /// The longest time for 1000 turns a minute, up or down.
    pub ramp: f64,
    /// The largest variation.
    pub variation: f64,
    /// The lines of all speeds, the largest first.
    pub sources: Vec<Source>,
}

/// Speeds below this share of the one that was asked for count as rest.
const REST: f64 = 0.02;
/// Bounds of the ramp that is measured, as shares of the speed.
const RAMP: [f64; 2] = [0.1, 0.9];
/// Time between the run-up and the first look that counts, and before the way to rest.
const MARGIN: f64 = 0.5;
/// Means of both halves may be so far apart.
const SETTLED: f64 = 0.01;
/// A line is so many times as high as the middle of the spectrum, and at least this share of the speed.
const ABOVE_NOISE: f64 = 6.0;
const LEAST: f64 = 0.000_5;
/// Most lines that are told of a speed.
const LINES: usize = 5;
/// Lines of two speeds may be the same where neither is smaller than this share of the other.
const ALIKE: f64 = 0.125;
/// Width of a line for the window that is used, in parts of one over the time.
const WIDTH: f64 = 2.0;

/// Looks at run-ups from rest to these speeds and back to rest, in this order.
///
/// # Errors
/// The looks do not carry a result.
pub fn look(looks: &[Look], asked: &[f64], known: &Known) -> Result<Found, Refusal> {
    let mut rest = looks;
    let mut run_ups = Vec::new();
    for &asked in asked {
        let (run_up, behind) = one(rest, asked, known)?;
        run_ups.push(run_up);
        rest = behind;
    }
    let most = |of: fn(&RunUp) -> f64| run_ups.iter().map(of).fold(0.0, f64::max);
    Ok(Found {
        ramp: most(|run_up| run_up.up.max(run_up.down)),
        variation: most(|run_up| run_up.variation),
        sources: sources(&run_ups, known),
        run_ups,
    })
}

/// One run-up at the beginning of `looks`, and what comes after it.
fn one<'a>(looks: &'a [Look], asked: f64, known: &Known) -> Result<(RunUp, &'a [Look]), Refusal> {
    let turns = |look: &Look| look.speed.abs() > REST * asked;
    if looks.first().is_none_or(turns) {
        return Err(Refusal::Turning { asked });
    }
    let begin = looks.iter().position(turns);
    let (before, turning) = looks.split_at(begin.ok_or(Refusal::NotReached { asked })?);
    let end = turning.iter().position(|look| !turns(look));
    let (turning, behind) = turning.split_at(end.ok_or(Refusal::NotAtRest { asked })?);
    let steady = steady(turning, known).ok_or(Refusal::NotReached { asked })?;
    let mean = mean(steady.iter().map(|look| look.speed.abs()));
    let (first, second) = steady.split_at(steady.len() / 2);
    let halves = [first, second].map(|half| self::mean(half.iter().map(|look| look.speed.abs())));
    let share = (halves[0] - halves[1]).abs() / mean;
    if share > SETTLED {
        return Err(Refusal::NotSettled { asked, share });
    }
    let slowest = before.last().into_iter().chain(turning);
    let up = ramp(slowest, mean).ok_or(Refusal::NotReached { asked })?;
    let backwards = behind.first().into_iter().chain(turning.iter().rev());
    let down = ramp(backwards, mean).ok_or(Refusal::NotAtRest { asked })?;
    let off = |look: &Look| (look.speed.abs() - mean).abs() / mean;
    let run_up = RunUp {
        asked,
        mean,
        up,
        down,
        variation: steady.iter().map(off).fold(0.0, f64::max),
        lines: lines(steady, mean, known),
    };
    Ok((run_up, behind))
}

/// The last part of the time at speed; `None` where it is shorter than what is wanted.
fn steady<'a>(turning: &'a [Look], known: &Known) -> Option<&'a [Look]> {
    let mut speeds: Vec<f64> = turning.iter().map(|look| look.speed.abs()).collect();
    speeds.sort_by(f64::total_cmp);
    let middle = *speeds.get(speeds.len() / 2)?;
    let at_speed = |look: &Look| look.speed.abs() >= middle;
    let first = turning.iter().find(|look| at_speed(look))?.time + MARGIN;
    let last = turning.iter().rev().find(|look| at_speed(look))?.time - MARGIN;
    let first = first.max(last - known.seconds);
    if last - first < known.seconds / 2.0 {
        return None;
    }
    let begin = turning.partition_point(|look| look.time < first);
    let end = turning.partition_point(|look| look.time <= last);
    turning.get(begin..end)
}

/// Seconds for each 1000 turns a minute, between two shares of the mean speed.
fn ramp<'a>(looks: impl Iterator<Item = &'a Look>, mean: f64) -> Option<f64> {
    let looks: Vec<&Look> = looks.collect();
    let [low, high] = RAMP.map(|share| {
        let level = share * mean;
        looks.windows(2).find_map(|pair| {
            let [a, b] = [pair[0].speed.abs(), pair[1].speed.abs()];
            (a < level && b >= level)
                .then(|| pair[0].time + (pair[1].time - pair[0].time) * (level - a) / (b - a))
        })
    });
    let speed = (RAMP[1] - RAMP[0]) * mean;
    Some((high? - low?).abs() * 1000.0 / speed)
}

/// The lines of a time at speed.
fn lines(steady: &[Look], mean: f64, known: &Known) -> Vec<Line> {
    let (Some(first), Some(last)) = (steady.first(), steady.last()) else {
        return Vec::new();
    };
    let time = last.time - first.time;
    let swing = detrended(steady);
    let turns_a_second = mean / 60.0;
    // Half of the width of a line, so that none lies between two places.
    let step = WIDTH / 4.0 / time;
    let lowest = (2.0 * WIDTH / time / step).ceil() as usize;
    let highest = (known.band / step).floor() as usize;
    let spectrum: Vec<Line> = (lowest..=highest)
        .map(|place| {
            let hertz = place as f64 * step;
            Line {
                hertz,
                share: TAU * hertz * amplitude(&swing, hertz) / turns_a_second,
            }
        })
        .collect();
    let mut shares: Vec<f64> = spectrum.iter().map(|line| line.share).collect();
    shares.sort_by(f64::total_cmp);
    let noise = shares.get(shares.len() / 2).copied().unwrap_or(0.0);
    let least = (ABOVE_NOISE * noise).max(LEAST);
    let mut peaks: Vec<Line> = spectrum
        .windows(3)
        .filter(|of| of[1].share > least && of[1].share >= of[0].share && of[1].share > of[2].share)
        .map(|of| refined([of[0], of[1], of[2]], step))
        .collect();
    peaks.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut lines: Vec<Line> = Vec::new();
    for peak in peaks {
        let apart = |line: &Line| {
            let widths = (line.hertz - peak.hertz).abs() * time / WIDTH;
            // Beside its own width the window leaves less than two hundredths of a line, which fades with the distance.
            widths > 1.5 && (widths > 6.0 || peak.share > 0.02 * line.share)
        };
        if lines.len() < LINES && lines.iter().all(apart) {
            lines.push(peak);
        }
    }
    lines
}

/// Time and angle without its steady part, weighed by a window of Hann; the angle is followed over turns by the speed.
fn detrended(steady: &[Look]) -> Vec<[f64; 2]> {
    let mut total = 0.0;
    let mut last: Option<&Look> = None;
    let mut points: Vec<[f64; 2]> = steady
        .iter()
        .map(|look| {
            if let Some(last) = last {
                let reckoned = (look.speed + last.speed) / 120.0 * (look.time - last.time);
                let seen = look.angle - last.angle;
                total += seen + (reckoned - seen).round();
            }
            last = Some(look);
            [look.time, total]
        })
        .collect();
    let middle = [0, 1].map(|place| mean(points.iter().map(|point| point[place])));
    let product = |a: usize, b: usize| -> f64 {
        let terms = points.iter();
        terms
            .map(|point| (point[a] - middle[a]) * (point[b] - middle[b]))
            .sum()
    };
    let slope = product(0, 1) / product(0, 0);
    let count = points.len() as f64;
    for (place, point) in points.iter_mut().enumerate() {
        let weight = 1.0 - (TAU * (place as f64 + 0.5) / count).cos();
        point[1] = (point[1] - middle[1] - slope * (point[0] - middle[0])) * weight;
    }
    points
}

/// The amplitude at a frequency of points that [`detrended`] has weighed: its weights have the mean 1.
fn amplitude(points: &[[f64; 2]], hertz: f64) -> f64 {
    let (mut real, mut imaginary) = (0.0, 0.0);
    for [time, value] in points {
        let (sin, cos) = (TAU * hertz * time).sin_cos();
        real += value * cos;
        imaginary += value * sin;
    }
    2.0 * f64::hypot(real, imaginary) / points.len() as f64
}

/// The top of the parabola through three neighbours.
fn refined([before, at, after]: [Line; 3], step: f64) -> Line {
    let (a, b, c) = (before.share, at.share, after.share);
    let bend = a - 2.0 * b + c;
    let off = if bend < 0.0 {
        (a - c) / (2.0 * bend)
    } else {
        0.0
    };
    Line {
        hertz: at.hertz + off * step,
        share: b - (a - c) * off / 4.0,
    }
}

/// What the lines of several speeds have in common.
fn sources(run_ups: &[RunUp], known: &Known) -> Vec<Source> {
    let width = WIDTH / known.seconds;
    let order = |run_up: &RunUp, line: &Line| {
        let turns_a_second = run_up.mean / 60.0;
        let order = (line.hertz / turns_a_second).round();
        let near = (line.hertz - order * turns_a_second).abs() <= width;
        (order >= 1.0 && near).then_some(order as u32)
    };
    let mut left: Vec<(usize, Line)> = run_ups
        .iter()
        .enumerate()
        .flat_map(|(place, run_up)| run_up.lines.iter().map(move |line| (place, *line)))
        .collect();
    left.sort_by(|(_, a), (_, b)| b.share.total_cmp(&a.share));
    let mut sources = Vec::new();
    while let Some(&(place, line)) = left.first() {
        let own = order(&run_ups[place], &line);
        // What is much smaller is a mixture of other lines that has this frequency by chance.
        let alike = |other: &Line| other.share >= ALIKE * line.share;
        let of_order = |(at, other): &(usize, Line)| {
            own.is_some() && order(&run_ups[*at], other) == own && alike(other)
        };
        let of_hertz =
            |(_, other): &(usize, Line)| (other.hertz - line.hertz).abs() <= width && alike(other);
        let (orders, hertz) = (over(&left, &of_order), over(&left, &of_hertz));
        // A mixture that has the frequency by chance weighs less than a line that keeps its size.
        let heavier =
            |of: Seen, than: Seen| of.speeds > 1 && of.weight - than.weight > ALIKE * line.share;
        let kind = match own {
            Some(order) if heavier(orders, hertz) => Kind::Order(order),
            _ if heavier(hertz, orders) => Kind::Hertz(line.hertz),
            _ => Kind::Unknown(line.hertz),
        };
        sources.push(Source {
            kind,
            share: line.share,
            seen: match kind {
                Kind::Order(_) => orders.speeds,
                Kind::Hertz(_) => hertz.speeds,
                Kind::Unknown(_) => orders.speeds.max(hertz.speeds),
            },
        });
        match kind {
            Kind::Order(_) => left.retain(|of| !of_order(of)),
            Kind::Hertz(_) => left.retain(|of| !of_hertz(of)),
            Kind::Unknown(_) => left.retain(|of| !of_order(of) && !of_hertz(of)),
        }
    }
    sources
}

/// Where a line was seen.
#[derive(Clone, Copy)]
struct Seen {
    /// Speeds.
    speeds: usize,
    /// The sum of its share over these.
    weight: f64,
}

/// The lines that are the same, the largest of each speed; `lines` have the largest first.
fn over(lines: &[(usize, Line)], same: &dyn Fn(&(usize, Line)) -> bool) -> Seen {
    let mut places = Vec::new();
    let mut weight = 0.0;
    for (place, line) in lines.iter().filter(|of| same(of)) {
        if !places.contains(place) {
            places.push(*place);
            weight += line.share;
        }
    }
    Seen {
        speeds: places.len(),
        weight,
    }
}

fn mean(of: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = of.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}

#[cfg(test)]
mod tests;
