//! Threads made by formula: what is put in must come out.

mod errors;
mod ideal;
mod norms;
mod turned;
mod volume;

use crate::{Cutter, Designation, Grid, Mm, Nose, Sample, Side, Stock, Tool, Turns, Work};

/// A thread to be made in one pass for each start.
pub(crate) struct Made {
    pub thread: Designation,
    /// What is to be the pitch diameter.
    pub pitch_diameter: f64,
    pub tool: Tool,
    /// Full turns behind the face.
    pub turns: f64,
    /// What the helix is off at a turn counted from the face, of a start.
    pub off: Box<dyn Fn(f64, u8) -> f64>,
    /// Travel per turn that is made.
    pub lead: f64,
    pub grid: Option<Grid>,
}

impl Made {
    pub fn ideal(name: &str, side: Side, pitch_diameter: f64) -> Self {
        let thread = Designation::read(name, side).unwrap();
        Self {
            tool: Tool::vee(thread.angle, Nose::Round(thread.tip())),
            pitch_diameter,
            turns: 8.0,
            off: Box::new(|_, _| 0.0),
            lead: thread.lead().0,
            grid: None,
            thread,
        }
    }

    pub fn stock(&self) -> Stock {
        let crest = match self.thread.side {
            Side::External => self.thread.major,
            Side::Internal => self.thread.minor(),
        };
        Stock {
            side: self.thread.side,
            radius: crest * 0.5,
            taper: self.thread.taper,
            from: Mm(-(self.turns + 2.0) * self.lead),
            face: Mm(0.0),
        }
    }

    /// Radius of the tool's reference: its apex is where the flanks give the pitch diameter.
    pub fn radius(&self) -> f64 {
        let half = self.thread.angle.0.to_radians() / 2.0;
        let Nose::Round(Mm(tip)) = self.tool.nose else {
            panic!("these tools have round tips")
        };
        let side = self.thread.side;
        let pitch_line = side.height(self.pitch_diameter / 2.0);
        let apex = pitch_line - self.thread.pitch.0 / 4.0 / half.tan();
        side.height(apex + tip * (1.0 / half.sin() - 1.0))
    }

    /// Samples of a start: 101.3 of them a turn, which meets no angle twice.
    pub fn samples(&self, start: u8) -> Vec<Sample> {
        let (step, lead) = (1.0 / 101.3, self.lead);
        let shift = f64::from(start) * self.thread.pitch.0;
        let count = ((self.turns + 2.0) / step) as usize;
        let sample = |n: usize| {
            let turn = n as f64 * step - 2.0;
            Sample {
                angle: Turns(turn),
                x: Mm(self.radius() - self.thread.taper * turn * lead),
                z: Mm(-turn * lead - shift - (self.off)(turn, start)),
                pass: u32::from(start) + 1,
            }
        };
        (0..count).map(sample).collect()
    }

    pub fn cut(&self) -> Work {
        let stock = self.stock();
        let grid = self.grid.unwrap_or_else(|| Grid::of(&stock));
        let mut cutter = Cutter::new(Work::new(stock, grid), self.tool);
        for start in 0..self.thread.starts {
            self.samples(start).into_iter().for_each(|s| cutter.push(s));
            cutter.interrupt();
        }
        cutter.finish()
    }
}

/// `value` is within a share of what was put in.
pub(crate) fn within(value: f64, put_in: f64, share: f64) {
    assert!(
        (value - put_in).abs() <= share * put_in.abs(),
        "{value} instead of {put_in}"
    );
}
