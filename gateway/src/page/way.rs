//! Where the tool was, at equal times: as many samples as a page can carry, whatever the length of the run.

use crate::json::Json;
use crate::number;

/// The most samples. A run of twenty minutes has one for every tenth of a second then.
const MOST: usize = 20_000;

/// Positions at equal times, in nanometres of the work.
#[derive(Debug)]
pub struct Way {
    samples: Vec<(u32, i64, i64)>,
    /// Seconds of a tick.
    tick: f64,
    /// Ticks from one sample to the next: a power of two.
    every: u64,
    ticks: u64,
}

impl Way {
    /// An empty one, of a machine with this tick in seconds.
    pub const fn new(tick: f64) -> Self {
        Self {
            samples: Vec::new(),
            tick,
            every: 1,
            ticks: 0,
        }
    }

    /// Adds the tick's line and position: radius and Z.
    pub fn push(&mut self, line: u32, x_nm: i64, z_nm: i64) {
        if self.ticks.is_multiple_of(self.every) {
            if self.samples.len() == MOST {
                let mut number = 0_usize;
                self.samples.retain(|_| {
                    number += 1;
                    number % 2 == 1
                });
                self.every *= 2;
            }
            if self.ticks.is_multiple_of(self.every) {
                self.samples.push((line, x_nm, z_nm));
            }
        }
        self.ticks += 1;
    }

    /// The fields of the page's data.
    pub(super) fn fields(&self, json: &mut Json) {
        let seconds = self.tick * self.every as f64;
        json.decimal::<6>("every", (seconds * 1e6).round() as i64);
        let length = |nm: i64| number::text::<4>(nm / 100);
        json.array_at("z", |json| {
            for (_, _, z) in &self.samples {
                json.item(&length(*z));
            }
        });
        json.array_at("x", |json| {
            for (_, x, _) in &self.samples {
                json.item(&length(*x));
            }
        });
        json.array_at("l", |json| {
            for (line, ..) in &self.samples {
                json.item(&line.to_string());
            }
        });
    }
}
