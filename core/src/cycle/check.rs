//! Refuses lengths that the types of a call allow and its documentation excludes: negative, zero or out of range. The
//! arithmetic of the cycles relies on these checks. Knows nothing of geometry.

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::program::{GrooveCall, Position, TapCall, TapForm, ThreadCall};
use crate::units::Length;

/// An alarm at a word, or at the block where the value came from a parameter.
pub(crate) fn blame(code: Code, block: Span, word: &Span, letter: u8) -> Alarm {
    if *word == Span::default() {
        Alarm::new(code, block)
    } else {
        Alarm::new(code, *word).word(letter)
    }
}

/// Which lengths a word may have.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Any,
    NotNegative,
    Positive,
}

/// Refuses a thread call with an impossible length.
pub(crate) fn thread_ranges(call: &ThreadCall, block: Span) -> Result<(), Alarm> {
    let mut words = Words::new(block);
    words.place(&call.start);
    words.length(&call.end_x, b'X', Sign::Any);
    words.length(&call.end_z, b'Z', Sign::Any);
    words.length(&call.taper, b'R', Sign::Any);
    words.length(&call.height, b'P', Sign::Positive);
    words.length(&call.first_depth, b'Q', Sign::Positive);
    words.unwritten(call.increment, b'Q', Sign::Positive);
    words.length(&call.min_step, b'Q', Sign::NotNegative);
    words.length(&call.allowance, b'R', Sign::NotNegative);
    words.length(&call.run_in, b'E', Sign::NotNegative);
    if let Some(run_out) = &call.run_out {
        words.length(&run_out.short, b'J', Sign::Positive);
        words.length(&run_out.long, b'K', Sign::Positive);
    }
    words.first
}

/// Refuses a groove call with an impossible length. The groove itself checks P and Q of zero: they have an alarm number
/// of their own.
pub(crate) fn groove_ranges(call: &GrooveCall, block: Span) -> Result<(), Alarm> {
    let mut words = Words::new(block);
    words.place(&call.start);
    words.length(&call.end_x, b'X', Sign::Any);
    words.length(&call.end_z, b'Z', Sign::Any);
    words.length(&call.relief, b'R', Sign::NotNegative);
    words.length(&call.retract, b'R', Sign::NotNegative);
    for (step, letter) in [(&call.peck, b'P'), (&call.step, b'Q')] {
        if let Some(step) = step {
            words.length(step, letter, Sign::NotNegative);
        }
    }
    words.first
}

/// Refuses a tap call with an impossible length.
pub(crate) fn tap_ranges(call: &TapCall, block: Span) -> Result<(), Alarm> {
    let mut words = Words::new(block);
    words.place(&call.start);
    words.place(&call.hole);
    words.place(&call.step);
    words.length(&call.level, b'R', Sign::Any);
    words.length(&call.bottom, b'Z', Sign::Any);
    if let TapForm::HighSpeed(peck) | TapForm::Deep(peck) = &call.form {
        words.length(&peck.infeed, b'Q', Sign::Positive);
        words.length(&peck.back, b'D', Sign::NotNegative);
    }
    words.first
}

/// Checks the words of a block in turn and keeps the first impossible one.
struct Words {
    block: Span,
    first: Result<(), Alarm>,
}

impl Words {
    const fn new(block: Span) -> Self {
        Self {
            block,
            first: Ok(()),
        }
    }

    /// A place that stands in no word.
    fn place(&mut self, at: &Position) {
        self.unwritten(at.x, b'X', Sign::Any);
        self.unwritten(at.z, b'Z', Sign::Any);
    }

    /// A length that stands in no word.
    fn unwritten(&mut self, value: Length, letter: u8, sign: Sign) {
        self.length(&At::new(value, Span::default()), letter, sign);
    }

    fn length(&mut self, at: &At<Length>, letter: u8, sign: Sign) {
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
