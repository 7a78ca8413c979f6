//! G30 P99: the way out of a hole in which a tap was stopped, from the tap journal ([G84/G88 sheet]).

use crate::alarm::{Alarm, Arg, Code};
use crate::call::{Hand, LengthUnit, TapMode, TapReturn};
use crate::cycle::Context;
use crate::moves::{Cycle, Move, MoveKind, Stage, Tag, TapMove};
use crate::units::{Length, TurnRatio};

/// Changes `next`, which must stand at the tool's position, into the only move of a tapping return. The move goes outwards
/// and in phase to R and `beyond` (5382) further. False where the tool already stands at this end or further out.
///
/// # Errors
/// [`Code::TapReturnNothing`] where no tap is in a hole; [`Code::TapReturnUnit`] where the unit has changed since.
#[inline(never)]
pub(in crate::cycle) fn way_out(
    next: &mut Move,
    call: &TapReturn,
    context: &Context<'_>,
) -> Result<bool, Alarm> {
    let Some(record) = context.tap.filter(|record| record.in_hole) else {
        return Err(Alarm::new(Code::TapReturnNothing, next.span));
    };
    let hole = &record.hole;
    if hole.notes.unit != call.unit {
        let units = [unit_code(call.unit), unit_code(hole.notes.unit)];
        return Err(Alarm::new(Code::TapReturnUnit, next.span).with(units));
    }
    let inward = hole.inward();
    let end = hole.level - call.beyond.times(inward);
    let depth = (end - hole.level).times(inward);
    let travel = (end - hole.axis.of(next.to)).times(inward);
    if travel >= Length::ZERO {
        return Ok(false);
    }
    // A right-hand tap goes in with a plus.
    let turns = TurnRatio::of_travel(travel, hole.lead);
    let written = call.speed.unwrap_or(hole.speed);
    let speed = hole.notes.extraction.of(written).min(call.highest);
    let left = matches!(hole.hand, Hand::Left);
    next.to = hole.axis.with(next.to, end);
    next.kind = MoveKind::Tap(TapMove {
        mode: TapMode::Rigid,
        axis: hole.axis,
        spindle: hole.spindle,
        lead: hole.lead,
        hand: hole.hand,
        level: hole.level,
        bottom: hole.bottom,
        turns: if left { turns.reversed() } else { turns },
        speed: if left { speed } else { speed.reversed() },
        outward: true,
        opens: false,
        closes: true,
    });
    next.tag = Some(Tag {
        cycle: Cycle::G30P99,
        pass: 1,
        start: 0,
        peck: 0,
        stage: Stage::Extract,
        depth,
    });
    Ok(true)
}

const fn unit_code(unit: LengthUnit) -> Arg {
    match unit {
        LengthUnit::Metric => Arg::GCode(210),
        LengthUnit::Inch => Arg::GCode(200),
    }
}
