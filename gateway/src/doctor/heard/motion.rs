//! Targets against positions of a drive: how the axis moves, its way from rest to rest, the lag, and a pure dead time.

use std::collections::VecDeque;

/// Targets that are remembered: as many periods as a dead time can have.
const PAST: usize = 33;
/// Samples that are kept.
const KEPT: usize = 50_000;
/// Travel from which a ratio is told, in increments.
const TRAVEL: u32 = 1000;
/// Increments by which a position that stands may change.
const STANDS: u32 = 2;
/// Of so many samples.
const SAMPLES: usize = 30;

/// What an axis does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// It stands.
    Rest,
    /// It changes its speed.
    Ramp,
    /// It moves at one speed.
    Steady,
    /// It is held to a helix.
    Thread,
}

/// A position, and the targets before it: the newest first.
#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Counts up where the drive was not enabled between.
    run: u32,
    /// Targets that were heard until then.
    heard: usize,
    actual: i32,
    targets: [i32; PAST],
}

/// How far an axis goes from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// Increments of the drive to one that it was told.
    pub ratio: f64,
    /// Travel that this was seen over, in increments.
    pub travel: u32,
    /// Ways from rest to rest.
    pub ways: u64,
}

/// Targets and positions.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    targets: VecDeque<i32>,
    heard: usize,
    samples: Vec<Sample>,
    run: u32,
}

impl Motion {
    /// The target for the next SYNC.
    pub fn target(&mut self, target: i32) {
        self.targets.push_front(target);
        self.targets.truncate(PAST);
        self.heard += 1;
    }

    /// What comes does not belong to what came.
    pub fn interrupt(&mut self) {
        if self.samples.last().is_some_and(|last| last.run == self.run) {
            self.run += 1;
        }
    }

    /// A position, at the SYNC at which the drive latches the newest target.
    pub fn sample(&mut self, actual: i32) {
        if self.samples.len() >= KEPT || self.targets.len() < PAST {
            return;
        }
        let mut targets = [0; PAST];
        for (slot, target) in targets.iter_mut().zip(&self.targets) {
            *slot = *target;
        }
        self.samples.push(Sample {
            run: self.run,
            heard: self.heard,
            actual,
            targets,
        });
    }

    /// What the axis is told to do now, and its speed in increments a period.
    #[must_use]
    pub fn way(&self) -> (Way, u32) {
        let at = |place: usize| self.targets.get(place).copied();
        let (Some(now), Some(middle), Some(then)) = (at(0), at(8), at(16)) else {
            return (Way::Rest, 0);
        };
        let (late, early) = (now.wrapping_sub(middle), middle.wrapping_sub(then));
        let speed = now.abs_diff(then) / 16;
        let way = match late.abs_diff(early) {
            _ if now == then && now == middle => Way::Rest,
            // Two hundredths of the speed, or a count in each.
            change if change > 8 + late.unsigned_abs() / 50 => Way::Ramp,
            _ => Way::Steady,
        };
        (way, speed)
    }

    /// It was told to go far enough for a ratio.
    #[must_use]
    pub fn has_moved(&self) -> bool {
        self.samples.chunk_by(|a, b| a.run == b.run).any(is_far)
    }

    /// The way of the axis from rest to rest. In motion an axis lags, and in a ramp no line is what its loop does.
    #[must_use]
    pub fn gear(&self) -> Option<Gear> {
        let (mut told, mut gone) = (0.0, 0.0);
        let (mut travel, mut ways) = (0, 0);
        for run in self.samples.chunk_by(|a, b| a.run == b.run) {
            let mut rested: Option<&Sample> = None;
            let mut stands = run.first();
            for sample in run {
                let still = stands.filter(|from| from.actual.abs_diff(sample.actual) <= STANDS);
                let since = still.unwrap_or(sample);
                stands = Some(since);
                if is_moving(sample) || sample.heard - since.heard < PAST {
                    continue;
                }
                let Some(from) = rested else {
                    rested = Some(sample);
                    continue;
                };
                let way = sample.targets[0].abs_diff(from.targets[0]);
                if way >= TRAVEL {
                    let both = |to: i32, from: i32| f64::from(to) - f64::from(from);
                    let target = both(sample.targets[0], from.targets[0]);
                    told += target * target;
                    gone += target * both(sample.actual, from.actual);
                    travel = travel.max(way);
                    ways += 1;
                    rested = Some(sample);
                }
            }
        }
        (ways > 0).then(|| Gear {
            ratio: gone / told,
            travel,
            ways,
        })
    }

    /// Periods that the axis lags behind, by least squares of the position over target and speed in every run.
    #[must_use]
    pub fn lag(&self) -> Option<f64> {
        let (mut ss, mut sv, mut vv, mut sa, mut va) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let mut moving = 0;
        for run in self.samples.chunk_by(|a, b| a.run == b.run) {
            let count = run.len() as f64;
            let places: Vec<[f64; 3]> = run.iter().filter_map(of_sample).collect();
            if places.len() != run.len() {
                continue;
            }
            let mean =
                [0, 1, 2].map(|of| places.iter().map(|place| place[of]).sum::<f64>() / count);
            for place in &places {
                let [s, v, a] = [0, 1, 2].map(|of| place[of] - mean[of]);
                ss += s * s;
                sv += s * v;
                vv += v * v;
                sa += s * a;
                va += v * a;
                moving += usize::from(place[1] != 0.0);
            }
        }
        if !self.has_moved() || moving < SAMPLES {
            return None;
        }
        let determinant = ss * vv - sv * sv;
        let (ratio, speed) = if determinant > 1e-9 * ss * vv {
            (
                (sa * vv - va * sv) / determinant,
                (va * ss - sa * sv) / determinant,
            )
        } else {
            (sa / ss, 0.0)
        };
        Some(if ratio == 0.0 { 0.0 } else { -speed / ratio })
    }

    /// Periods that the position comes behind the target, where it is exactly the target of then, ramps included: a
    /// buffer. A lag of a loop is not of this kind.
    #[must_use]
    pub fn dead_time(&self) -> Option<usize> {
        self.lag()?;
        // A line through all of it would hide which of several fits.
        if !self.changes_speed() {
            return None;
        }
        let off = |dead: usize| {
            let moving = self.samples.iter().filter(|sample| is_moving(sample));
            moving
                .map(|sample| sample.targets[dead].abs_diff(sample.actual))
                .max()
        };
        let best = (0..PAST).min_by_key(|dead| off(*dead))?;
        (off(best)? <= 3).then_some(best)
    }

    fn changes_speed(&self) -> bool {
        let speed = |sample: &Sample| sample.targets[0].wrapping_sub(sample.targets[1]);
        let speeds = self.samples.iter().map(speed);
        match (speeds.clone().min(), speeds.max()) {
            (Some(low), Some(high)) => low.abs_diff(high) > 10,
            _ => false,
        }
    }
}

/// The targets of these go far enough.
fn is_far(run: &[Sample]) -> bool {
    let targets = run.iter().map(|sample| sample.targets[0]);
    let ends = targets.clone().min().zip(targets.max());
    ends.is_some_and(|(low, high)| low.abs_diff(high) >= TRAVEL)
}

fn is_moving(sample: &Sample) -> bool {
    sample
        .targets
        .iter()
        .any(|target| *target != sample.targets[0])
}

/// Target, speed and position.
fn of_sample(sample: &Sample) -> Option<[f64; 3]> {
    let speed = sample.targets[0].checked_sub(sample.targets[1])?;
    Some([sample.targets[0].into(), speed.into(), sample.actual.into()])
}
