//! Alarms about the words of a cycle. The arithmetic of the cycles relies on [`in_range`].

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::Sign;
use crate::units::Length;

/// An alarm at a word, or at the block where the value came from a parameter.
pub(super) fn blame(code: Code, block: Span, word: &Span, letter: u8) -> Alarm {
    if *word == Span::default() {
        Alarm::new(code, block)
    } else {
        Alarm::new(code, *word).word(letter)
    }
}

/// Refuses the first of a call's lengths that its documentation excludes: negative, zero or out of range. `lengths` hands
/// all of them over.
///
/// # Errors
/// [`Code::CycleLengthRange`].
pub(super) fn in_range(
    block: Span,
    lengths: impl FnOnce(&mut dyn FnMut(&At<Length>, u8, Sign)),
) -> Result<(), Alarm> {
    let mut first = Ok(());
    lengths(&mut |at, letter, sign| {
        if !sign.allows(at.value) && first.is_ok() {
            first = Err(refused(at, letter, block));
        }
    });
    first
}

#[cold]
fn refused(at: &At<Length>, letter: u8, block: Span) -> Alarm {
    blame(Code::CycleLengthRange, block, &at.span, letter).with([Arg::Length(at.value)])
}
