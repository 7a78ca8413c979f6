//! The words of G75 ([G75 sheet]).

use super::block::{Block, Letters, Word};
use super::call::{CallKind, GrooveCall};
use super::options::Dialect;
use super::plan::Plan;
use super::scale::Range;
use super::state::{PLANE_AXES, State};
use crate::alarm::{Alarm, At, Code, Span};
use crate::units::{Diameter, Length};

/// What G75 keeps from block to block.
#[derive(Clone, Copy, Debug)]
pub(super) struct GrooveWords {
    /// R(e).
    retract: Option<At<Length>>,
}

impl GrooveWords {
    pub(super) const fn new() -> Self {
        Self { retract: None }
    }
}

impl State<'_> {
    /// P and Q of G75 and G76 as lengths: increments or mm/inch by dialect and 182.7 [D4].
    pub(super) fn p_or_q(&self, word: &Word, range: Range) -> Result<At<Length>, Alarm> {
        if self.options.dialect == Dialect::Gsk980td && !self.params.pq_in_mm() {
            self.scale.increments(word, range)
        } else {
            self.scale.distance(word, range)
        }
    }

    /// A G75 block: the first with R(e) alone, or the cycle.
    pub(super) fn groove(
        &mut self,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        self.only(block, PLANE_AXES.and(Letters::of(b"PQR")))?;
        if !block.has_any(PLANE_AXES.and(Letters::of(b"PQ"))) {
            if let Some(r) = block.find(b'R') {
                not_negative(&r)?;
                self.groove.retract = Some(self.scale.distance(&r, self.scale.small())?);
            }
            return Ok(());
        }
        if !block.has_any(Letters::of(b"XU")) {
            return Err(Alarm::new(Code::GrooveWithoutX, word.span));
        }
        let (end, x, z) = self.cycle_end(block)?;
        let peck = match block.find(b'P') {
            None => return Err(Alarm::new(Code::GrooveStepMissing, word.span)),
            Some(p) => {
                let step = self.groove_step(&p)?;
                if step.value == Length::ZERO {
                    return Err(p.alarm(Code::GrooveStepMissing));
                }
                At::new(Diameter::from_nm(step.value.nm()).radius(), step.span)
            }
        };
        let z_written = block.has_any(Letters::of(b"ZW"));
        let step = match block.find(b'Q') {
            // Q without Z has nothing to step along; it is still read, so that nonsense is refused.
            Some(q) => Some(self.groove_step(&q)?).filter(|step| step.value != Length::ZERO),
            None => None,
        };
        if step.is_none() && end.z != self.position.z {
            return Err(match block.find(b'Q') {
                Some(q) => q.alarm(Code::GrooveStepMissing),
                None => Alarm::new(Code::GrooveStepMissing, word.span),
            });
        }
        let relief = match block.find(b'R') {
            Some(r) if r.value.mantissa() < 0 => return Err(r.alarm(Code::GrooveRelief)),
            Some(r) => self.scale.distance(&r, Range::EIGHT_DIGITS)?,
            None => At::new(Length::ZERO, Span::default()),
        };
        let retract = self
            .groove
            .retract
            .unwrap_or_else(|| At::new(self.params.groove_retract(), Span::default()));
        let call = GrooveCall {
            start: self.position,
            end_x: At::new(end.x, x),
            end_z: At::new(end.z, z),
            z_written,
            peck: Some(peck),
            step,
            relief,
            retract,
            feed: self.feed(word.span, 75)?,
        };
        plan.motion(word.span, CallKind::Groove(call));
        Ok(())
    }

    fn groove_step(&self, word: &Word) -> Result<At<Length>, Alarm> {
        if word.value.mantissa() < 0 {
            return Err(word.alarm(Code::GrooveStepNegative));
        }
        self.p_or_q(word, Range::EIGHT_DIGITS)
    }
}

/// Refuses a minus where the sheets print "unsigned".
pub(super) fn not_negative(word: &Word) -> Result<(), Alarm> {
    if word.value.mantissa() < 0 {
        Err(word.alarm(Code::Negative))
    } else {
        Ok(())
    }
}
