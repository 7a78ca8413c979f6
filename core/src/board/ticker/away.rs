//! Out of a stroke and back: feed hold with immediate retract [D11], and the ways the background plans for it.

use super::super::detour::{Detour, Route};
use super::super::queue::take;
use super::{Ends, Notice, State, Ticker};
use crate::motion::{Action, Phase, Retract, Segment};
use crate::program::Position;

impl Ticker {
    /// Feed hold with immediate retract [D11]; where the stroke is all but over it is finished instead.
    pub(super) fn leave_stroke(&mut self) {
        if self.detour != Detour::None || self.state != State::Running {
            return;
        }
        let pass = self.pass.as_ref().and_then(Segment::pass);
        let (Some(run), Some(pass)) = (self.executor.thread(), pass) else {
            return;
        };
        if !matches!(run.phase(), Phase::Joining | Phase::Locked) {
            return;
        }
        let target = if run.plan().long_x() {
            pass.home.z
        } else {
            pass.home.x
        };
        if self.executor.retract(target) == Retract::Leaving {
            self.detour = Detour::Leaving;
        }
    }

    /// The next leg of a detour; its mark ends it.
    pub(super) fn go_on_with_detour(&mut self, ends: &mut Ends<'_, '_>) {
        if self.detour == Detour::Leaving {
            let Some(pass) = self.pass.as_ref().and_then(Segment::pass) else {
                self.detour = Detour::None;
                return;
            };
            let from = self.executor.position();
            let mut level = pass.home;
            if pass.plan.long_x() {
                level.x = from.x;
            } else {
                level.z = from.z;
            }
            self.detour = Detour::Home;
            let home = pass.home;
            self.route([Some(level), Some(home)]);
            return;
        }
        let epoch = self.route_epoch;
        if ends.detours.peek().is_none_or(|leg| leg.epoch != epoch) {
            return;
        }
        let Some(mut leg) = take(ends.detours) else {
            return;
        };
        if !matches!(leg.action, Action::End) {
            if let Some(segment) = &self.pass {
                // It belongs to the pass that was left.
                (leg.number, leg.span) = (segment.number, segment.span);
                leg.stops.frozen = segment.stops.frozen;
            }
            self.executor.begin(&leg);
            return;
        }
        self.detour = match self.detour {
            Detour::Home => Detour::AtHome,
            Detour::Back => {
                if let Some(segment) = &self.pass {
                    self.executor.begin(segment);
                }
                Detour::None
            }
            _ => Detour::None,
        };
    }

    /// Asks for a way to be planned; what is left of the one before is dropped.
    pub(super) fn route(&mut self, via: [Option<Position>; 2]) {
        self.route_epoch = self.route_epoch.next();
        self.notice = Some(Notice::Route(Route {
            from: self.executor.position(),
            via,
            epoch: self.route_epoch,
        }));
    }
}
