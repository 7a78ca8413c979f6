//! Bounds of a decoded call: a received call is accepted only where the interpreter could have made it.
//!
//! This module does not check geometry and physics: the board checks them for every call.

use crate::call::{
    ArcCall, Call, CallKind, FeedRate, GrooveCall, Position, TapCall, TapForm, TapMode, TapPeck,
    TapReturn, ThreadCall,
};
use crate::units::{CentiRpm, Feed, FeedPerTurn, Lead, Length, Millis, Remainder, Rpm};

/// The kind of value that is out of bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// A coordinate, or a length along an axis.
    Position,
    /// A length that must be positive, not negative, or smaller.
    Length,
    /// A speed along the path.
    Feed,
    /// A lead.
    Lead,
    /// A spindle speed.
    Speed,
    /// A dwell.
    Dwell,
    /// A number of passes, starts or degrees.
    Count,
}

/// The fastest path speed and the longest feed per turn, in nanometres (a minute, a turn).
const FEED: i64 = 1 << 42;
/// The fastest spindle, in turns per minute.
const SPEED: u32 = 1 << 20;
/// The fastest spindle, in hundredths of a turn per minute.
const SPEED_CENTI: i32 = 100 << 20;
/// The longest dwell of a program word, in milliseconds.
const DWELL: u32 = 99_999_999;
/// The longest lead times its denominator, in nanometres.
const LEAD: i64 = 1 << 50;
/// Largest denominator of a thread's lead, from the finest I word: turns are millionths.
const THREAD_TURNS: i64 = 1 << 28;
/// Largest denominator of a tap's lead, which is feed divided by speed.
const TAP_TURNS: i64 = 1 << 20;
/// Starts, passes and whole degrees have two digits.
const TWO_DIGITS: u8 = 99;

/// The lower limit of a length.
#[derive(Clone, Copy)]
enum From {
    /// The negative limit of the range.
    Anywhere,
    Zero,
    /// Above zero.
    Above,
}

/// Checks a call.
///
/// # Errors
/// The kind of the first value that no program can have.
pub fn call(call: &Call) -> Result<(), Beyond> {
    position(&call.origin)?;
    match &call.kind {
        CallKind::Rapid(end) => position(end),
        CallKind::Line(end, rate) => position(end).and(feed(rate)),
        CallKind::Arc(call) => arc(call),
        CallKind::Dwell(time) => dwell(*time),
        CallKind::Spindle(spindle) => speed(spindle.rpm),
        CallKind::Aux(_) | CallKind::End(_) | CallKind::Over => Ok(()),
        CallKind::Thread(call) => thread(call),
        CallKind::Groove(call) => groove(call),
        CallKind::Tap(call) => tap(call),
        CallKind::TapReturn(call) => tap_return(call),
    }
}

fn arc(call: &ArcCall) -> Result<(), Beyond> {
    position(&call.end)?;
    lengths(From::Anywhere, &[&call.i, &call.k])?;
    feed(&call.feed)
}

fn thread(call: &ThreadCall) -> Result<(), Beyond> {
    position(&call.start)?;
    let ends = [&call.end_x.value, &call.end_z.value, &call.taper.value];
    lengths(From::Anywhere, &ends)?;
    lengths(From::Above, &[&call.height.value, &call.first_depth.value])?;
    let zero = [
        &call.min_step.value,
        &call.allowance.value,
        &call.run_in.value,
    ];
    lengths(From::Zero, &zero)?;
    if let Some(out) = &call.run_out {
        lengths(From::Zero, &[&out.short.value, &out.long.value])?;
        rest(out.short_rest)?;
        rest(out.long_rest)?;
    }
    lead(&call.lead.value, THREAD_TURNS)?;
    lengths(From::Above, &[&call.increment])?;
    speed(call.rpm)?;
    let counts = call.finish_passes.value <= TWO_DIGITS
        && call.angle.value <= TWO_DIGITS
        && (1..=TWO_DIGITS).contains(&call.starts.value);
    require(counts, Beyond::Count)
}

