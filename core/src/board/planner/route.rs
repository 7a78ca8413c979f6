//! Plans the ways that the tick asks for, into a queue of their own.

use crate::alarm::Span;
use crate::motion::{Action, Cut, Limits, Segment, Stops, plan};
use crate::moves::{Move, MoveKind};
use crate::tick::Route;
use crate::tick::queue::{DetourIn, put};

/// Plans a detour into its own queue, with a mark after the last leg. A leg that cannot be planned ends the detour before
/// it: the tool stands there.
pub(super) fn plan_route(route: &Route, limits: &Limits, queue: &mut DetourIn<'_>) {
    let mut at = route.from;
    let stops = Stops {
        hold_not_inside: true,
        hold_not_before: true,
        ..Stops::default()
    };
    let mut queue_up = |action| {
        let leg = Segment {
            number: 0,
            span: Span::default(),
            epoch: route.epoch,
            cut: Cut::NONE,
            stops,
            action,
        };
        put(queue, leg).is_ok()
    };
    for to in route
        .via
        .into_iter()
        .flatten()
        .filter(|to| *to != route.from)
    {
        let leg = Move {
            span: Span::default(),
            to,
            kind: MoveKind::Rapid,
            tag: None,
        };
        let Ok(Some(timed)) = plan::timed(at, &leg, limits) else {
            break;
        };
        queue_up(Action::Timed(timed));
        at = to;
    }
    queue_up(Action::End);
}
