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
        let ways = WaysOut::new(
            plan,
            self.home,
            last.tag.map_or(Length::ZERO, |tag| tag.depth),
            settings.params.thread_clearance(),
        );
        let end = plan.end();
        let mut stops = self.stroke_stops(plan);
        let lags = end != last.to;
        // After other passes there is the way back.
        stops.single_block = ways.stays() && !lags;
        self.cut.last =
            matches!(&self.moves, Some(Moves::Thread(moves)) if moves.is_at_last_pass());
        self.plan = Some(Plan::Thread(Pass {
            plan: *plan,
            ways,
            rpm,
        }));
        self.put(self.pass_number, last.span, stops, Action::Planned);
        // Where the short axis could not make up its lag within K, a move by time brings it to the end of the run-out.
        if lags {
            stops.single_block = ways.stays();
            self.plan_lag(end, last, stops, settings)?;
        }
        Ok(())
    }

    /// Where the operator may stop in and after the pass of `plan`.
    pub(super) fn stroke_stops(&self, plan: &ThreadPlan) -> Stops {
        Stops {
            hold_not_inside: true,
            hold_not_before: plan.is_joined(),
            frozen: Some(self.percent),
            ..Stops::default()
        }
    }

    /// A move by time from the end of the run-out, `from`, to where it should have ended.
    #[inline(never)]
    pub(super) fn plan_lag(
        &mut self,
        from: Position,
        last: &Move,
        stops: Stops,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        let stops = Stops {
            hold_not_before: true,
            ..stops
        };
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
