//! G84 and G88 and the machine's limits: the feed of the tap axis, and whether the spindle reaches its speed within the
//! depth.

use super::join::{TapJoin, faster, join};
use super::moves::TapMoves;
use super::refuse::refuse_tap;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{
    Call, CallKind, SpindleCall, SpindleMode, TapAxis, TapCall, TapMode, TapSpindle,
};
use crate::feasible::can_tap;
use crate::motion::{FloatPlan, Limits, PathRate, stroke};
use crate::moves::{MoveKind, Stage, TapMove};
use crate::params::Params;
use crate::signals::Signals;
use crate::units::{Axis, CentiRpm, Feed, Lead, Rpm, mul_div, narrow_div, product, signed};

/// The behaviour of a tapping cycle on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TapReport {
    /// Number of infeeds of a hole.
    pub infeeds: u32,
    /// The highest speed of the spindle on the way in.
    pub fastest: CentiRpm,
    /// Ordinary tapping: how the axis gets onto the lead.
    pub join: Option<TapJoin>,
    /// The warning that no infeed reaches S.
    pub warning: Option<Alarm>,
}

impl TapReport {
    /// All warnings.
    pub fn warnings(&self) -> impl Iterator<Item = Alarm> {
        self.warning.into_iter().chain(self.join_warning().copied())
    }

    /// The first of these warnings.
    pub(crate) fn first_warning(&self) -> Option<&Alarm> {
        self.warning.as_ref().or(self.join_warning())
    }

    fn join_warning(&self) -> Option<&Alarm> {
        self.join.as_ref()?.warning.as_ref()
    }
}

/// Checks a tapping cycle with these signals. The cycle's G word stands at `span`.
///
/// # Errors
/// - The geometry forbids the cycle: see [`TapMoves::new`].
/// - This machine cannot tap with the spindle ([`Code::TapSpindleNotAvailable`]), or cannot follow it
///   ([`Code::FloatSpindleWithoutEncoder`]).
/// - A rigid tap along X has an axis drive that does not act together with the spindle's drive:
///   [`Code::TapDrivesApart`].
/// - Lead times speed exceeds the axis' feed, in or out: [`Code::LeadTooFast`].
/// - The errors of [`stroke`], or for ordinary tapping of [`FloatPlan::new`](crate::motion::FloatPlan::new).
pub fn tap_report(
    call: &TapCall,
    signals: Signals,
    span: Span,
    params: &Params,
) -> Result<TapReport, Alarm> {
    let spindle = tap_can_begin(call, signals, span, params)?;
    let hand = signals.hand(call.hand);
    let plan = match call.mode {
        TapMode::Rigid => None,
        TapMode::Floating => Some(FloatPlan::new(call, hand, span, params)?),
    };
    let mut report = TapReport::default();
    let moves = &mut TapMoves::of(call, hand, spindle, span);
    let limits = &Limits::from_params(params);
    tap_strokes(moves, call, plan.as_ref(), params, limits, &mut report)?;
    Ok(report)
}

/// The first part of [`tap_report`]: all checks that need no planned stroke. Returns the spindle that turns the tap.
///
/// # Errors
/// As [`tap_report`], without the errors of planning.
#[inline(never)]
pub(crate) fn tap_can_begin(
    call: &TapCall,
    signals: Signals,
    span: Span,
    params: &Params,
) -> Result<TapSpindle, Alarm> {
    let spindle = refuse_tap(call, signals, span)?;
    taps_with(spindle, span, params)?;
    in_step(call, span, params)?;
    for speed in [call.speed, call.extract] {
        feed(call.axis, call.lead.value, speed, span, params)?;
    }
    if call.mode == TapMode::Floating && spindle != TapSpindle::First {
        let number = Arg::Int(i64::from(spindle.number()));
        return Err(Alarm::new(Code::FloatSpindleWithoutEncoder, span).with([number]));
    }
    if call.mode == TapMode::Floating {
        let axis = match call.axis {
            TapAxis::X => Axis::X,
            TapAxis::Z => Axis::Z,
        };
        can_tap(call.lead, axis, whole(call.speed), span, params)?;
    }
    Ok(spindle)
}

