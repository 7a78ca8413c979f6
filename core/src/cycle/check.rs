//! Refuses lengths that the types of a call allow and its documentation excludes: negative, zero or out of range. The
//! arithmetic of the cycles relies on these checks. Knows nothing of geometry.

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::Position;
use crate::units::Length;

/// An alarm at a word, or at the block where the value came from a parameter.
pub(super) fn blame(code: Code, block: Span, word: &Span, letter: u8) -> Alarm {
    if *word == Span::default() {
        Alarm::new(code, block)
    } else {
        Alarm::new(code, *word).word(letter)
    }
}

/// Which lengths a word may have.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    Any,
    NotNegative,
    Positive,
}

/// Checks the words of a block in turn and keeps the first impossible one.
pub(super) struct Words {
    block: Span,
    pub(super) first: Result<(), Alarm>,
}

impl Words {
    pub(super) const fn new(block: Span) -> Self {
        Self {
            block,
            first: Ok(()),
        }
    }

    /// A place that stands in no word.
    pub(super) fn place(&mut self, at: &Position) {
        self.unwritten(at.x, b'X', Sign::Any);
        self.unwritten(at.z, b'Z', Sign::Any);
    }

    /// A length that stands in no word.
    pub(super) fn unwritten(&mut self, value: Length, letter: u8, sign: Sign) {
        self.length(&At::new(value, Span::default()), letter, sign);
    }

    pub(super) fn length(&mut self, at: &At<Length>, letter: u8, sign: Sign) {
        let lowest = match sign {
            Sign::Any => -Length::INPUT_LIMIT,
            Sign::NotNegative => Length::ZERO,
            Sign::Positive => Length::from_nm(1),
        };
        let good = at.value >= lowest && at.value <= Length::INPUT_LIMIT;
        if !good && self.first.is_ok() {
            self.first = Err(refused(at, letter, self.block));
        }
    }
}

#[cold]
fn refused(at: &At<Length>, letter: u8, block: Span) -> Alarm {
    blame(Code::CycleLengthRange, block, &at.span, letter).with([Arg::Length(at.value)])
}
