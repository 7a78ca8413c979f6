//! The words of G75 ([G75 sheet]) and of G74, its twin along Z.

use crate::alarm::{Alarm, At, Code, Span};
use crate::call::{CallKind, GrooveCall, TapAxis};
use crate::text::{Block, Dialect, Letters, Modal, PLANE_AXES, Plan, Range, Word};
use crate::units::{Diameter, Length};

/// What a grooving cycle keeps from block to block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GrooveWords {
    /// R(e) of G74 and of G75.
    retract: [Option<At<Length>>; 2],
}

impl GrooveWords {
    pub(crate) const fn new() -> Self {
        Self { retract: [None; 2] }
    }

    /// A block of G75 (`axis` X) or G74 (Z): the first with R(e) alone, or the cycle.
    pub(crate) fn read(
        &mut self,
        axis: TapAxis,
        modal: &Modal<'_>,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"PQR")))?;
        let [z, x] = &mut self.retract;
        let (retract, bottom, across, code) = match axis {
            TapAxis::X => (x, b"XU", b"ZW", 75),
            TapAxis::Z => (z, b"ZW", b"XU", 74),
        };
        if !block.has_any(PLANE_AXES.and(Letters::of(b"PQ"))) {
            if let Some(r) = block.find(b'R') {
                r.not_negative()?;
                *retract = Some(modal.scale.distance(&r, modal.scale.small())?);
            }
            return Ok(());
        }
        if !block.has_any(Letters::of(bottom)) {
            let missing = match axis {
                TapAxis::X => Code::GrooveWithoutX,
                TapAxis::Z => Code::PeckingWithoutZ,
            };
            return Err(Alarm::new(missing, word.span));
        }
        let (end, x, z) = modal.cycle_end(block)?;
        let last_written = block.has_any(Letters::of(across));
        let [_, peck_letter, step_letter] = GrooveCall::letters(axis);
        let Some(peck) = groove_step(modal, block, peck_letter)? else {
            return Err(step_missing(block, peck_letter, word));
        };
        // A step without a second column has no way to go; it is still read, so that nonsense is refused.
        let step = groove_step(modal, block, step_letter)?;
        let across = axis.other();
        if step.is_none() && across.of(end) != across.of(modal.position) {
            return Err(step_missing(block, step_letter, word));
        }
        let mut relief = relief(modal, block)?;
        if axis == TapAxis::Z && !last_written {
            // A drill has nowhere to go aside.
            relief.value = Length::ZERO;
        }
        let call = GrooveCall {
            axis,
            start: modal.position,
            end_x: At::new(end.x, x),
            end_z: At::new(end.z, z),
            last_written,
            peck: Some(peck),
            step,
            relief,
            retract: retract
                .unwrap_or_else(|| At::new(modal.params.groove_retract(), Span::default())),
            feed: modal.feed(word.span, code, &[modal.position.x, end.x])?,
        };
        plan.motion(word.span, CallKind::Groove(call));
        Ok(())
    }
}

/// R of the cycle's block.
fn relief(modal: &Modal<'_>, block: &Block) -> Result<At<Length>, Alarm> {
    match block.find(b'R') {
        Some(r) if r.value.mantissa() < 0 => Err(r.alarm(Code::GrooveRelief)),
        Some(r) => modal.scale.distance(&r, Range::EIGHT_DIGITS),
        None => Ok(At::new(Length::ZERO, Span::default())),
    }
}

/// P or Q on the radius; `None` where it is missing or zero. P is a diameter on the 980TD.
fn groove_step(modal: &Modal<'_>, block: &Block, letter: u8) -> Result<Option<At<Length>>, Alarm> {
    let Some(word) = block.find(letter) else {
        return Ok(None);
    };
    if word.value.mantissa() < 0 {
        return Err(word.alarm(Code::GrooveStepNegative));
    }
    let mut step = modal.p_or_q(&word, Range::EIGHT_DIGITS)?;
    if letter == b'P' && modal.options.dialect == Dialect::Gsk980td {
        step.value = Diameter::from_nm(step.value.nm()).radius();
    }
    Ok((step.value != Length::ZERO).then_some(step))
}

/// The alarm for a step that is missing or zero.
fn step_missing(block: &Block, letter: u8, code: &Word) -> Alarm {
    match block.find(letter) {
        Some(word) => word.alarm(Code::GrooveStepMissing),
        None => Alarm::new(Code::GrooveStepMissing, code.span),
    }
}