/// The second part of [`tap_report`], with the plan of an ordinary tap. It plans every stroke of a hole, so that no stroke
/// can be refused later.
///
/// # Errors
/// The errors of [`stroke`].
#[inline(never)]
pub(crate) fn tap_strokes(
    moves: &mut TapMoves,
    call: &TapCall,
    plan: Option<&FloatPlan>,
    params: &Params,
    limits: &Limits,
    report: &mut TapReport,
) -> Result<(), Alarm> {
    let mut reached = false;
    let mut rate = PathRate::ZERO;
    if let Some(plan) = plan {
        report.fastest = plan.entry_speed();
    }
    let mut at = call.start;
    // All holes of a call are alike, so one hole is enough.
    while let Some(next) = moves.advance()
        && next.tag.as_ref().is_some_and(|tag| tag.pass == 1)
    {
        if let MoveKind::Tap(tap) = &next.kind {
            let travel = tap.axis.of(next.to) - tap.axis.of(at);
            let is_infeed = next.tag.as_ref().is_some_and(|tag| tag.stage == Stage::Tap);
            match plan {
                None => match &stroke(tap, travel, params, limits, next.span) {
                    Err(alarm) => return Err(*alarm),
                    Ok(planned) if is_infeed => {
                        reached |= planned.reaches_speed();
                        rate = rate.max(planned.peak());
                    }
                    Ok(_) => {}
                },
                Some(plan) if is_infeed && report.infeeds > 0 => {
                    report.fastest = faster(report.fastest, plan.peak(travel.abs()));
                }
                Some(_) => {}
            }
            if is_infeed {
                report.infeeds = report.infeeds.saturating_add(1);
            }
        }
        at = next.to;
    }
    let span = moves.span();
    let code = if let Some(plan) = plan {
        report.join = Some(join(call, plan, span));
        // A speed a thousandth lower counts as reached.
        let fastest = i64::from(report.fastest.get()).saturating_mul(1000);
        reached = fastest >= i64::from(call.speed.get()).saturating_mul(999);
        Code::FloatSpeedNotReached
    } else {
        report.fastest = speed(rate, call.lead.value, params.tick_us());
        Code::TapSpeedNotReached
    };
    if !reached {
        let figures = [call.speed, report.fastest].map(|speed| Arg::Rpm(whole(speed)));
        report.warning = Some(Alarm::new(code, span).with(figures));
    }
    Ok(())
}

/// Checks a spindle command for later taps: the spindle that it selects must exist. Other calls pass.
///
/// # Errors
/// Two spindles are selected at once ([`Code::TapSpindlesSelected`]); this machine does not have the spindle
/// ([`Code::TapSpindleNotAvailable`]).
pub fn tap_spindle(call: &Call, signals: Signals, params: &Params) -> Result<(), Alarm> {
    match call.kind {
        CallKind::Spindle(SpindleCall {
            mode: SpindleMode::Rigid(choice),
            ..
        }) => taps_with(signals.spindle(choice, call.span)?, call.span, params),
        _ => Ok(()),
    }
}

/// Axis and spindle stay on one line only if their drives act at the same time. A spindle's drive acts together with
/// Z's drive [D92].
fn in_step(call: &TapCall, span: Span, params: &Params) -> Result<(), Alarm> {
    let [x, z] = [Axis::X, Axis::Z].map(|axis| params.latency_us(axis));
    if call.mode == TapMode::Floating || call.axis == TapAxis::Z || x == z {
        return Ok(());
    }
    let us = |us: u32| Arg::Int(i64::from(us));
    Err(Alarm::new(Code::TapDrivesApart, span).with([us(x), us(z)]))
}

/// Checks the move of a tapping return at `span`.
///
/// # Errors
/// This machine does not have the spindle ([`Code::TapSpindleNotAvailable`]); lead times speed exceeds the axis' feed
/// ([`Code::LeadTooFast`]).
pub fn tap_return(out: &TapMove, span: Span, params: &Params) -> Result<(), Alarm> {
    taps_with(out.spindle, span, params)?;
    feed(out.axis, out.lead, out.speed, span, params)
}

fn taps_with(spindle: TapSpindle, span: Span, params: &Params) -> Result<(), Alarm> {
    if spindle.number() <= params.tap_spindles() {
        return Ok(());
    }
    let number = |n: u8| Arg::Int(i64::from(n));
    let args = [number(spindle.number()), number(params.tap_spindles())];
    Err(Alarm::new(Code::TapSpindleNotAvailable, span).with(args))
}

