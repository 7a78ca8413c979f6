//! Bounds of a decoded call: a call from a wire is let in only where the interpreter could have yielded it.
//!
//! What follows from geometry and physics is not asked here: the board does that with every call.

use crate::program::{
    ArcCall, Call, CallKind, FeedRate, GrooveCall, Position, TapCall, TapForm, TapMode, TapPeck,
    TapReturn, ThreadCall,
};
use crate::units::{Angle, CentiRpm, Feed, FeedPerTurn, Lead, Length, Millis, Remainder, Rpm};

/// What of a call is beyond its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// A coordinate, or a length along an axis.
    Position,
    /// A length that has to be positive, or not negative, or less.
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
/// The longest dwell of a word, in milliseconds.
const DWELL: u32 = 99_999_999;
/// The longest lead times its denominator, in nanometres.
const LEAD: i64 = 1 << 50;
/// The finest I word: turns are millionths.
const THREAD_TURNS: i64 = 1 << 28;
/// A tap's lead is feed over speed.
const TAP_TURNS: i64 = 1 << 20;
/// Starts, passes and whole degrees have two digits.
const TWO_DIGITS: u8 = 99;

/// Checks a call.
///
/// # Errors
/// The first thing that no program can say.
pub fn call(call: &Call) -> Result<(), Beyond> {
    position(call.origin)?;
    match &call.kind {
        CallKind::Rapid(end) => position(*end),
        CallKind::Line(end, rate) => position(*end).and(feed(*rate)),
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
    position(call.end)?;
    within(call.i)?;
    within(call.k)?;
    feed(call.feed)
}

fn thread(call: &ThreadCall) -> Result<(), Beyond> {
    position(call.start)?;
    within(call.end_x.value)?;
    within(call.end_z.value)?;
    within(call.taper.value)?;
    positive(call.height.value)?;
    positive(call.first_depth.value)?;
    not_negative(call.min_step.value)?;
    not_negative(call.allowance.value)?;
    not_negative(call.run_in.value)?;
    if let Some(out) = &call.run_out {
        not_negative(out.short.value)?;
        not_negative(out.long.value)?;
        rest(out.short_rest)?;
        rest(out.long_rest)?;
    }
    lead(call.lead.value, THREAD_TURNS)?;
    positive(call.increment)?;
    speed(call.rpm)?;
    let counts = call.finish_passes.value <= TWO_DIGITS
        && call.angle.value <= TWO_DIGITS
        && (1..=TWO_DIGITS).contains(&call.starts.value);
    require(counts, Beyond::Count)
}

fn groove(call: &GrooveCall) -> Result<(), Beyond> {
    position(call.start)?;
    within(call.end_x.value)?;
    within(call.end_z.value)?;
    for length in [call.peck, call.step].into_iter().flatten() {
        positive(length.value)?;
    }
    not_negative(call.relief.value)?;
    not_negative(call.retract.value)?;
    feed(call.feed)
}

fn tap(call: &TapCall) -> Result<(), Beyond> {
    position(call.start)?;
    position(call.hole)?;
    position(call.step)?;
    within(call.level.value)?;
    within(call.bottom.value)?;
    match call.form {
        TapForm::Standard => {}
        TapForm::HighSpeed(peck) | TapForm::Deep(peck) => pecks(peck)?,
    }
    dwell(call.dwell)?;
    lead(call.lead.value, TAP_TURNS)?;
    match call.mode {
        TapMode::Rigid => turning(call.speed).and(turning(call.extract)),
        TapMode::Floating => turning_or_not(call.speed).and(turning_or_not(call.extract)),
    }
}

fn tap_return(call: &TapReturn) -> Result<(), Beyond> {
    turning(call.highest)?;
    not_negative(call.beyond)?;
    call.speed.map_or(Ok(()), turning)
}

fn pecks(peck: TapPeck) -> Result<(), Beyond> {
    positive(peck.infeed.value)?;
    not_negative(peck.back.value)?;
    require(peck.back.value <= peck.infeed.value, Beyond::Length)
}

fn position(position: Position) -> Result<(), Beyond> {
    within(position.x)?;
    within(position.z)?;
    rotary(position.c)
}

fn within(length: Length) -> Result<(), Beyond> {
    require(length.is_in_range(), Beyond::Position)
}

fn rotary(angle: Angle) -> Result<(), Beyond> {
    within(Length::from_nm(angle.udeg()))
}

fn positive(length: Length) -> Result<(), Beyond> {
    require(length > Length::ZERO, Beyond::Length).and(not_negative(length))
}

fn not_negative(length: Length) -> Result<(), Beyond> {
    require(
        length >= Length::ZERO && length.is_in_range(),
        Beyond::Length,
    )
}

fn rest(rest: Remainder) -> Result<(), Beyond> {
    let half = 1 << (Remainder::BITS.saturating_sub(1));
    let raw = rest.behind(Length::ZERO);
    require(raw.saturating_abs() <= half, Beyond::Length)
}

fn feed(rate: FeedRate) -> Result<(), Beyond> {
    let allowed = |nm: i64| nm > 0 && nm <= FEED;
    match rate {
        FeedRate::PerMinute(feed) => require(allowed(Feed::nm_per_min(feed)), Beyond::Feed),
        FeedRate::PerTurn(feed, rpm) => {
            require(allowed(FeedPerTurn::nm(feed)), Beyond::Feed)?;
            speed(rpm)
        }
    }
}

fn lead(lead: Lead, turns: i64) -> Result<(), Beyond> {
    // Both are positive: there is no other lead.
    require(
        lead.numerator() <= LEAD && lead.denominator() <= turns,
        Beyond::Lead,
    )
}

fn speed(rpm: Rpm) -> Result<(), Beyond> {
    require(rpm.abs() <= SPEED, Beyond::Speed)
}

fn turning(speed: CentiRpm) -> Result<(), Beyond> {
    require(speed.get() != 0, Beyond::Speed).and(turning_or_not(speed))
}

fn turning_or_not(speed: CentiRpm) -> Result<(), Beyond> {
    let most = i64::from(SPEED).saturating_mul(100);
    require((0..=most).contains(&i64::from(speed.get())), Beyond::Speed)
}

fn dwell(time: Millis) -> Result<(), Beyond> {
    require(time.get() <= DWELL, Beyond::Dwell)
}

const fn require(condition: bool, beyond: Beyond) -> Result<(), Beyond> {
    if condition { Ok(()) } else { Err(beyond) }
}
