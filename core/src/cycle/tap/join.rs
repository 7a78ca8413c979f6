//! Ordinary tapping and the machine's limits: the way onto the lead.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::TapCall;
use crate::motion::FloatPlan;
use crate::units::{CentiRpm, Length};

/// How the axis of an ordinary tap gets onto the lead, and leaves it. Either R lies `lead_in` before the material, or
/// the holder takes up the distance by which the axis is ahead [D93].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapJoin {
    /// Distance from R to where the axis is on the lead.
    pub lead_in: Length,
    /// The largest distance by which the axis is ahead of the lead before that.
    pub ahead: Length,
    /// The warning that getting onto the lead takes more than a quarter of the depth.
    pub warning: Option<Alarm>,
}

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