fn feed(
    axis: TapAxis,
    lead: Lead,
    speed: CentiRpm,
    span: Span,
    params: &Params,
) -> Result<(), Alarm> {
    let (axis, letter) = match axis {
        TapAxis::X => (Axis::X, b'X'),
        TapAxis::Z => (Axis::Z, b'Z'),
    };
    let most = params.max_feed(axis);
    let (nm, turns) = lead.parts();
    let nm = mul_div(
        nm,
        u64::from(speed.get().unsigned_abs()),
        turns.saturating_mul(100),
    );
    let wanted = Feed::from_nm_per_min(signed(nm));
    if wanted <= most {
        return Ok(());
    }
    let args = [
        Arg::Letter(letter),
        Arg::Feed(wanted),
        Arg::Feed(most),
        Arg::Rpm(whole(speed)),
    ];
    Err(Alarm::new(Code::LeadTooFast, span).with(args))
}

/// The spindle speed that belongs to a rate of the axis, rounded to the nearest hundredth of a turn a minute.
fn speed(rate: PathRate, lead: Lead, tick_us: u32) -> CentiRpm {
    // 1/256 nm per tick to nm per minute, times 100.
    let feed = u64::from(rate.raw()).saturating_mul(6_000_000_000);
    let divisor = u64::from(tick_us).saturating_mul(256);
    let nm = mul_div(feed, 1, divisor);
    let (lead_nm, turns) = lead.parts();
    let scaled = product(nm, turns).saturating_add(u128::from(lead_nm >> 1));
    let rounded = narrow_div(scaled, lead_nm);
    CentiRpm::new(i32::try_from(rounded).unwrap_or(i32::MAX))
}

/// Whole turns a minute, halves upwards.
fn whole(speed: CentiRpm) -> Rpm {
    Rpm::new(speed.get().saturating_add(50).div_euclid(100))
}

#[cfg(test)]
mod tests {
    use core::num::NonZeroU8;

    use super::*;
    use crate::alarm::At;
    use crate::call::{
        HandChoice, Position, SpindleChoice, TapCycle, TapForm, TapMode, TapPeck, TapRepeat,
    };
    use crate::params::Entry;
    use crate::units::{Length, Millis};

    const HERE: Span = Span {
        line: 7,
        column: 1,
        end: 4,
    };

    fn at<T>(value: T) -> At<T> {
        At::new(value, Span::default())
    }

    fn nm(nm: i64) -> Length {
        Length::from_nm(nm)
    }

    /// 50 mm at lead 2 and S1000.
    fn hole() -> TapCall {
        TapCall {
            cycle: TapCycle::G84,
            mode: TapMode::Rigid,
            axis: TapAxis::Z,
            start: Position::ZERO,
            hole: Position::ZERO,
            step: Position::ZERO,
            level: at(Length::ZERO),
            bottom: at(nm(-50_000_000)),
            form: TapForm::Standard,
            dwell: Millis::new(0),
            lead: at(Lead::new(2_000_000, 1).unwrap()),
            hand: HandChoice::Signal,
            speed: CentiRpm::new(100_000),
            extract: CentiRpm::new(100_000),
            spindle: SpindleChoice::default(),
            repeat: TapRepeat::Holes(NonZeroU8::MIN),
            clamp: None,
            continues: false,
            notes: crate::call::TapNotes::default(),
        }
    }

    fn machine(settings: &[(&str, i64)]) -> Params {
        let mut params = Params::sheets();
        for (key, value) in settings {
            params.set(Entry::find_text(key).unwrap(), *value).unwrap();
        }
        params
    }

    fn report(call: &TapCall) -> TapReport {
        tap_report(call, Signals::default(), HERE, &machine(&[])).unwrap()
    }

    fn refused(call: &TapCall, params: &Params) -> Alarm {
        let alarm = tap_report(call, Signals::default(), HERE, params).unwrap_err();
        assert_eq!(alarm.span, HERE);
        alarm
    }

    fn pecks(q: i64, d: i64) -> TapPeck {
        TapPeck {
            infeed: at(nm(q)),
            back: at(nm(d)),
        }
    }

