//! The moves of one hole.

use leadscrew_core::units::Length;

/// A hole along one axis, in machine coordinates; X is a radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hole {
    /// Where the tool comes from, and goes back to.
    pub initial: Length,
    /// R: where the feed begins.
    pub level: Length,
    /// The bottom; never R.
    pub bottom: Length,
    /// Depth of a peck, above zero; `None`: all at once.
    pub peck: Option<Length>,
    /// Back to R after a peck, and not by the clearance alone.
    pub deep: bool,
    /// Way back after a peck, or where the feed of the next one begins above it.
    pub clearance: Length,
    /// Milliseconds at the bottom.
    pub dwell: u32,
    /// Out of the hole at feed, up to R.
    pub feeds_out: bool,
    /// Where the tool ends: at R and not at the initial level.
    pub ends_at_r: bool,
}

/// A step of a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Rapid to this place.
    Rapid(Length),
    /// At feed to this place.
    Feed(Length),
    /// Milliseconds.
    Dwell(u32),
}

impl Hole {
    /// How many pecks there are.
    #[must_use]
    pub fn pecks(&self) -> u64 {
        let depth = (self.bottom - self.level).abs().nm().unsigned_abs();
        match self.peck {
            Some(peck) => depth.div_ceil(peck.nm().unsigned_abs().max(1)),
            None => 1,
        }
    }

    /// Hands the steps in their order to `each`; a step to where the tool stands is left out.
    ///
    /// # Errors
    /// The first error of `each`.
    pub fn steps<E>(&self, mut each: impl FnMut(Step) -> Result<(), E>) -> Result<(), E> {
        let mut at = self.initial;
        let mut go = |step: Step| {
            let to = match step {
                Step::Rapid(to) | Step::Feed(to) => to,
                Step::Dwell(_) => return each(step),
            };
            if to == at {
                return Ok(());
            }
            at = to;
            each(step)
        };
        let inwards = (self.bottom - self.level).signum();
        let depth = (self.bottom - self.level).abs();
        let below = |depth: Length| self.level + depth.times(inwards);
        go(Step::Rapid(self.level))?;
        let mut reached = Length::ZERO;
        while let Some(peck) = self.peck
            && reached + peck < depth
        {
            reached += peck;
            go(Step::Feed(below(reached)))?;
            let above = (reached - self.clearance).max(Length::ZERO);
            if self.deep {
                go(Step::Rapid(self.level))?;
            }
            go(Step::Rapid(below(above)))?;
        }
        go(Step::Feed(self.bottom))?;
        if self.dwell > 0 {
            go(Step::Dwell(self.dwell))?;
        }
        if self.feeds_out {
            go(Step::Feed(self.level))?;
        }
        go(Step::Rapid(if self.ends_at_r {
            self.level
        } else {
            self.initial
        }))
    }
}
