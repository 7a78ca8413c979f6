//! Threads that geometry forbids, because a word is out of range or words contradict each other.

use super::shape::{is_long_x, long_way};
use super::slope::HalfAngle;
use super::taper::scaled;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{ThreadCall, ThreadCycle};
use crate::cycle::check::{blame, in_range};
use crate::units::{Diameter, Lead, LeadChange, Length, signed_product};

/// Refuses a thread that is impossible whatever its passes are.
#[inline(never)]
pub(crate) fn refuse_thread(call: &ThreadCall, span: Span) -> Result<(), Alarm> {
    in_range(span, |see| call.lengths(see))?;
    let start = &call.start;
    let stroke = call.end_z.value - start.z;
    if call.cycle.is_stroke() {
        return refuse_stroke(call, span).and_then(|()| refuse_lead(call, span));
    }
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
    // G92 has no height to divide.
    if call.cycle != ThreadCycle::G92 && call.allowance.value >= height {
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

/// Refuses a stroke without length, and a run-out that leaves nothing of it or leads into the thread.
#[inline(never)]
fn refuse_stroke(call: &ThreadCall, span: Span) -> Result<(), Alarm> {
    let x = call.end_x.value - call.start.x;
    let z = call.end_z.value - call.start.z;
    let (long, short) = if is_long_x(call) { (x, z) } else { (z, x) };
    if long == Length::ZERO {
        let word = &call.end_z.span;
        return Err(blame(Code::ThreadWithoutLength, span, word, b'Z'));
    }
    let Some(run_out) = &call.run_out else {
        return Ok(());
    };
    let (j, k) = (run_out.short.value, run_out.long.value);
    if k >= long.abs() {
        let word = &run_out.long.span;
        let figures = [
            Arg::Int(1),
            Arg::Length(long.abs()),
            Arg::Length(Length::ZERO),
            Arg::Length(k),
        ];
        return Err(blame(Code::StrokeTooShort, span, word, b'K').with(figures));
    }
    // Over K the line moves by short·K/|long|. The tool must move further, to the side of J.
    let line = signed_product(short.nm(), k.nm());
    let tool = signed_product(long.nm().saturating_abs(), j.nm());
    let leaves = if j < Length::ZERO {
        tool < line
    } else {
        tool > line
    };
    if leaves {
        return Ok(());
    }
    let size = |length: Length| length.nm().unsigned_abs();
    let moves = scaled(size(short), size(k), size(long));
    let figures = [Arg::Length(j.abs()), Arg::Length(k), Arg::Length(moves)];
    let word = &run_out.short.span;
    Err(blame(Code::RunOutIntoThread, span, word, b'J').with(figures))
}

/// Refuses a G34 whose lead leaves its range, or is used up before the end.
#[inline(never)]
fn refuse_lead(call: &ThreadCall, span: Span) -> Result<(), Alarm> {
    const LEAST: Length = Length::from_nm(100);
    const MOST: Length = Length::from_nm(500_000_000);
    if call.cycle != ThreadCycle::G34 {
        return Ok(());
    }
    let length = long_way(call).abs();
    if length > LeadChange::REACH {
        let figure = [Arg::Length(length), Arg::Length(LeadChange::REACH)];
        return Err(Alarm::new(Code::VariableStrokeTooLong, span).with(figure));
    }
    let (first, change) = (call.lead.value, call.change.value);
    let beyond = |lead: Lead| lead.rounded() < LEAST || lead.rounded() > MOST;
    let k = &call.change.span;
    let Some(last) = change.after(first, length) else {
        let figures = [
            Arg::Length(first.rounded()),
            Arg::Length(change.used_up_after(first)),
            Arg::Length(length),
        ];
        return Err(blame(Code::LeadUsedUp, span, k, b'K').with(figures));
    };
    if beyond(first) || beyond(last) {
        let figures = [Arg::Length(first.rounded()), Arg::Length(last.rounded())];
        let (word, letter) = if beyond(first) {
            (&call.lead.span, b'F')
        } else {
            (k, b'K')
        };
        return Err(blame(Code::LeadLeavesRange, span, word, letter).with(figures));
    }
    Ok(())
}
