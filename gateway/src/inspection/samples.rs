//! From the machine's ticks to cuts. [`tool_place`] alone says which position of a tick cuts.

use leadscrew_metrology::{Cutter, Grid, Mm, Sample, Turns, Work, inspect, measure};

use super::{Cut, Job};
use crate::failure::Outcome;
use crate::machine::Observer;
use crate::trace::{Setpoint, Summary};

/// Where the tool is at a tick, in work coordinates, and how far the part has turned. Ideal drives are where their
/// setpoints are; others say where they are.
fn tool_place(point: &Setpoint, job: &Job, pass: u32) -> Sample {
    let mm = |nm: i64| Mm(nm as f64 / 1e6);
    let [x, z] = point.actual_nm.unwrap_or([point.x_nm, point.z_nm]);
    Sample {
        angle: Turns(point.s1_urev as f64 / 1e6),
        x: mm(x) - job.origin.0,
        z: mm(z) - job.origin.1,
        pass,
    }
}

/// Cuts the threads of a program while it runs, one after the other.
#[derive(Debug)]
pub struct Cutting {
    /// Sums up, as `simulate` does.
    pub summary: Summary,
    jobs: std::vec::IntoIter<Job>,
    under_way: Option<(Job, Cutter)>,
    /// The last tick was a cut.
    cutting: bool,
    done: Vec<Cut>,
}

impl Cutting {
    /// Nothing is cut yet.
    pub fn new(summary: Summary, jobs: Vec<Job>) -> Self {
        let mut cutting = Self {
            summary,
            jobs: jobs.into_iter(),
            under_way: None,
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
    }

    fn measure(&mut self) {
        let Some((job, cutter)) = self.under_way.take() else {
            return;
        };
        let work = cutter.finish();
        let found = measure(&work, &job.thread);
        let found = found.map(|measured| {
            let inspection = inspect(&measured, &job.thread);
            (measured, inspection)
        });
        self.done.push(Cut { job, work, found });
    }

    /// The threads, all of which are over.
    pub fn finish(mut self) -> Vec<Cut> {
        while self.under_way.is_some() {
            self.measure();
            self.next();
        }
        self.done
    }
}

impl Observer for Cutting {
    fn setpoint(&mut self, point: &Setpoint) -> Outcome {
        self.summary.push(point);
        let last = |job: &Job| job.passes.last().map_or(0, |(_, last, _)| *last);
        while self
            .under_way
            .as_ref()
            .is_some_and(|(job, _)| point.step > last(job))
        {
            self.measure();
            self.next();
        }
        let Some((job, cutter)) = &mut self.under_way else {
            return Ok(());
        };
        let at = job
            .passes
            .partition_point(|(_, last, _)| *last < point.step);
        match job
            .passes
            .get(at)
            .filter(|(first, ..)| *first <= point.step)
        {
            Some((.., pass)) => {
                let sample = tool_place(point, job, *pass);
                cutter.push(sample);
                self.cutting = true;
            }
            None if self.cutting => {
                cutter.interrupt();
                self.cutting = false;
            }
            None => {}
        }
        Ok(())
    }
}
