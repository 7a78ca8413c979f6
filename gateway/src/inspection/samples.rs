//! From the machine's ticks to cuts. [`instant`] alone says which position of a tick cuts.

use leadscrew_inspection::{Cut, Cutting, Instant, Job};

use crate::failure::Outcome;
use crate::machine::Observer;
use crate::trace::{Setpoint, Summary};

/// Where the tool is at a tick. Ideal drives are where their setpoints are; others say where they are.
fn instant(point: &Setpoint) -> Instant {
    let place = point.actual_nm.unwrap_or([point.x_nm, point.z_nm]);
    Instant::new(point.step, point.s1_urev, place)
}

/// Cuts the threads of a program while it runs.
#[derive(Debug)]
pub struct Threads {
    /// Sums up, as `simulate` does.
    pub summary: Summary,
    cutting: Cutting,
}

impl Threads {
    /// Nothing is cut yet.
    pub fn new(summary: Summary, jobs: Vec<Job>) -> Self {
        let cutting = Cutting::new(jobs);
        Self { summary, cutting }
    }

    /// The threads, all of which are over.
    pub fn finish(mut self) -> Vec<Cut> {
        self.cutting.finish();
        self.cutting.done()
    }
}

impl Observer for Threads {
    fn setpoint(&mut self, point: &Setpoint) -> Outcome {
        self.summary.push(point);
        self.cutting.take(&instant(point));
        Ok(())
    }
}
