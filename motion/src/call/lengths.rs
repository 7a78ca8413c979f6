//! Which lengths the words of a cycle may have: one list for each cycle. A call on the wire is refused by it, and so is a
//! call that is expanded.

use super::{GrooveCall, Position, TapCall, TapForm, ThreadCall, ThreadCycle};
use crate::alarm::{At, Span};
use crate::units::Length;

/// The range of a length. Its largest magnitude is [`Length::INPUT_LIMIT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// On either side of zero.
    Any,
    /// Zero or more.
    NotNegative,
    /// More than zero.
    Positive,
}

impl Sign {
    /// True where the range has `length`.
    #[must_use]
    pub fn allows(self, length: Length) -> bool {
        let lowest = match self {
            Self::Any => -Length::INPUT_LIMIT,
            Self::NotNegative => Length::ZERO,
            Self::Positive => Length::from_nm(1),
        };
        length >= lowest && length <= Length::INPUT_LIMIT
    }
}

/// Takes each length with the letter of its word and its range.
pub type See<'a> = &'a mut dyn FnMut(&At<Length>, u8, Sign);

impl ThreadCall {
    /// Hands all lengths to `see`.
    pub fn lengths(&self, see: See<'_>) {
        place(&self.start, see);
        see(&self.end_x, b'X', Sign::Any);
        see(&self.end_z, b'Z', Sign::Any);
        see(&self.taper, b'R', Sign::Any);
        let depth = match self.cycle {
            ThreadCycle::G76 | ThreadCycle::G78 => Sign::Positive,
            ThreadCycle::G92 | ThreadCycle::G32 | ThreadCycle::G34 => Sign::NotNegative,
        };
        see(&self.height, b'P', depth);
        see(&self.first_depth, b'Q', depth);
        see(&unwritten(self.increment), b'Q', Sign::Positive);
        see(&self.min_step, b'Q', Sign::NotNegative);
        see(&self.allowance, b'R', Sign::NotNegative);
        see(&self.run_in, b'E', Sign::NotNegative);
        if let Some(run_out) = &self.run_out {
            let short = if self.cycle.is_stroke() {
                Sign::Any
            } else {
                Sign::Positive
            };
            see(&run_out.short, b'J', short);
            see(&run_out.long, b'K', Sign::Positive);
        }
    }
}

impl GrooveCall {
    /// Hands all lengths to `see`. A P or Q of zero is in range: it has an alarm of its own.
    pub fn lengths(&self, see: See<'_>) {
        place(&self.start, see);
        see(&self.end_x, b'X', Sign::Any);
        see(&self.end_z, b'Z', Sign::Any);
        see(&self.relief, b'R', Sign::NotNegative);
        see(&self.retract, b'R', Sign::NotNegative);
        let [_, peck, step] = Self::letters(self.axis);
        for (step, letter) in [(&self.peck, peck), (&self.step, step)] {
            if let Some(step) = step {
                see(step, letter, Sign::NotNegative);
            }
        }
    }
}

impl TapCall {
    /// Hands all lengths to `see`.
    pub fn lengths(&self, see: See<'_>) {
        place(&self.start, see);
        place(&self.hole, see);
        place(&self.step, see);
        see(&self.level, b'R', Sign::Any);
        see(&self.bottom, b'Z', Sign::Any);
        if let TapForm::HighSpeed(peck) | TapForm::Deep(peck) = &self.form {
            see(&peck.infeed, b'Q', Sign::Positive);
            see(&peck.back, b'D', Sign::NotNegative);
        }
    }
}

/// A place that stands in no word.
fn place(at: &Position, see: See<'_>) {
    see(&unwritten(at.x), b'X', Sign::Any);
    see(&unwritten(at.z), b'Z', Sign::Any);
    see(&unwritten(Length::from_nm(at.c.udeg())), b'C', Sign::Any);
}

fn unwritten(length: Length) -> At<Length> {
    At::new(length, Span::default())
}
