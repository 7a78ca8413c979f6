//! The words of G32 and G34: one stroke from where the tool stands to the end point, in step with the spindle.
//!
//! J moves the short axis away from the line over the last K of the long one. Its sign is the direction: a stroke knows no
//! outside and inside. K of G34 is another word: the change of the lead per turn.

use super::refuse::refuse_thread;
use super::shape::Shape;
use super::words::{ThreadWords, parameter};
use crate::alarm::{Alarm, At, Code, Span};
use crate::call::{CallKind, CutIn, Infeed, Position, ThreadCall, ThreadCycle};
use crate::text::{Block, Letters, Modal, PLANE_AXES, Plan, Range};
use crate::units::{LeadChange, Length, StartAngle};

impl ThreadWords {
    /// A block while G32 is in force, at `span`: where its stroke ends, run-out and all. `None` without a word of X or Z,
    /// which moves nothing.
    pub(crate) fn read_stroke(
        &mut self,
        modal: &Modal<'_>,
        block: &Block,
        span: Span,
        plan: &mut Plan,
    ) -> Result<Option<Position>, Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"IQJK")))?;
        self.read_lead(modal, block)?;
        self.read_run_out(modal, block)?;
        let Some(call) = self.stroke(ThreadCycle::G32, modal, block, span)? else {
            return Ok(None);
        };
        let call = ThreadCall {
            run_out: self.run_out.of_stroke(span)?,
            ..call
        };
        plan.motion(span, CallKind::Thread(call));
        Ok(Some(stroke_end(&call, span)))
    }

    /// G34 begins: no K of an earlier one is kept.
    pub(crate) const fn begin_variable(&mut self) {
        self.change = None;
    }

    /// A block while G34 is in force, at `span`: where its stroke ends. K is the change of the lead.
    pub(crate) fn read_variable(
        &mut self,
        modal: &Modal<'_>,
        block: &Block,
        span: Span,
        plan: &mut Plan,
    ) -> Result<Option<Position>, Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"IQK")))?;
        self.read_lead(modal, block)?;
        if let Some(k) = block.find(b'K') {
            self.change = Some(modal.scale.lead_change(&k)?);
        }
        let Some(call) = self.stroke(ThreadCycle::G34, modal, block, span)? else {
            return Ok(None);
        };
        let Some(change) = self.change else {
            return Err(Alarm::new(Code::LeadChangeMissing, span));
        };
        let call = ThreadCall { change, ..call };
        plan.motion(span, CallKind::Thread(call));
        Ok(Some(stroke_end(&call, span)))
    }

    /// What both strokes have: the end and the lead in force. `None` without a word of X or Z.
    fn stroke(
        &self,
        cycle: ThreadCycle,
        modal: &Modal<'_>,
        block: &Block,
        span: Span,
    ) -> Result<Option<ThreadCall>, Alarm> {
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
        Ok(Some(ThreadCall {
            cycle,
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
            change: parameter(LeadChange::NONE),
            first_angle,
            increment: modal.scale.increment(),
            rpm: modal.rpm(),
        }))
    }

    /// J and K of G32: J with a sign, K without.
    fn read_run_out(&mut self, modal: &Modal<'_>, block: &Block) -> Result<(), Alarm> {
        let j = match block.find(b'J') {
            Some(word) => Some(modal.scale.distance(&word, Range::SIGNED_NINE_DIGITS)?),
            None => None,
        };
        let k = match block.find(b'K') {
            Some(word) => {
                word.not_negative()?;
                Some(modal.scale.distance(&word, Range::NINE_DIGITS)?)
            }
            None => None,
        };
        self.run_out.write_directed(j, k);
        Ok(())
    }
}

/// Where the tool stands after a stroke: at the end of its run-out. A stroke that is refused ends at D.
fn stroke_end(call: &ThreadCall, span: Span) -> Position {
    let mut end = call.start;
    if refuse_thread(call, span).is_ok() {
        let shape = Shape::of(call);
        let place = shape.place(&shape.stroke_end());
        (end.x, end.z) = (place.x, place.z);
    } else {
        (end.x, end.z) = (call.end_x.value, call.end_z.value);
    }
    end
}
