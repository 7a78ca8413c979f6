//! G30 P99: the way out of a hole in which a tap was stopped, from the tap journal ([G84/G88 sheet]; cycles.md section 9).

use super::{Context, Cycle, Move, MoveKind, Stage, Tag, TapMove};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::program::{Hand, LengthUnit, TapMode, TapReturn};
use crate::units::{Length, TurnRatio};

/// The one move of a tapping return: outwards and in phase from where the tool stands to R and `beyond` (5382) further.
/// `None` where it stands there already, or further out.
///
/// # Errors
/// [`Code::TapReturnNothing`] where no tap is in a hole; [`Code::TapReturnUnit`] where the unit has changed since.
#[inline(never)]
pub fn tap_return(
    call: &TapReturn,
    span: Span,
    context: &Context<'_>,
) -> Result<Option<Move>, Alarm> {
    let Some(record) = context.tap.filter(|record| record.in_hole) else {
        return Err(Alarm::new(Code::TapReturnNothing, span));
    };
    let hole = &record.hole;
    if hole.notes.unit != call.unit {
        let args = [unit_code(call.unit), unit_code(hole.notes.unit)];
        return Err(Alarm::new(Code::TapReturnUnit, span).with(args));
    }
    let end = hole.level - call.beyond.times(hole.inward());
    let travel = hole.depth(end) - hole.depth(hole.axis.of(context.at));
    if travel >= Length::ZERO {
        return Ok(None);
    }
    // Plus is the way in of a right-hand tap.
    let turns = TurnRatio::of_travel(travel, hole.lead);
    let written = call.speed.unwrap_or(hole.speed);
    let speed = hole.notes.extraction.of(written).min(call.highest);
    let (turns, speed) = match hole.hand {
        Hand::Right => (turns, speed.reversed()),
        Hand::Left => (turns.reversed(), speed),
    };
    Ok(Some(Move {
        span,
        to: hole.axis.with(context.at, end),
        kind: MoveKind::Tap(TapMove {
            mode: TapMode::Rigid,
            axis: hole.axis,
            spindle: hole.spindle,
            lead: hole.lead,
            hand: hole.hand,
            level: hole.level,
            bottom: hole.bottom,
            turns,
            speed,
            outward: true,
            opens: false,
            closes: true,
        }),
        tag: Some(Tag {
            cycle: Cycle::G30P99,
            pass: 1,
            start: 0,
            peck: 0,
            stage: Stage::Extract,
            depth: hole.depth(end),
        }),
    }))
}

const fn unit_code(unit: LengthUnit) -> Arg {
    match unit {
        LengthUnit::Metric => Arg::GCode(210),
        LengthUnit::Inch => Arg::GCode(200),
    }
}
