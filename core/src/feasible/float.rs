//! Ordinary tapping against the machine: a turning spindle, the way to get onto the lead, and the speed from which the
//! spindle can be stopped in the hole (cycles.md section 8).

use super::tap::{TapJoin, TapReport, whole};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::cycle::{MoveKind, Stage, TapMoves};
use crate::motion::FloatPlan;
use crate::params::Params;
use crate::program::{Hand, TapCall, TapSpindle};
use crate::units::{CentiRpm, Length};

/// The report of a call whose feeds have been checked.
#[inline(never)]
pub(super) fn floating(
    call: &TapCall,
    moves: &mut TapMoves,
    hand: Hand,
    span: Span,
    params: &Params,
) -> Result<TapReport, Alarm> {
    if moves.spindle() != TapSpindle::First {
        let number = Arg::Int(i64::from(moves.spindle().number()));
        let args = [number];
        return Err(Alarm::new(Code::FloatSpindleWithoutEncoder, span).with(args));
    }
    let plan = FloatPlan::new(call, hand, span, params)?;
    let mut report = TapReport {
        infeeds: 0,
        fastest: plan.entry_speed(),
        warning: None,
        join: Some(join(call, &plan, span)),
    };
    let mut at = call.start;
    // All holes of a call are alike.
    for next in moves.take_while(|next| next.tag.is_none_or(|tag| tag.pass == 1)) {
        let is_infeed = next.tag.is_some_and(|tag| tag.stage == Stage::Tap);
        if let MoveKind::Tap(tap) = &next.kind
            && is_infeed
        {
            if report.infeeds > 0 {
                let travel = (tap.axis.of(next.to) - tap.axis.of(at)).abs();
                report.fastest = faster(report.fastest, plan.peak(travel));
            }
            report.infeeds = report.infeeds.saturating_add(1);
        }
        at = next.to;
    }
    // A thousandth less counts as reached.
    let reached = i64::from(report.fastest.get()).saturating_mul(1000);
    if reached < i64::from(call.speed.get()).saturating_mul(999) {
        let args = [Arg::Rpm(whole(call.speed)), Arg::Rpm(whole(report.fastest))];
        report.warning = Some(Alarm::new(Code::FloatSpeedNotReached, span).with(args));
    }
    Ok(report)
}

fn join(call: &TapCall, plan: &FloatPlan, span: Span) -> TapJoin {
    let total = (call.bottom.value - call.level.value).abs();
    let (lead_in, ahead) = (plan.lead_in(), plan.ahead());
    let long = lead_in > Length::from_nm(total.nm() / 4);
    let args = [Arg::Length(lead_in), Arg::Length(ahead)];
    TapJoin {
        lead_in,
        ahead,
        warning: long.then(|| Alarm::new(Code::FloatJoinLong, span).with(args)),
    }
}

fn faster(a: CentiRpm, b: CentiRpm) -> CentiRpm {
    if b.get() > a.get() { b } else { a }
}
