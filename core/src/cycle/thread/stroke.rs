//! The words of G32: one stroke from where the tool stands to the end point, in step with the spindle.

use super::words::{ThreadWords, parameter};
use crate::alarm::{Alarm, At, Code, Span};
use crate::call::{CallKind, CutIn, Infeed, Position, ThreadCall, ThreadCycle};
use crate::text::{Block, Letters, Modal, PLANE_AXES, Plan};
use crate::units::{Length, StartAngle};

impl ThreadWords {
    /// A block while G32 is in force, at `span`: where its stroke ends. `None` without a word of X or Z, which moves
    /// nothing.
    pub(crate) fn read_stroke(
        &mut self,
        modal: &Modal<'_>,
        block: &Block,
        span: Span,
        plan: &mut Plan,
    ) -> Result<Option<Position>, Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"IQ")))?;
        self.read_lead(modal, block)?;
        let first_angle = match block.find(b'Q') {
            Some(q) => StartAngle::from_mdeg(q.count(StartAngle::FULL)?),
            None => StartAngle::INDEX,
        };
        if !block.has_any(PLANE_AXES) {
            return Ok(None);
        }
        let (end, x, z) = modal.cycle_end(block)?;
        let Some(lead) = self.lead else {
            let range = modal.scale.lead_range();
            return Err(Alarm::new(Code::LeadMissing, span).with(range));
        };
        let none = || parameter(Length::ZERO);
        let call = ThreadCall {
            cycle: ThreadCycle::G32,
            start: modal.position,
            end_x: At::new(end.x, x),
            end_z: At::new(end.z, z),
            taper: none(),
            height: none(),
            first_depth: none(),
            min_step: none(),
            allowance: none(),
            finish_passes: parameter(1),
            angle: parameter(0),
            infeed: Infeed::Equal,
            cut_in: parameter(CutIn::Centre),
            starts: parameter(1),
            run_in: none(),
            run_out: None,
            lead,
            first_angle,
            increment: modal.scale.increment(),
            rpm: modal.rpm(),
        };
        plan.motion(span, CallKind::Thread(call));
        Ok(Some(end))
    }
}
