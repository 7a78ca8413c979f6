//! The words of G90 and G94, kept from block to block, and the four moves they make.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::Position;
use crate::text::{Block, Letters, Modal, PLANE_AXES, Plan, Range, g_arg};
use crate::units::Length;

/// Which turning cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turning {
    /// G90: the cut goes along Z.
    Along,
    /// G94: the cut goes along X.
    Across,
}

impl Turning {
    /// The number of its G code.
    pub(crate) const fn code(self) -> i64 {
        match self {
            Self::Along => 90,
            Self::Across => 94,
        }
    }
}

/// What a turning cycle keeps from block to block, as long as its mode lasts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TurningWords {
    /// D in machine coordinates, X as a radius.
    end_x: Option<Length>,
    end_z: Option<Length>,
    /// R: at the start of the cut minus at D; a radius in G90, along Z in G94.
    taper: Length,
}

impl TurningWords {
    /// A block while the cycle is in force, at `span`. Without a word of X or Z it moves nothing.
    ///
    /// # Errors
    /// D is not known yet ([`Code::CycleEndMissing`]); R points against the infeed and is longer than the infeed
    /// ([`Code::TaperAgainstInfeed`]); a word that does not belong here.
    pub(crate) fn read(
        &mut self,
        cycle: Turning,
        modal: &Modal<'_>,
        block: &Block,
        span: Span,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        block.only(PLANE_AXES.and(Letters::of(b"R")))?;
        let taper = block.find(b'R');
        if let Some(word) = &taper {
            self.taper = modal.scale.distance(word, Range::SIGNED_NINE_DIGITS)?.value;
        }
        if !block.has_any(PLANE_AXES) {
            return Ok(());
        }
        let (end, x, z) = modal.cycle_end(block)?;
        if x != Span::default() {
            self.end_x = Some(end.x);
        }
        if z != Span::default() {
            self.end_z = Some(end.z);
        }
        let missing = |letter| {
            let figures = [g_arg(cycle.code()), Arg::Letter(letter)];
            Alarm::new(Code::CycleEndMissing, span).with(figures)
        };
        let start = modal.position;
        let end = Position {
            x: self.end_x.ok_or_else(|| missing(b'X'))?,
            z: self.end_z.ok_or_else(|| missing(b'Z'))?,
            ..start
        };
        let infeed = match cycle {
            Turning::Along => end.x - start.x,
            Turning::Across => end.z - start.z,
        };
        // Where D is as far out as the start, R alone feeds in, as in the maker's own example.
        let against = infeed != Length::ZERO && self.taper.signum() != infeed.signum();
        if against && self.taper.abs() > infeed.abs() {
            let figures = [Arg::Length(self.taper), Arg::Length(infeed)];
            let alarm = match &taper {
                Some(word) => word.alarm(Code::TaperAgainstInfeed),
                None => Alarm::new(Code::TaperAgainstInfeed, span).word(b'R'),
            };
            return Err(alarm.with(figures));
        }
        let (mut first, mut last) = (start, start);
        match cycle {
            Turning::Along => {
                first.x = end.x + self.taper;
                last.z = end.z;
            }
            Turning::Across => {
                first.z = end.z + self.taper;
                last.x = end.x;
            }
        }
        if !first.x.is_in_range() || !first.z.is_in_range() {
            let limit = [Arg::Length(Length::INPUT_LIMIT)];
            return Err(Alarm::new(Code::PositionOutOfRange, span)
                .word(b'R')
                .with(limit));
        }
        let feed = modal.feed(span, cycle.code(), &[start.x, first.x, end.x])?;
        plan.straight(span, first, None);
        plan.straight(span, end, Some(feed));
        plan.straight(span, last, Some(feed));
        plan.straight(span, start, None);
        Ok(())
    }
}
