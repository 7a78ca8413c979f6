//! The words of G75 ([G75 sheet]).

use crate::alarm::{Alarm, At, Code, Span};
use crate::call::{CallKind, GrooveCall};
use crate::text::{Block, Letters, Modal, PLANE_AXES, Plan, Range, Word};
use crate::units::{Diameter, Length};

/// What G75 keeps from block to block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GrooveWords {
    /// R(e).
    retract: Option<At<Length>>,
}

impl GrooveWords {
    pub(crate) const fn new() -> Self {
        Self { retract: None }
    }
}

impl GrooveWords {
    /// A G75 block: the first with R(e) alone, or the cycle.
    pub(crate) fn read(
        &mut self,
        modal: &Modal<'_>,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"PQR")))?;
        if !block.has_any(PLANE_AXES.and(Letters::of(b"PQ"))) {
            if let Some(r) = block.find(b'R') {
                r.not_negative()?;
                self.retract = Some(modal.scale.distance(&r, modal.scale.small())?);
            }
            return Ok(());
        }
        if !block.has_any(Letters::of(b"XU")) {
            return Err(Alarm::new(Code::GrooveWithoutX, word.span));
        }
        let (end, x, z) = modal.cycle_end(block)?;
        let peck = match block.find(b'P') {
            None => return Err(Alarm::new(Code::GrooveStepMissing, word.span)),
            Some(p) => {
                let step = groove_step(modal, &p)?;
                if step.value == Length::ZERO {
                    return Err(p.alarm(Code::GrooveStepMissing));
                }
                At::new(Diameter::from_nm(step.value.nm()).radius(), step.span)
            }
        };
        let z_written = block.has_any(Letters::of(b"ZW"));
        let step = match block.find(b'Q') {
            // Q without Z has nothing to step along; it is still read, so that nonsense is refused.
            Some(q) => Some(groove_step(modal, &q)?).filter(|step| step.value != Length::ZERO),
            None => None,
        };
        if step.is_none() && end.z != modal.position.z {
            return Err(match block.find(b'Q') {
                Some(q) => q.alarm(Code::GrooveStepMissing),
                None => Alarm::new(Code::GrooveStepMissing, word.span),
            });
        }
        let relief = match block.find(b'R') {
            Some(r) if r.value.mantissa() < 0 => return Err(r.alarm(Code::GrooveRelief)),
            Some(r) => modal.scale.distance(&r, Range::EIGHT_DIGITS)?,
            None => At::new(Length::ZERO, Span::default()),
        };
        let retract = self
            .retract
            .unwrap_or_else(|| At::new(modal.params.groove_retract(), Span::default()));
        let call = GrooveCall {
            start: modal.position,
            end_x: At::new(end.x, x),
            end_z: At::new(end.z, z),
            z_written,
            peck: Some(peck),
            step,
            relief,
            retract,
            feed: modal.feed(word.span, 75)?,
        };
        plan.motion(word.span, CallKind::Groove(call));
        Ok(())
    }
}

fn groove_step(modal: &Modal<'_>, word: &Word) -> Result<At<Length>, Alarm> {
    if word.value.mantissa() < 0 {
        return Err(word.alarm(Code::GrooveStepNegative));
    }
    modal.p_or_q(word, Range::EIGHT_DIGITS)
}
