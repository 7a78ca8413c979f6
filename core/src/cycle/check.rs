//! What the types of a call allow but its documentation excludes: lengths that are negative, zero or out of range. The
//! arithmetic of the cycles relies on it. Knows nothing of geometry.

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::program::{GrooveCall, TapCall, TapForm, ThreadCall};
use crate::units::Length;

/// An alarm at a word, or at the block where the value came from a parameter.
pub(crate) fn blame(code: Code, block: Span, word: Span, letter: u8) -> Alarm {
    if word == Span::default() {
        Alarm::new(code, block)
    } else {
        Alarm::new(code, word).word(letter)
    }
}

/// Which lengths a word may have.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Any,
    NotNegative,
    Positive,
}

/// Refuses lengths of a thread call that cannot be.
pub(crate) fn thread_ranges(call: &ThreadCall, block: Span) -> Result<(), Alarm> {
    let at = |value| At::new(value, Span::default());
    length(&at(call.start.x), b'X', Sign::Any, block)?;
    length(&at(call.start.z), b'Z', Sign::Any, block)?;
    length(&call.end_x, b'X', Sign::Any, block)?;
    length(&call.end_z, b'Z', Sign::Any, block)?;
    length(&call.taper, b'R', Sign::Any, block)?;
    length(&call.height, b'P', Sign::Positive, block)?;
    length(&call.first_depth, b'Q', Sign::Positive, block)?;
    length(&at(call.increment), b'Q', Sign::Positive, block)?;
    length(&call.min_step, b'Q', Sign::NotNegative, block)?;
    length(&call.allowance, b'R', Sign::NotNegative, block)?;
    length(&call.run_in, b'E', Sign::NotNegative, block)?;
    if let Some(run_out) = &call.run_out {
        length(&run_out.short, b'J', Sign::Positive, block)?;
        length(&run_out.long, b'K', Sign::Positive, block)?;
    }
    Ok(())
}

/// Refuses lengths of a groove call that cannot be. P and Q of zero are left to the groove: they have a number of their
/// own.
pub(crate) fn groove_ranges(call: &GrooveCall, block: Span) -> Result<(), Alarm> {
    let at = |value| At::new(value, Span::default());
    length(&at(call.start.x), b'X', Sign::Any, block)?;
    length(&at(call.start.z), b'Z', Sign::Any, block)?;
    length(&call.end_x, b'X', Sign::Any, block)?;
    length(&call.end_z, b'Z', Sign::Any, block)?;
    length(&call.relief, b'R', Sign::NotNegative, block)?;
    length(&call.retract, b'R', Sign::NotNegative, block)?;
    for (step, letter) in [(&call.peck, b'P'), (&call.step, b'Q')] {
        if let Some(step) = step {
            length(step, letter, Sign::NotNegative, block)?;
        }
    }
    Ok(())
}

/// Refuses lengths of a tap call that cannot be.
pub(crate) fn tap_ranges(call: &TapCall, block: Span) -> Result<(), Alarm> {
    let at = |value| At::new(value, Span::default());
    for place in [&call.start, &call.hole, &call.step] {
        length(&at(place.x), b'X', Sign::Any, block)?;
        length(&at(place.z), b'Z', Sign::Any, block)?;
    }
    length(&call.level, b'R', Sign::Any, block)?;
    length(&call.bottom, b'Z', Sign::Any, block)?;
    if let TapForm::HighSpeed(peck) | TapForm::Deep(peck) = &call.form {
        length(&peck.infeed, b'Q', Sign::Positive, block)?;
        length(&peck.back, b'D', Sign::NotNegative, block)?;
    }
    Ok(())
}

/// Refuses one length.
#[inline]
fn length(at: &At<Length>, letter: u8, sign: Sign, block: Span) -> Result<(), Alarm> {
    let lowest = match sign {
        Sign::Any => -Length::INPUT_LIMIT,
        Sign::NotNegative => Length::ZERO,
        Sign::Positive => Length::from_nm(1),
    };
    if at.value >= lowest && at.value <= Length::INPUT_LIMIT {
        Ok(())
    } else {
        Err(refused(at, letter, block))
    }
}

#[cold]
fn refused(at: &At<Length>, letter: u8, block: Span) -> Alarm {
    blame(Code::CycleLengthRange, block, at.span, letter).with([
        Arg::Length(at.value),
        Arg::None,
        Arg::None,
        Arg::None,
    ])
}
