//! From where to where the passes of a thread go on their helix.
//!
//! A stroke without run-out stops in the work. While it brakes the spindle turns on, and where it stands the tool cuts a
//! ring: an inspector takes that for the end of the thread, not for a turn of it. So what a tool cuts after it has left its
//! lead for good is beyond the stretch. Where it joins late, it has not left yet: that is thread, and a bad one.

use leadscrew_metrology::{Mm, Sample, Side};

use crate::Job;

/// The share of the lead below which a tool has left its helix.
const ON_LEAD: f64 = 0.9;

/// What is known so far.
#[derive(Debug)]
pub(crate) struct Stretch {
    before: Option<Sample>,
    /// The way along Z of this cut since it is on its helix: +1, −1, or 0.
    way: f64,
    /// Where it has left it, if it does not come back.
    left: Option<f64>,
    low: f64,
    high: f64,
}

impl Default for Stretch {
    fn default() -> Self {
        Self {
            before: None,
            way: 0.0,
            left: None,
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        }
    }
}

impl Stretch {
    /// Takes the next sample of a pass.
    pub(crate) fn take(&mut self, now: Sample, job: &Job) {
        let before = self.before.replace(now);
        let before = before.filter(|before| before.pass == now.pass && is_in_work(&now, job));
        let Some(before) = before else {
            self.leave();
            return;
        };
        let turned = (now.angle.0 - before.angle.0).abs();
        let lead = job.thread.lead().0;
        let way = now.z.0 - before.z.0;
        if way.abs() >= ON_LEAD * lead * turned {
            if self.way == 0.0 {
                self.way = way.signum();
            }
            if way * self.way > 0.0 {
                self.left = None;
            }
        } else if self.way != 0.0 && self.left.is_none() {
            self.left = Some(before.z.0);
        }
    }

    /// The tool goes away.
    pub(crate) fn interrupt(&mut self) {
        self.before = None;
        self.leave();
    }

    /// The cut is over.
    fn leave(&mut self) {
        if let Some(z) = self.left.take() {
            if self.way < 0.0 {
                self.low = self.low.max(z);
            } else {
                self.high = self.high.min(z);
            }
        }
        self.way = 0.0;
    }

    /// The places between which all passes were on their helix.
    pub(crate) const fn between(&self) -> (Mm, Mm) {
        (Mm(self.low), Mm(self.high))
    }
}

/// The tip is below the surface before the cut.
fn is_in_work(now: &Sample, job: &Job) -> bool {
    let stock = &job.stock;
    let surface = stock.radius.0 + stock.taper * (now.z.0 - stock.face.0);
    now.z.0 <= stock.face.0
        && match stock.side {
            Side::External => now.x.0 < surface,
            Side::Internal => now.x.0 > surface,
        }
}
