//! The strokes of a hole: collected from R until the tap is back at R, and queued as one segment.

use super::{Collecting, Planner, Settings};
use crate::alarm::{Alarm, Code};
use crate::call::TapMode;
use crate::cycle::Moves;
use crate::journal::TapHole;
use crate::motion::{Action, Cut, Gear, Plan, Stops, Tap, TapStep, stroke};
use crate::moves::{Cycle, Move, MoveKind, Tag, TapMove};
use crate::params::Params;

impl Planner {
    /// True for a stroke of an ordinary tap and for the dwell between two strokes. The whole hole is one segment, which was
    /// planned when its call was opened. It is queued with the last stroke.
    pub(super) fn take_float(&mut self, next: &Move, settings: &Settings<'_>) -> bool {
        let closes = match &next.kind {
            MoveKind::Tap(tap) if tap.mode == TapMode::Floating => tap.closes,
            MoveKind::Dwell(_) if self.float_number.is_some() => false,
            _ => return false,
        };
        let number = *self.float_number.get_or_insert(self.number);
        self.position = next.to;
        if closes {
            self.float_number = None;
            self.cut = Cut {
                last: true,
                ..self.cut.next()
            };
            let stops = Stops {
                hold_not_inside: !settings.params.tap_hold_allowed(),
                ..self.tap_stops(settings.params)
            };
            self.put(number, next.span, stops, Action::Planned);
            self.complete = true;
        }
        true
    }

    /// Takes a stroke of a tap. Back at R the way through the hole is complete, and is queued as one segment.
    #[inline(never)]
    pub(super) fn take_stroke(
        &mut self,
        next: &Move,
        tap: &TapMove,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        let travel = tap.axis.of(next.to) - tap.axis.of(self.position);
        let made = stroke(tap, travel, settings.params, settings.limits, next.span);
        let step = match &made {
            Ok(stroke) => TapStep::Stroke(*stroke),
            Err(alarm) => return Err(*alarm),
        };
        if self.tap.is_none() {
            // What remains of a hole after its pecks, or in another block, belongs to the hole.
            if self.cut.last {
                self.cut = self.cut.next();
            }
            let inward = (tap.bottom - tap.level).signum();
            let gear = Gear::new(tap.axis, tap.level, inward, tap.lead, tap.hand);
            let Some(gear) = &gear else {
                return Err(Alarm::new(Code::TapFeed, next.span));
            };
            let feed_override = settings.params.tap_feed_override();
            let hole = TapHole {
                axis: tap.axis,
                level: tap.level,
                bottom: tap.bottom,
                lead: tap.lead,
                hand: tap.hand,
                spindle: tap.spindle,
                speed: self.infeed,
                notes: self.notes,
            };
            let collected = Tap::new(*gear, hole, self.position, feed_override);
            self.plan = Some(Plan::Tap(collected));
            self.tap = Some(Collecting {
                number: self.number,
                span: next.span,
            });
        }
        let taken = self.collected().is_some_and(|tap| tap.push(step));
        if !taken {
            // Not reached: with any pecks, the way in and out has at most seven different steps.
            return Err(Alarm::new(Code::TapCallRange, next.span));
        }
        if let Some(collected) = self.collected() {
            collected.part.closes |= tap.closes;
            collected.part.returns |= is_return(next);
        }
        self.position = next.to;
        self.cut.last = tap.closes;
        if tap.axis.of(next.to) == tap.level {
            self.close_tap(settings);
            self.complete = true;
        }
        Ok(())
    }

    /// The tap being collected.
    pub(super) const fn collected(&mut self) -> Option<&mut Tap> {
        match (&self.tap, &mut self.plan) {
            (Some(_), Some(Plan::Tap(tap))) => Some(tap),
            _ => None,
        }
    }

    /// Queues the collected tap.
    pub(super) fn close_tap(&mut self, settings: &Settings<'_>) {
        let Some(collecting) = self.tap.take() else {
            return;
        };
        let stops = Stops {
            hold_not_inside: !settings.params.tap_hold_allowed(),
            ..self.tap_stops(settings.params)
        };
        self.put(collecting.number, collecting.span, stops, Action::Planned);
    }

    /// With 5200.6 = 1 single block stops after each hole, otherwise after the last hole only ([G84/G88 sheet], its table).
    pub(super) fn tap_stops(&self, params: &Params) -> Stops {
        Stops {
            single_block: self.hole_ends,
            stops_after_last_hole: !params.tap_hold_allowed(),
            tap_cycle: true,
            ..Stops::default()
        }
    }
}

/// True for a way out of a hole without the way in.
pub(super) fn is_return(next: &Move) -> bool {
    next.tag
        .as_ref()
        .is_some_and(|tag| tag.cycle == Cycle::G30P99)
}

/// True for the last move of a hole. Single block in a tapping cycle stops only there, never inside a hole.
pub(super) fn ends_hole(next: &Move, rest: &Moves) -> bool {
    let Some(tag) = next.tag.as_ref().filter(|tag| is_tap(tag)) else {
        return false;
    };
    let Moves::Tap(rest) = rest else {
        return true;
    };
    let mut rest = *rest;
    let after = rest.advance().and_then(|after| after.tag.as_ref());
    after.is_none_or(|after| after.pass != tag.pass)
}

pub(super) const fn is_tap(tag: &Tag) -> bool {
    matches!(tag.cycle, Cycle::G84 | Cycle::G88 | Cycle::G30P99)
}