    #[test]
    fn infeeds_are_counted_in_every_form() {
        assert_eq!(report(&hole()).infeeds, 1);
        let peck = pecks(4_000_000, 1_000_000);
        for form in [TapForm::HighSpeed(peck), TapForm::Deep(peck)] {
            let report = report(&TapCall { form, ..hole() });
            assert_eq!(report.infeeds, 13);
        }
        let holes = TapRepeat::Holes(NonZeroU8::new(9).unwrap());
        let alike = TapCall {
            repeat: holes,
            ..hole()
        };
        assert_eq!(report(&alike), report(&hole()));
    }

    #[test]
    fn a_speed_that_is_reached_is_told_and_one_that_is_not_warned_of() {
        let deep = report(&hole());
        assert_eq!((deep.fastest, deep.warning), (CentiRpm::new(100_000), None));
        let shallow = report(&TapCall {
            bottom: at(nm(-1_000_000)),
            ..hole()
        });
        let warning = shallow.warning.unwrap();
        assert_eq!(warning.code, Code::TapSpeedNotReached);
        assert_eq!(warning.span, HERE);
        let reached = Arg::Rpm(whole(shallow.fastest));
        assert_eq!(warning.args[..2], [Arg::Rpm(Rpm::new(1000)), reached]);
        assert!(shallow.fastest < CentiRpm::new(60_000) && shallow.fastest > CentiRpm::new(5_000));
    }

    #[test]
    fn the_axis_has_to_follow_in_and_out() {
        // 8 m/min at lead 2: 4000 rpm, not one more.
        let params = machine(&[]);
        let fast = |speed: i32, extract: i32| TapCall {
            speed: CentiRpm::new(speed * 100),
            extract: CentiRpm::new(extract * 100),
            ..hole()
        };
        for call in [fast(4001, 1000), fast(1000, 4001)] {
            let alarm = refused(&call, &params);
            assert_eq!(alarm.code, Code::LeadTooFast);
            assert_eq!(alarm.args[0], Arg::Letter(b'Z'));
            assert_eq!(
                alarm.args[1],
                Arg::Feed(Feed::from_nm_per_min(8_002_000_000))
            );
            assert_eq!(alarm.args[3], Arg::Rpm(Rpm::new(4001)));
        }
        assert!(tap_report(&fast(1000, 4000), Signals::default(), HERE, &params).is_ok());
        let side = TapCall {
            axis: TapAxis::X,
            ..fast(4001, 1000)
        };
        assert_eq!(refused(&side, &params).args[0], Arg::Letter(b'X'));
    }

    #[test]
    fn the_spindle_has_to_be_there_and_its_drive_in_step() {
        let third = TapCall {
            spindle: SpindleChoice::Written(TapSpindle::Third),
            ..hole()
        };
        let alarm = refused(&third, &machine(&[("9014", 2)]));
        assert_eq!(alarm.code, Code::TapSpindleNotAvailable);
        assert_eq!(alarm.args[..2], [Arg::Int(3), Arg::Int(2)]);
        assert!(tap_report(&third, Signals::default(), HERE, &machine(&[("9014", 3)])).is_ok());
        let late = machine(&[("9003.Z", 700)]);
        assert!(tap_report(&hole(), Signals::default(), HERE, &late).is_ok());
        let side = TapCall {
            axis: TapAxis::X,
            ..hole()
        };
        let alarm = refused(&side, &late);
        assert_eq!(alarm.code, Code::TapDrivesApart);
        assert_eq!(alarm.args[..2], [Arg::Int(0), Arg::Int(700)]);
    }

    #[test]
    fn rigid_mode_asks_for_its_spindle_too() {
        let call = |kind| Call {
            span: HERE,
            origin: Position::ZERO,
            kind,
        };
        let rigid = |spindle| call(CallKind::Spindle(SpindleCall::rigid(Rpm::new(9), spindle)));
        let two = machine(&[("9014", 2)]);
        let signals = Signals {
            sws: 0b1000,
            ..Signals::default()
        };
        let alarm = tap_spindle(&rigid(SpindleChoice::default()), signals, &two).unwrap_err();
        assert_eq!(alarm.code, Code::TapSpindleNotAvailable);
        let second = rigid(SpindleChoice::Written(TapSpindle::Second));
        assert_eq!(tap_spindle(&second, signals, &two), Ok(()));
        let turning = call(CallKind::Spindle(SpindleCall::speed(Rpm::new(300))));
        assert_eq!(tap_spindle(&turning, signals, &two), Ok(()));
    }
}
