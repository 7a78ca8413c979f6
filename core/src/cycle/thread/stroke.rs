//! The words of G32 and G34: one stroke from where the tool stands to the end point, in step with the spindle.
//!
//! J moves the short axis away from the line over the last K of the long one. Its sign is the direction: a stroke knows no
//! outside and inside. K of G34 is another word: the change of the lead per turn.
//!
//! Strokes of G32 that follow each other are one thread, a chain: the next one begins where the line of the one before
//! ends, not at the end of its run-out. Whether another stroke follows is not known here; the reader of the program takes
//! the run-out from those that go on.

use super::helix::{Helix, TURN_UDEG};
use super::pickup::follow;
use super::refuse::refuse_thread;
use super::shape::{Shape, long_way};
use super::words::{ThreadWords, parameter};
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{CallKind, ChainPart, CutIn, Infeed, Position, ThreadCall, ThreadCycle};
use crate::text::{Block, Group, Letters, Modal, PLANE_AXES, Plan, Range};
use crate::units::{LeadChange, Length, StartAngle};

/// The latest stroke, for a stroke that follows it without another motion between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroked {
    /// Where its line ends, and where its run-out does.
    line_end: Position,
    end: Position,
    /// The angle of the helix where the line ends, in millionths of a degree.
    angle: u32,
    /// Strokes of its chain so far.
    count: usize,
    /// No stroke can be joined to it: something but N, F, I, J, K and Q was written after it.
    interrupted: bool,
}

impl Stroked {
    /// The next block begins.
    pub(crate) fn then(&mut self, block: &Block) {
        let harmless = PLANE_AXES.and(Letters::of(b"NFIJKQ"));
        self.interrupted |= !block.letters().without(harmless).is_empty()
            || block.has_m()
            || block.has_groups(!Group::Motion.bit());
    }

    /// Where the tool stands.
    pub(crate) const fn end(&self) -> Position {
        self.end
    }
}

impl ThreadWords {
    /// A block while G32 is in force, at `span`, after the stroke `before`. `None` without a word of X or Z, which moves
    /// nothing.
    pub(crate) fn read_stroke(
        &mut self,
        modal: &Modal<'_>,
        block: &Block,
        span: Span,
        before: Option<&Stroked>,
        plan: &mut Plan,
    ) -> Result<Option<Stroked>, Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"IQJK")))?;
        self.read_lead(modal, block)?;
        self.read_run_out(modal, block)?;
        if !block.has_any(PLANE_AXES) {
            return Ok(None);
        }
        let mut from = modal;
        let behind;
        if let Some(before) = before {
            if before.interrupted {
                return Err(Alarm::new(Code::StrokeAfterStroke, span));
            }
            if before.count == ChainPart::MOST {
                let most = [Arg::Int(ChainPart::MOST as i64)];
                return Err(Alarm::new(Code::ChainTooLong, span).with(most));
            }
            behind = Modal {
                position: before.line_end,
                ..modal.clone()
            };
            from = &behind;
            if let Some(q) = block.find(b'Q') {
                plan.warn(q.alarm(Code::StartAngleJoined));
            }
        }
        let Some(mut call) = self.stroke(ThreadCycle::G32, from, block, span)? else {
            return Ok(None);
        };
        call.run_out = self.run_out.of_stroke(span)?;
        if before.is_none() {
            call = follow(call, modal, span, plan)?;
        }
        let mut angle = call.first_angle.mdeg().wrapping_mul(1000);
        if let Some(before) = before {
            angle = before.angle;
            call.part = ChainPart::Last;
            call.first_angle = StartAngle::from_mdeg(angle.wrapping_add(500) / 1000);
        }
        plan.motion(span, CallKind::Thread(call));
        let mut line_end = call.start;
        (line_end.x, line_end.z) = (call.end_x.value, call.end_z.value);
        let turned = Helix::new(call.lead.value).angle(long_way(&call).nm().unsigned_abs());
        Ok(Some(Stroked {
            line_end,
            end: stroke_end(&call, span),
            angle: angle.wrapping_add(turned) % TURN_UDEG,
            count: before.map_or(1, |before| before.count.saturating_add(1)),
            interrupted: block.has_m(),
        }))
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
    ) -> Result<Option<Stroked>, Alarm> {
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
        let call = follow(ThreadCall { change, ..call }, modal, span, plan)?;
        plan.motion(span, CallKind::Thread(call));
        let end = stroke_end(&call, span);
        Ok(Some(Stroked {
            line_end: end,
            end,
            angle: 0,
            count: 1,
            // No stroke can be joined to it.
            interrupted: true,
        }))
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
            part: ChainPart::Whole,
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
