//! Ordinary tapping against the machine: the way to get onto the lead (cycles.md section 8).

use super::tap::TapJoin;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::motion::FloatPlan;
use crate::program::TapCall;
use crate::units::{CentiRpm, Length};

pub(super) fn join(call: &TapCall, plan: &FloatPlan, span: Span) -> TapJoin {
    let total = (call.bottom.value - call.level.value).abs();
    let (lead_in, ahead) = (plan.lead_in(), plan.ahead());
    let long = lead_in > Length::from_nm(total.nm() / 4);
    let figures = [Arg::Length(lead_in), Arg::Length(ahead)];
    TapJoin {
        lead_in,
        ahead,
        warning: long.then(|| Alarm::new(Code::FloatJoinLong, span).with(figures)),
    }
}

pub(super) fn faster(a: CentiRpm, b: CentiRpm) -> CentiRpm {
    if b.get() > a.get() { b } else { a }
}
