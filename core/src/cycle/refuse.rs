//! Refuses calls that geometry forbids because their words contradict each other. Knows nothing of passes and moves.

use super::check::{blame, groove_ranges, tap_ranges, thread_ranges};
use super::groove_count::GrooveCount;
use super::shape::is_long_x;
use super::slope::HalfAngle;
use super::taper::scaled;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::program::{
    GrooveCall, TapAxis, TapCall, TapForm, TapMode, TapRepeat, TapSpindle, ThreadCall,
};
use crate::signals::Signals;
use crate::units::{Diameter, Length, signed_product};

/// The most infeeds of a hole.
const INFEEDS: i64 = 9999;

/// The most infeeds of a groove, counted over all its columns.
const GROOVE_INFEEDS: u64 = 99_999;

/// The most infeeds that a retract of a groove takes back.
const RETRACT_INFEEDS: i64 = 10;

/// Refuses a thread that is impossible whatever its passes are.
#[inline(never)]
pub(crate) fn refuse_thread(call: &ThreadCall, span: Span) -> Result<(), Alarm> {
    thread_ranges(call, span)?;
    let start = &call.start;
    let stroke = call.end_z.value - start.z;
    let travel = stroke.nm().unsigned_abs();
    if travel == 0 {
        let word = &call.end_z.span;
        return Err(blame(Code::ThreadWithoutLength, span, word, b'Z'));
    }
    let in_x = |code| blame(code, span, &call.end_x.span, b'X');
    let room = start.x - call.end_x.value;
    if room == Length::ZERO {
        return Err(in_x(Code::ThreadWithoutSide));
    }
    let height = call.height.value;
    let against_height = |code, at: &At<Length>, letter| {
        let figures = [Arg::Length(at.value), Arg::Length(height)];
        Err(blame(code, span, &at.span, letter).with(figures))
    };
    if call.allowance.value >= height {
        return against_height(Code::AllowanceTooLarge, &call.allowance, b'R');
    }
    if call.min_step.value > height {
        return against_height(Code::MinStepAboveHeight, &call.min_step, b'Q');
    }
    if HalfAngle::of(call.angle.value).is_none() {
        let figure = [Arg::Int(i64::from(call.angle.value))];
        return Err(blame(Code::ThreadAngleRange, span, &call.angle.span, b'P').with(figure));
    }
    let slant = call.taper.value;
    let long_x = is_long_x(call);
    if long_x && call.run_in.value != Length::ZERO {
        let word = &call.run_in.span;
        return Err(blame(Code::RunInWithLongX, span, word, b'E'));
    }
    // Both ends of the crest line must lie between the work and A.
    let side = room.signum();
    let (room, lean) = (room.times(side), slant.times(side));
    for crest in [height, height + lean] {
        if room < crest {
            let below = Diameter::of_radius(crest - room);
            return Err(in_x(Code::StartInsideThread).with([Arg::Diameter(below)]));
        }
    }
    if let Some(run_out) = &call.run_out
        && !long_x
    {
        // The line itself moves towards A by |i|·K/|W| when the thread grows from C to D: the tool must move faster.
        let (short, long) = (run_out.short.value, run_out.long.value);
        let line = signed_product(lean.nm(), long.nm());
        let tool = signed_product(travel as i64, short.nm());
        if line.wrapping_add(tool) <= 0 {
            let moves = scaled(slant.nm().unsigned_abs(), long.nm().unsigned_abs(), travel);
            let figures = [Arg::Length(short), Arg::Length(long), Arg::Length(moves)];
            let word = &run_out.short.span;
            return Err(blame(Code::RunOutIntoThread, span, word, b'J').with(figures));
        }
    }
    if call.starts.value == 0 {
        let word = &call.starts.span;
        return Err(blame(Code::CycleStartsRange, span, word, b'L'));
    }
    Ok(())
}

/// Refuses an impossible tap; otherwise gives the spindle that turns the tap.
#[inline(never)]
pub(crate) fn refuse_tap(
    call: &TapCall,
    signals: Signals,
    span: Span,
) -> Result<TapSpindle, Alarm> {
    tap_ranges(call, span)?;
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
            return Err(blame(Code::TapDepth, span, &peck.back.span, b'D'));
        }
        if peck.infeed.value.times(INFEEDS) < total {
            let word = &peck.infeed.span;
            return Err(blame(Code::TooManyPecks, span, word, b'Q').with([Arg::Int(INFEEDS)]));
        }
    }
    Ok(spindle)
}

/// Refuses an impossible groove.
#[inline(never)]
pub(crate) fn refuse_groove(call: &GrooveCall, span: Span) -> Result<(), Alarm> {
    groove_ranges(call, span)?;
    if call.end_x.value == call.start.x {
        let word = &call.end_x.span;
        return Err(blame(Code::GrooveWithoutDepth, span, word, b'X'));
    }
    step(&call.peck, b'P', span)?;
    if call.end_z.value != call.start.z {
        step(&call.step, b'Q', span)?;
    }
    let count = GrooveCount::of(call);
    let (infeeds, columns) = (count.infeeds, count.columns);
    if infeeds.saturating_mul(columns) > GROOVE_INFEEDS {
        let (word, letter) = if infeeds >= columns {
            (&call.peck, b'P')
        } else {
            (&call.step, b'Q')
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
        return Err(blame(Code::GrooveRetractTooLong, span, &peck.span, b'P').with(figures));
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
