//! Somebody at the override switch, and a spindle that a feed follows.

use crate::random::Random;
use leadscrew_core::motion::{Pace, Rate};

/// What an operator does during one move.
pub struct Operator {
    kind: i64,
    every: i64,
    /// Tick from which they leave it alone.
    patience: u64,
    give_up: Option<u64>,
    rate: Rate,
    most: i64,
}

impl Operator {
    pub fn random(random: &mut Random, pace: Pace) -> Self {
        let kind = random.below(6);
        Self {
            kind,
            every: random.decades(1.0, 200.0),
            patience: random.decades(10.0, 600.0) as u64,
            give_up: random.one_in(12).then(|| random.decades(1.0, 300.0) as u64),
            rate: Rate::FULL,
            most: if pace == Pace::Rapid { 100 } else { 150 },
        }
    }

    /// The rate of the next tick.
    pub fn rate(&mut self, random: &mut Random, tick: u64) -> Rate {
        if tick >= self.patience {
            return Rate::FULL;
        }
        if self.kind > 0 && random.one_in(self.every) {
            let percent = |percent: i64| Rate::percent(percent as u8);
            self.rate = match self.kind {
                // Feed hold and cycle start.
                1 | 2 => [Rate::HOLD, Rate::FULL][random.below(2) as usize],
                // The override switch.
                3 => percent(random.below(self.most / 10 + 1) * 10),
                // A spindle that is not quite even.
                4 => Rate::from_raw((62_000 + random.below(3_536)) as u32),
                // Everything.
                _ => Rate::from_raw(random.below(self.most * 656) as u32),
            };
        }
        self.rate
    }

    /// True in the tick in which they press reset.
    pub fn gives_up(&self, tick: u64) -> bool {
        self.give_up == Some(tick)
    }
}
