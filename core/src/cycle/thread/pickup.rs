//! A thread that was picked up: every thread begins at the angle with which its last pass runs in that groove.
//!
//! A pass is a helix: where it begins, the spindle is at its start angle. The tool has touched the groove at one place and
//! one angle of the spindle. So the start angle is that angle, less what the spindle turns from where the pass begins to
//! the place. Infeed along a flank moves the beginning of a pass along Z; the pass at full depth counts.
//!
//! Knows one call, the place and the tool. It must not know how the groove was touched, or who keeps it.

use super::helix::{Helix, TURN_UDEG};
use super::moves::ThreadMoves;
use super::shape::{is_long_x, long_way};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::ThreadCall;
use crate::offsets::{Offset, PickedUp};
use crate::text::{Modal, Plan};
use crate::units::{Angle, LeadChange, Length, StartAngle};

/// `call` in the groove that was picked up, if one was. Its own start angle counts from there.
///
/// # Errors
/// A lead that changes: [`Code::PickedUpVariable`].
pub(super) fn follow(
    mut call: ThreadCall,
    modal: &Modal<'_>,
    span: Span,
    plan: &mut Plan,
) -> Result<ThreadCall, Alarm> {
    let groove = modal.offsets().table.map(|table| table.thread);
    let Some(PickedUp {
        tip,
        angle: Some(angle),
    }) = groove
    else {
        return Ok(call);
    };
    if call.change.value != LeadChange::NONE {
        return Err(Alarm::new(Code::PickedUpVariable, span));
    }
    let tool = modal.offsets().tool(modal.offset);
    let udeg = start(&call, span, tip, angle, tool);
    let own = call.first_angle.mdeg();
    call.first_angle = StartAngle::from_mdeg(own.wrapping_add(udeg.wrapping_add(500) / 1000));
    let [axis, place] = if is_long_x(&call) {
        [Arg::Letter(b'X'), Arg::Diameter(tip.x)]
    } else {
        [Arg::Letter(b'Z'), Arg::Length(tip.z)]
    };
    let [angle, start] = [angle, Angle::from_udeg(udeg.into())].map(Arg::Angle);
    plan.warn_of_pickup(Alarm::new(Code::PickedUp, span).with([axis, place, angle, start]));
    Ok(call)
}

/// The start angle of `call` in the groove, in µ°, counted in the direction that the spindle turns; `tool`: geometry and
/// wear of the tool that cuts.
fn start(call: &ThreadCall, span: Span, tip: Offset, angle: Angle, tool: [Length; 2]) -> u32 {
    let begin = ThreadMoves::of(call, span).last_begin();
    let [tip_x, tip_z] = tip.slide();
    let [tool_x, tool_z] = tool;
    let (place, begin) = if is_long_x(call) {
        (tip_x + tool_x, begin.x)
    } else {
        (tip_z + tool_z, begin.z)
    };
    // In the direction of the stroke.
    let way = if long_way(call) < Length::ZERO {
        begin - place
    } else {
        place - begin
    };
    let full = i64::from(TURN_UDEG);
    let turned = i64::from(Helix::new(call.lead.value).angle(way.nm().unsigned_abs()));
    let turned = if way < Length::ZERO {
        turned
    } else {
        turned.wrapping_neg()
    };
    let touched = angle.udeg();
    let touched = if call.rpm.get() < 0 {
        touched.wrapping_neg()
    } else {
        touched
    };
    (touched.wrapping_add(turned).rem_euclid(full)) as u32
}
