//! A pass of a thread: planned with all its strokes, and queued together with its retract.

use super::{Planner, Settings};
use crate::alarm::Alarm;
use crate::board::operator::overridden;
use crate::call::Position;
use crate::cycle::Moves;
use crate::motion::{Action, Pass, Plan, Stops, ThreadPlan, WaysOut, plan};
use crate::moves::{Move, MoveKind};
use crate::units::{Length, Rpm, TurnRate};

impl Planner {
    /// Plans the collected strokes. `last` is the last of them.
    #[inline(never)]
    pub(super) fn plan_pass(
        &mut self,
        last: &Move,
        rpm: Rpm,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        let rpm = overridden(rpm, self.percent);
        let made = ThreadPlan::new(
            self.pass_start,
            &self.pass,
            settings.params,
            TurnRate::of_rpm(rpm),
        );
        // A plan is large, so it stays where it was made until it is copied to the place where it waits.
        let plan = match &made {
            Ok(plan) => plan,
            Err(alarm) => return Err(*alarm),
        };
        let stops = Stops {
            hold_not_inside: true,
            frozen: Some(self.percent),
            ..Stops::default()
        };
        let ways = WaysOut::new(
            plan,
            self.home,
            last.tag.map_or(Length::ZERO, |tag| tag.depth),
            settings.params.thread_clearance(),
        );
        let end = plan.end();
        self.cut.last =
            matches!(&self.moves, Some(Moves::Thread(moves)) if moves.is_at_last_pass());
        self.plan = Some(Plan::Thread(Pass {
            plan: *plan,
            ways,
            rpm,
        }));
        self.put(self.pass_number, last.span, stops, Action::Planned);
        // Where the short axis could not make up its lag within K, a move by time brings it to the end of the run-out.
        if end != last.to {
            let stops = Stops {
                hold_not_before: true,
                ..stops
            };
            self.plan_rest(end, last, stops, settings)?;
        }
        Ok(())
    }

    #[inline(never)]
    fn plan_rest(
        &mut self,
        from: Position,
        last: &Move,
        stops: Stops,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        let rest = Move {
            kind: MoveKind::Rapid,
            ..*last
        };
        if let Some(timed) = plan::timed(from, &rest, settings.limits)? {
            self.put(self.number, last.span, stops, Action::Timed(timed));
        }
        Ok(())
    }
}
