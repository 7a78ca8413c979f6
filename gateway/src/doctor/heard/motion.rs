//! Targets against positions of a drive: how the axis moves, the ratio of both, the lag, and a pure dead time.

use std::collections::VecDeque;

/// Targets that are remembered: as many periods as a dead time can have.
const PAST: usize = 33;
/// Samples that are kept.
const KEPT: usize = 50_000;
/// Travel from which a ratio is told, in increments.
const TRAVEL: u32 = 1000;
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
    actual: i32,
    targets: [i32; PAST],
}

/// The straight relation of positions to targets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relation {
    /// Increments of the drive to one that it was told.
    pub ratio: f64,
    /// Periods that it lags behind.
    pub lag: f64,
    /// Travel that this was seen over, in increments.
    pub travel: u32,
    /// Samples in motion.
    pub samples: usize,
}

/// Targets and positions.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    targets: VecDeque<i32>,
    samples: Vec<Sample>,
    run: u32,
}

impl Motion {
    /// The target for the next SYNC.
    pub fn target(&mut self, target: i32) {
        self.targets.push_front(target);
        self.targets.truncate(PAST);
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

    /// The ratio and the lag, by least squares of the position over target and speed in every run.
    #[must_use]
    pub fn relation(&self) -> Option<Relation> {
        let (mut ss, mut sv, mut vv, mut sa, mut va) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let (mut travel, mut moving) = (0, 0);
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
            let targets = run.iter().map(|sample| sample.targets[0]);
            if let (Some(low), Some(high)) = (targets.clone().min(), targets.max()) {
                travel = travel.max(low.abs_diff(high));
            }
        }
        if travel < TRAVEL || moving < SAMPLES {
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
        Some(Relation {
            ratio,
            lag: if ratio == 0.0 { 0.0 } else { -speed / ratio },
            travel,
            samples: moving,
        })
    }

    /// Periods that the position comes behind the target, where it is exactly the target of then, ramps included: a
    /// buffer. A lag of a loop is not of this kind.
    #[must_use]
    pub fn dead_time(&self) -> Option<usize> {
        let relation = self.relation()?;
        // A line through all of it would hide which of several fits.
        if (relation.ratio - 1.0).abs() > 0.02 || !self.changes_speed() {
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
