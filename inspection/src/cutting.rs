//! From the positions of a machine, tick by tick, to threads that are cut and measured.

use leadscrew_metrology::{Cutter, Grid, Mm, Sample, Turns, Work, inspect, measure};

use crate::stretch::Stretch;
use crate::{Cut, Job};

/// Where the tool is at a tick, in machine coordinates, and how far the part has turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Number of the move that goes on, from 1.
    pub step: u64,
    /// Angle of the spindle.
    pub angle: Turns,
    /// Radius.
    pub x: Mm,
    /// Z.
    pub z: Mm,
}

impl Instant {
    /// From what a machine tells: millionths of a turn, and nanometres of X (radius) and Z.
    #[must_use]
    pub fn new(step: u64, micro_turns: i64, [x, z]: [i64; 2]) -> Self {
        let mm = |nm: i64| Mm(nm as f64 / 1e6);
        Self {
            step,
            angle: Turns(micro_turns as f64 / 1e6),
            x: mm(x),
            z: mm(z),
        }
    }
}

/// Cuts the threads of a program while it runs, one after the other.
#[derive(Debug)]
pub struct Cutting {
    jobs: std::vec::IntoIter<Job>,
    under_way: Option<(Job, Cutter)>,
    stretch: Stretch,
    /// The last tick was a cut.
    cutting: bool,
    done: Vec<Cut>,
}

impl Cutting {
    /// Nothing is cut yet.
    #[must_use]
    pub fn new(jobs: Vec<Job>) -> Self {
        let mut cutting = Self {
            jobs: jobs.into_iter(),
            under_way: None,
            stretch: Stretch::default(),
            cutting: false,
            done: Vec::new(),
        };
        cutting.next();
        cutting
    }

    fn next(&mut self) {
        self.under_way = self.jobs.next().map(|job| {
            let work = Work::new(job.stock, Grid::of(&job.stock));
            let cutter = Cutter::new(work, job.tool);
            (job, cutter)
        });
        self.cutting = false;
        self.stretch = Stretch::default();
    }

    fn measure(&mut self) {
        let Some((job, cutter)) = self.under_way.take() else {
            return;
        };
        self.stretch.interrupt();
        let mut work = cutter.finish();
        let (low, high) = self.stretch.between();
        work.keep_thread_between(low, high);
        let found = measure(&work, &job.thread);
        let found = found.map(|measured| {
            let inspection = inspect(&measured, &job.thread);
            (measured, inspection)
        });
        self.done.push(Cut { job, work, found });
    }

    /// Takes the next tick.
    pub fn take(&mut self, now: &Instant) {
        let last = |job: &Job| job.passes.last().map_or(0, |(_, last, _)| *last);
        while self
            .under_way
            .as_ref()
            .is_some_and(|(job, _)| now.step > last(job))
        {
            self.measure();
            self.next();
        }
        let Some((job, cutter)) = &mut self.under_way else {
            return;
        };
        let at = job.passes.partition_point(|(_, last, _)| *last < now.step);
        let pass = job.passes.get(at).filter(|(first, ..)| *first <= now.step);
        if let Some((.., pass)) = pass {
            let sample = Sample {
                angle: now.angle,
                x: now.x - job.origin.0,
                z: now.z - job.origin.1,
                pass: *pass,
            };
            cutter.push(sample);
            self.stretch.take(sample, job);
        } else if self.cutting {
            cutter.interrupt();
            self.stretch.interrupt();
        }
        self.cutting = pass.is_some();
    }

    /// The threads that are over and were not taken yet.
    pub fn done(&mut self) -> Vec<Cut> {
        std::mem::take(&mut self.done)
    }

    /// No tick comes any more: all threads are over.
    pub fn finish(&mut self) {
        while self.under_way.is_some() {
            self.measure();
            self.next();
        }
    }
}
