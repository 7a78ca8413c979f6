//! Taps that geometry or the signals forbid.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{TapAxis, TapCall, TapForm, TapMode, TapRepeat, TapSpindle};
use crate::cycle::check::{blame, in_range};
use crate::signals::Signals;
use crate::units::Length;

/// The most infeeds of a hole.
const INFEEDS: i64 = 9999;

/// Refuses an impossible tap; otherwise gives the spindle that turns the tap.
#[inline(never)]
pub(crate) fn refuse_tap(
    call: &TapCall,
    signals: Signals,
    span: Span,
) -> Result<TapSpindle, Alarm> {
    in_range(span, |see| call.lengths(see))?;
    let spindle = signals.spindle(call.spindle, span)?;
    let axis = call.axis;
    let level = call.level.value;
    let way = call.bottom.value - level;
    let inward = way.signum();
    let approach = (level - axis.of(call.hole)).signum();
    if inward == 0 || (approach != 0 && approach != inward) {
        let letter = match axis {
            TapAxis::X => b'X',
            TapAxis::Z => b'Z',
        };
        return Err(blame(Code::TapDepth, span, &call.bottom.span, letter));
    }
    let total = way.abs();
    let from = (axis.of(call.start) - level).times(inward);
    let no_depth = call.continues && (from <= Length::ZERO || from >= total);
    // Only in speed mode can the spindle be standing. Only in position mode can a tap stay in its hole.
    let slowest = match call.mode {
        TapMode::Rigid => 1,
        TapMode::Floating => 0,
    };
    let locked = call.continues || call.repeat == TapRepeat::Stay;
    let no_phase = locked && call.mode == TapMode::Floating;
    if no_depth || no_phase || call.speed.get() < slowest || call.extract.get() < slowest {
        return Err(Alarm::new(Code::TapCallRange, span));
    }
    if let TapForm::HighSpeed(peck) | TapForm::Deep(peck) = &call.form {
        if peck.back.value > peck.infeed.value {
            // Of two words the newer one does not fit.
            let (back, infeed) = (&peck.back.span, &peck.infeed.span);
            let (word, letter) = match infeed.line > back.line {
                true => (infeed, b'Q'),
                false => (back, b'D'),
            };
            return Err(blame(Code::TapDepth, span, word, letter));
        }
        if peck.infeed.value.times(INFEEDS) < total {
            let word = &peck.infeed.span;
            return Err(blame(Code::TooManyPecks, span, word, b'Q').with([Arg::Int(INFEEDS)]));
        }
    }
    Ok(spindle)
}
