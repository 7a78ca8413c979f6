//! A pass of a thread: planned with all its strokes, and queued together with its retract.

use super::{Planner, Settings};
use crate::alarm::Alarm;
use crate::call::Position;
use crate::cycle::Moves;
use crate::motion::{Action, Pass, Plan, Stops, ThreadPlan, WaysOut, plan};
use crate::moves::{Move, MoveKind};
use crate::tick::overridden;
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
        self.cut.last =
            matches!(&self.moves, Some(Moves::Thread(moves)) if moves.is_at_last_pass());
        self.put_pass(self.pass_number, plan, ways, rpm, last, settings)
    }

    /// Queues a planned pass, and the move that may follow it. `last`: the last move of the pass, or of its chain.
    #[inline(never)]
    pub(super) fn put_pass(
        &mut self,
        number: u32,
        plan: &ThreadPlan,
        ways: WaysOut,
        rpm: Rpm,
        last: &Move,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        self.plan = Some(Plan::Thread(Pass {
            plan: *plan,
            ways,
            rpm,
        }));
        let lags = !plan.goes_on() && plan.end() != last.to;
        // After a pass of a cycle there is the way back, and after a stroke of a chain the next one.
        let is_end = ways.stays() && !plan.goes_on();
        let stops = Stops {
            hold_not_inside: true,
            hold_not_before: plan.is_joined(),
            single_block: is_end && !lags,
            frozen: Some(self.percent),
            ..Stops::default()
        };
        self.put(number, plan.span(), stops, Action::Planned);
        // Where the short axis could not make up its lag within K, a move by time brings it to the end of the run-out.
        if lags {
            let stops = Stops {
                hold_not_before: true,
                single_block: is_end,
                ..stops
            };
            self.plan_rest(plan.end(), last, stops, settings)?;
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