fn groove(call: &GrooveCall) -> Result<(), Beyond> {
    position(&call.start)?;
    lengths(From::Anywhere, &[&call.end_x.value, &call.end_z.value])?;
    for length in [&call.peck, &call.step].into_iter().flatten() {
        lengths(From::Above, &[&length.value])?;
    }
    lengths(From::Zero, &[&call.relief.value, &call.retract.value])?;
    feed(&call.feed)
}

fn tap(call: &TapCall) -> Result<(), Beyond> {
    for place in [&call.start, &call.hole, &call.step] {
        position(place)?;
    }
    lengths(From::Anywhere, &[&call.level.value, &call.bottom.value])?;
    match &call.form {
        TapForm::Standard => {}
        TapForm::HighSpeed(peck) | TapForm::Deep(peck) => pecks(peck)?,
    }
    dwell(call.dwell)?;
    lead(&call.lead.value, TAP_TURNS)?;
    let least = match call.mode {
        TapMode::Rigid => 1,
        TapMode::Floating => 0,
    };
    turning(least, call.speed)?;
    turning(least, call.extract)
}

fn tap_return(call: &TapReturn) -> Result<(), Beyond> {
    turning(1, call.highest)?;
    lengths(From::Zero, &[&call.beyond])?;
    call.speed.map_or(Ok(()), |speed| turning(1, speed))
}

fn pecks(peck: &TapPeck) -> Result<(), Beyond> {
    let (infeed, back) = (&peck.infeed.value, &peck.back.value);
    lengths(From::Above, &[infeed])?;
    lengths(From::Zero, &[back])?;
    require(back <= infeed, Beyond::Length)
}

fn position(position: &Position) -> Result<(), Beyond> {
    let turned = Length::from_nm(position.c.udeg());
    lengths(From::Anywhere, &[&position.x, &position.z, &turned])
}

fn lengths(from: From, lengths: &[&Length]) -> Result<(), Beyond> {
    let (least, beyond) = match from {
        From::Anywhere => (Length::INPUT_LIMIT.nm().wrapping_neg(), Beyond::Position),
        From::Zero => (0, Beyond::Length),
        From::Above => (1, Beyond::Length),
    };
    let allowed = least..=Length::INPUT_LIMIT.nm();
    let all = lengths.iter().all(|length| allowed.contains(&length.nm()));
    require(all, beyond)
}

fn rest(rest: Remainder) -> Result<(), Beyond> {
    let half = 1 << (Remainder::BITS.saturating_sub(1));
    let raw = rest.behind(Length::ZERO);
    require(raw.saturating_abs() <= half, Beyond::Length)
}

fn feed(rate: &FeedRate) -> Result<(), Beyond> {
    let allowed = |nm: i64| nm > 0 && nm <= FEED;
    match rate {
        FeedRate::PerMinute(feed) => require(allowed(Feed::nm_per_min(*feed)), Beyond::Feed),
        FeedRate::PerTurn(feed, rpm) => {
            require(allowed(FeedPerTurn::nm(*feed)), Beyond::Feed)?;
            speed(*rpm)
        }
    }
}

fn lead(lead: &Lead, turns: i64) -> Result<(), Beyond> {
    // No lower limits needed: every [`Lead`] has a positive numerator and denominator.
    require(
        lead.numerator() <= LEAD && lead.denominator() <= turns,
        Beyond::Lead,
    )
}

fn speed(rpm: Rpm) -> Result<(), Beyond> {
    require(rpm.abs() <= SPEED, Beyond::Speed)
}

fn turning(least: i32, speed: CentiRpm) -> Result<(), Beyond> {
    require((least..=SPEED_CENTI).contains(&speed.get()), Beyond::Speed)
}

fn dwell(time: Millis) -> Result<(), Beyond> {
    require(time.get() <= DWELL, Beyond::Dwell)
}

const fn require(condition: bool, beyond: Beyond) -> Result<(), Beyond> {
    if condition { Ok(()) } else { Err(beyond) }
}
