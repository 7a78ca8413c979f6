//! The words of G92, kept from block to block: one pass at D. It is a thread of no height, whose only pass finishes it.

use super::pickup::follow;
use super::run_out::Chamfer;
use super::words::{Extras, ThreadWords, parameter, starts};
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{CallKind, ChainPart, CutIn, Infeed, ThreadCall, ThreadCycle};
use crate::text::{Block, Letters, Modal, PLANE_AXES, Plan, Range, g_arg};
use crate::units::{LeadChange, Length, StartAngle};

/// D and R of G92.
#[derive(Clone, Copy, Debug)]
pub(super) struct Single {
    end_x: Option<At<Length>>,
    end_z: Option<At<Length>>,
    taper: At<Length>,
}

impl Single {
    pub(super) const NONE: Self = Self {
        end_x: None,
        end_z: None,
        taper: At::new(
            Length::ZERO,
            Span {
                line: 0,
                column: 0,
                end: 0,
            },
        ),
    };
}

impl ThreadWords {
    /// G92 begins: nothing of an earlier one is kept.
    pub(crate) const fn begin_single(&mut self) {
        self.g92 = Single::NONE;
    }

    /// A block while G92 is in force, at `span`. Without a word of X or Z it moves nothing.
    pub(crate) fn read_single(
        &mut self,
        modal: &Modal<'_>,
        block: &Block,
        span: Span,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"RIJKLQ")))?;
        self.read_lead(modal, block)?;
        let extras = Extras::read(modal, block, Range::NINE_DIGITS)?;
        self.run_out.write(extras.j, extras.k);
        if let Some(l) = block.find(b'L') {
            self.starts = starts(&l)?;
        }
        if let Some(r) = block.find(b'R') {
            self.g92.taper = modal.scale.distance(&r, Range::SIGNED_NINE_DIGITS)?;
        }
        let first_angle = match block.find(b'Q') {
            Some(q) => StartAngle::from_mdeg(q.count(StartAngle::FULL)?),
            None => StartAngle::INDEX,
        };
        if !block.has_any(PLANE_AXES) {
            return Ok(());
        }
        let (end, x, z) = modal.cycle_end(block)?;
        if x != Span::default() {
            self.g92.end_x = Some(At::new(end.x, x));
        }
        if z != Span::default() {
            self.g92.end_z = Some(At::new(end.z, z));
        }
        let missing =
            |letter| Alarm::new(Code::CycleEndMissing, span).with([g_arg(92), Arg::Letter(letter)]);
        let end_x = self.g92.end_x.ok_or_else(|| missing(b'X'))?;
        let end_z = self.g92.end_z.ok_or_else(|| missing(b'Z'))?;
        let Some(lead) = self.lead else {
            let range = modal.scale.lead_range();
            return Err(Alarm::new(Code::LeadMissing, span).with(range));
        };
        let (j, k) = self.run_out.sizes();
        let chamfer = Chamfer::plain(modal, parameter(modal.run_out_tenths()));
        let call = ThreadCall {
            cycle: ThreadCycle::G92,
            start: modal.position,
            end_x,
            end_z,
            taper: self.g92.taper,
            height: parameter(Length::ZERO),
            first_depth: parameter(Length::ZERO),
            min_step: parameter(Length::ZERO),
            allowance: parameter(Length::ZERO),
            finish_passes: parameter(1),
            angle: parameter(0),
            infeed: Infeed::Equal,
            cut_in: parameter(CutIn::Centre),
            starts: self.starts,
            run_in: parameter(Length::ZERO),
            run_out: chamfer.resolve(j, k, lead.value),
            lead,
            change: parameter(LeadChange::NONE),
            first_angle,
            part: ChainPart::Whole,
            increment: modal.scale.increment(),
            rpm: modal.rpm(),
        };
        let call = follow(call, modal, span, plan)?;
        plan.motion(span, CallKind::Thread(call));
        Ok(())
    }
}
