//! From a stream of samples to cuts: where the tool stands each time the part passes one of its angles.

use crate::tool::Tool;
use crate::units::{Mm, Turns};
use crate::work::Work;

/// Where the tool is at an instant: its reference point, and the angle of the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Angle of the part, continuous.
    pub angle: Turns,
    /// Radius.
    pub x: Mm,
    /// Along the axis.
    pub z: Mm,
    /// The pass that the chip is counted in.
    pub pass: u32,
}

/// Cuts a part by samples.
#[derive(Clone, Debug)]
pub struct Cutter {
    work: Work,
    tool: Tool,
    /// The last three samples, oldest first.
    last: Vec<Sample>,
}

impl Cutter {
    /// A tool beside uncut work.
    #[must_use]
    pub fn new(work: Work, tool: Tool) -> Self {
        Self {
            work,
            tool,
            last: Vec::with_capacity(4),
        }
    }

    /// The next sample of an even stream.
    pub fn push(&mut self, sample: Sample) {
        self.last.push(sample);
        match self.last.as_slice() {
            [a, b, _] => {
                let ends = [*a, *b];
                self.between(&ends, None);
            }
            [a, b, c, d] => {
                let (ends, outer) = ([*b, *c], [*a, *d]);
                self.between(&ends, Some(outer));
                self.last.remove(0);
            }
            _ => {}
        }
    }

    /// The tool goes away: what comes next does not follow from what was.
    pub fn interrupt(&mut self) {
        if let [.., a, b] = self.last.as_slice() {
            let ends = [*a, *b];
            self.between(&ends, None);
        }
        self.last.clear();
    }

    /// The part, with all samples in it.
    #[must_use]
    pub fn finish(mut self) -> Work {
        self.interrupt();
        self.work
    }

    /// Cuts at each angle that is passed between two samples.
    fn between(&mut self, ends: &[Sample; 2], outer: Option<[Sample; 2]>) {
        let angles = self.work.grid().angles as f64;
        let (from, to) = (ends[0].angle.0 * angles, ends[1].angle.0 * angles);
        // An angle belongs to the step that ends on it.
        let (first, last) = if to > from {
            (from.floor() as i64 + 1, to.floor() as i64)
        } else {
            (to.ceil() as i64, from.ceil() as i64 - 1)
        };
        let course = if (ends[1].z.0 - ends[0].z.0) * (to - from) > 0.0 {
            1
        } else {
            -1
        };
        let points = outer.filter(|outer| is_even(ends, outer));
        for index in first..=last {
            let angle = index as f64 / angles;
            let (z, x) = match points {
                Some([before, after]) => {
                    let nodes = [before, ends[0], ends[1], after];
                    let place = |pick: fn(&Sample) -> f64| cubic(&nodes, pick, angle);
                    (place(|s| s.z.0), place(|s| s.x.0))
                }
                None => {
                    let part = (angle - ends[0].angle.0) / (ends[1].angle.0 - ends[0].angle.0);
                    let mix = |a: Mm, b: Mm| a.0 + (b.0 - a.0) * part;
                    (mix(ends[0].z, ends[1].z), mix(ends[0].x, ends[1].x))
                }
            };
            let node = index.rem_euclid(self.work.grid().angles as i64) as usize;
            let pass = ends[1].pass;
            self.work.stamp(node, z, x, &self.tool, pass, course);
        }
    }
}

/// The angle goes on evenly enough for a cubic through four samples.
fn is_even(ends: &[Sample; 2], outer: &[Sample; 2]) -> bool {
    let inner = ends[1].angle.0 - ends[0].angle.0;
    let alike = |step: f64| step / inner > 0.25 && step / inner < 4.0;
    alike(ends[0].angle.0 - outer[0].angle.0) && alike(outer[1].angle.0 - ends[1].angle.0)
}

/// The cubic through four samples over the angle.
fn cubic(nodes: &[Sample; 4], pick: fn(&Sample) -> f64, angle: f64) -> f64 {
    let base = pick(&nodes[1]);
    nodes
        .iter()
        .enumerate()
        .map(|(i, node)| {
            let weight: f64 = nodes
                .iter()
                .enumerate()
                .filter(|(k, _)| *k != i)
                .map(|(_, other)| (angle - other.angle.0) / (node.angle.0 - other.angle.0))
                .product();
            weight * (pick(node) - base)
        })
        .sum::<f64>()
        + base
}
