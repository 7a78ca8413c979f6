//! Grooves that geometry forbids, and those that are longer than anybody waits for.

use super::count::GrooveCount;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::GrooveCall;
use crate::cycle::check::{blame, in_range};
use crate::units::Length;

/// The most infeeds of a groove, counted over all its columns.
const GROOVE_INFEEDS: u64 = 99_999;

/// The most infeeds that a retract of a groove takes back.
const RETRACT_INFEEDS: i64 = 10;

/// Refuses an impossible groove.
#[inline(never)]
pub(crate) fn refuse_groove(call: &GrooveCall, span: Span) -> Result<(), Alarm> {
    in_range(span, |see| call.lengths(see))?;
    let [bottom, peck_letter, step_letter] = GrooveCall::letters(call.axis);
    if call.bottom().value == call.level() {
        let word = &call.bottom().span;
        return Err(blame(Code::GrooveWithoutDepth, span, word, bottom));
    }
    step(&call.peck, peck_letter, span)?;
    if call.last().value != call.first() {
        step(&call.step, step_letter, span)?;
    }
    let count = GrooveCount::of(call);
    let (infeeds, columns) = (count.infeeds, count.columns);
    if infeeds.saturating_mul(columns) > GROOVE_INFEEDS {
        let (word, letter) = if infeeds >= columns {
            (&call.peck, peck_letter)
        } else {
            (&call.step, step_letter)
        };
        let word = word.map_or_else(Span::default, |word| word.span);
        let figures = [infeeds, columns, GROOVE_INFEEDS].map(|count| Arg::Int(count as i64));
        return Err(blame(Code::TooManyGrooveInfeeds, span, &word, letter).with(figures));
    }
    let (Some(peck), retract) = (&call.peck, call.retract.value) else {
        return Ok(());
    };
    if infeeds > 1 && retract > peck.value.times(RETRACT_INFEEDS) {
        let figures = [
            Arg::Length(peck.value),
            Arg::Length(retract),
            Arg::Int(RETRACT_INFEEDS),
        ];
        return Err(blame(Code::GrooveRetractTooLong, span, &peck.span, peck_letter).with(figures));
    }
    Ok(())
}

/// Refuses a missing peck or step.
fn step(written: &Option<At<Length>>, letter: u8, span: Span) -> Result<(), Alarm> {
    match written {
        Some(step) if step.value > Length::ZERO => Ok(()),
        Some(step) => Err(Alarm::new(Code::GrooveStepMissing, step.span).word(letter)),
        None => Err(Alarm::new(Code::GrooveStepMissing, span)),
    }
}
