//! What the types of a call allow but its documentation excludes: lengths that are negative, zero or out of range. The
//! arithmetic of the cycles relies on it. Knows nothing of geometry.

use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::program::{GrooveCall, ThreadCall};
use crate::units::Length;

/// An alarm at a word, or at the block where the value came from a parameter.
pub(crate) fn blame(code: Code, block: Span, word: Span, letter: u8) -> Alarm {
    if word == Span::default() {
        Alarm::new(code, block)
    } else {
        Alarm::new(code, word).word(letter)
    }
}

/// Refuses lengths of a thread call that cannot be.
pub(crate) fn thread_ranges(call: &ThreadCall, span: Span) -> Result<(), Alarm> {
    let run_out = call.run_out.map(|r| [(r.short, b'J'), (r.long, b'K')]);
    let positive = [
        (call.height, b'P'),
        (call.first_depth, b'Q'),
        (At::new(call.increment, Span::default()), b'Q'),
    ];
    let not_negative = [
        (call.min_step, b'Q'),
        (call.allowance, b'R'),
        (call.run_in, b'E'),
    ];
    let any = [(call.end_x, b'X'), (call.end_z, b'Z'), (call.taper, b'R')];
    let out_of_range = |(value, letter): (At<Length>, u8)| {
        blame(Code::CycleLengthRange, span, value.span, letter).with([
            Arg::Length(value.value),
            Arg::None,
            Arg::None,
            Arg::None,
        ])
    };
    for entry in positive.into_iter().chain(run_out.into_iter().flatten()) {
        if !entry.0.value.is_in_range() || entry.0.value <= Length::ZERO {
            return Err(out_of_range(entry));
        }
    }
    for entry in not_negative {
        if !entry.0.value.is_in_range() || entry.0.value < Length::ZERO {
            return Err(out_of_range(entry));
        }
    }
    for entry in any {
        if !entry.0.value.is_in_range() {
            return Err(out_of_range(entry));
        }
    }
    for value in [call.start.x, call.start.z] {
        if !value.is_in_range() {
            return Err(Alarm::new(Code::CycleLengthRange, span).with([
                Arg::Length(value),
                Arg::None,
                Arg::None,
                Arg::None,
            ]));
        }
    }
    Ok(())
}

/// Refuses lengths of a groove call that cannot be.
pub(crate) fn groove_ranges(call: &GrooveCall, span: Span) -> Result<(), Alarm> {
    let refuse = |value: Length, word: Span, letter: u8| {
        Err(blame(Code::CycleLengthRange, span, word, letter).with([
            Arg::Length(value),
            Arg::None,
            Arg::None,
            Arg::None,
        ]))
    };
    for (at, letter) in [(call.end_x, b'X'), (call.end_z, b'Z')] {
        if !at.value.is_in_range() {
            return refuse(at.value, at.span, letter);
        }
    }
    let lengths = [
        (Some(call.relief), b'R'),
        (Some(call.retract), b'R'),
        (call.peck, b'P'),
        (call.step, b'Q'),
    ];
    for (at, letter) in lengths {
        if let Some(at) = at
            && (!at.value.is_in_range() || at.value < Length::ZERO)
        {
            return refuse(at.value, at.span, letter);
        }
    }
    for value in [call.start.x, call.start.z] {
        if !value.is_in_range() {
            return refuse(value, Span::default(), b'X');
        }
    }
    Ok(())
}
