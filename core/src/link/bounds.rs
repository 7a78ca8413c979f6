//! Bounds of a decoded call: a received call is accepted only where the interpreter could have made it.
//!
//! This module does not check geometry and physics: the board checks them for every call.

use crate::alarm::At;
use crate::call::{
    ArcCall, Call, CallKind, ChainPart, FeedRate, GrooveCall, Position, Sign, SpindleCall, TapCall,
    TapForm, TapMode, TapReturn, ThreadCall, ThreadCycle,
};
use crate::units::{CentiRpm, Feed, FeedPerTurn, Lead, LeadChange, Length, Millis, Remainder, Rpm};

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
    /// A part of a chain that is no stroke of G32, or that has a run-out and goes on.
    Chain,
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
        CallKind::Spindle(call) => spindle(call),
        CallKind::Aux(_)
        | CallKind::End(_)
        | CallKind::Over
        | CallKind::ExactStop(_)
        | CallKind::LineOver => Ok(()),
        CallKind::Thread(call) => thread(call),
        CallKind::Groove(call) => groove(call),
        CallKind::Tap(call) => tap(call),
        CallKind::TapReturn(call) => tap_return(call),
    }
}

fn spindle(call: &SpindleCall) -> Result<(), Beyond> {
    speed(call.rpm)?;
    call.law().map_or(Ok(()), |law| {
        length(Sign::Any, law.centre)?;
        require((0..=FEED).contains(&law.speed.nm_per_min()), Beyond::Feed)?;
        require(law.least.max(law.most) <= SPEED, Beyond::Speed)
    })
}

fn arc(call: &ArcCall) -> Result<(), Beyond> {
    position(&call.end)?;
    length(Sign::Any, call.i)?;
    length(Sign::Any, call.k)?;
    feed(&call.feed)
}

fn thread(call: &ThreadCall) -> Result<(), Beyond> {
    words(|see| call.lengths(see))?;
    if let Some(out) = &call.run_out {
        rest(out.short_rest)?;
        rest(out.long_rest)?;
    }
    lead(&call.lead.value, THREAD_TURNS)?;
    change(call)?;
    chain(call)?;
    speed(call.rpm)?;
    let counts = call.finish_passes.value <= TWO_DIGITS
        && call.angle.value <= TWO_DIGITS
        && (1..=TWO_DIGITS).contains(&call.starts.value);
    require(counts, Beyond::Count)
}

fn groove(call: &GrooveCall) -> Result<(), Beyond> {
    words(|see| call.lengths(see))?;
    feed(&call.feed)
}

fn tap(call: &TapCall) -> Result<(), Beyond> {
    words(|see| call.lengths(see))?;
    if let TapForm::HighSpeed(peck) | TapForm::Deep(peck) = &call.form {
        require(peck.back.value <= peck.infeed.value, Beyond::Length)?;
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
    length(Sign::NotNegative, call.beyond)?;
    call.speed.map_or(Ok(()), |speed| turning(1, speed))
}

fn position(position: &Position) -> Result<(), Beyond> {
    let turned = Length::from_nm(position.c.udeg());
    length(Sign::Any, position.x)?;
    length(Sign::Any, position.z)?;
    length(Sign::Any, turned)
}

/// The lengths of a cycle.
fn words(each: impl FnOnce(&mut dyn FnMut(&At<Length>, u8, Sign))) -> Result<(), Beyond> {
    let mut first = Ok(());
    each(&mut |at, _, sign| {
        if first.is_ok() {
            first = length(sign, at.value);
        }
    });
    first
}

fn length(sign: Sign, length: Length) -> Result<(), Beyond> {
    let beyond = match sign {
        Sign::Any => Beyond::Position,
        Sign::NotNegative | Sign::Positive => Beyond::Length,
    };
    require(sign.allows(length), beyond)
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

/// A lead changes in G34 alone, and there is no run-out there.
fn change(call: &ThreadCall) -> Result<(), Beyond> {
    let change = call.change.value;
    if call.cycle == ThreadCycle::G34 {
        let most = LeadChange::LIMIT.pm().unsigned_abs();
        require(change.pm().unsigned_abs() <= most, Beyond::Lead)?;
        require(call.run_out.is_none(), Beyond::Length)
    } else {
        require(change == LeadChange::NONE, Beyond::Lead)
    }
}

/// Strokes of G32 alone make a chain, and its run-out is at its end.
fn chain(call: &ThreadCall) -> Result<(), Beyond> {
    let can_join = call.part == ChainPart::Whole || call.cycle == ThreadCycle::G32;
    let runs_out_early = call.part.goes_on() && call.run_out.is_some();
    require(can_join && !runs_out_early, Beyond::Chain)
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
